#![no_main]
use morph_collision_testkit::fuzzing;

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzzing::gltf(data));

// Most mutations keep the structure of the file.
libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    match fuzzing::bend(&data[..size], seed.into()).filter(|bent| seed % 8 > 0 && bent.len() <= max_size) {
        Some(bent) => {
            data[..bent.len()].copy_from_slice(&bent);
            bent.len()
        }
        None => libfuzzer_sys::fuzzer_mutate(data, size, max_size),
    }
});
