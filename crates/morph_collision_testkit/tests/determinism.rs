//! Trees of several leaf sizes give the same bits, on any number of threads and with all instruction sets of this
//! machine.

use morph_collision_testkit::determinism::{answer_all, differences, write};

/// Set this to anything to rewrite the expected hashes.
const WRITE: &str = "WRITE_EXPECTED";

#[test]
fn answers_and_vertices_are_the_expected_bits_for_every_tree_and_thread_count() {
    let lines = answer_all(&[1, 2, 8], || ()).unwrap_or_else(|error| panic!("{error}"));
    if std::env::var_os(WRITE).is_some() {
        write(&lines).expect("the file can be written");
        return;
    }
    let differences = differences(&lines);
    assert!(
        differences.is_empty(),
        "{}\nIf the change is meant: {WRITE}=1 cargo test -p morph_collision_testkit --test determinism",
        differences.join("\n")
    );
}
