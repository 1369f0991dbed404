#![no_main]
libfuzzer_sys::fuzz_target!(|data: &[u8]| morph_collision_testkit::fuzzing::tree_file(data));
