//! Replays the fuzz targets' seeds, and everything that fuzzing ever found.

use std::path::Path;

use morph_collision_testkit::fuzzing::TARGETS;

/// Replays all files of a folder; returns their number.
fn replay(folder: &str, name: &str, target: fn(&[u8])) -> usize {
    let directory = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz"))
        .join(folder)
        .join(name);
    let Ok(entries) = std::fs::read_dir(&directory) else {
        return 0;
    };
    let mut count = 0;
    for entry in entries {
        let path = entry.expect("the folder can be listed").path();
        let bytes = std::fs::read(&path).expect("the file can be read");
        println!("{}", path.display()); // shown when it fails
        target(&bytes);
        count += 1;
    }
    count
}

#[test]
fn every_seed_and_every_finding_passes() {
    for (name, target) in TARGETS {
        let seeds = replay("corpus", name, target);
        assert!(seeds > 0, "no seeds for the fuzz target {name}");
        replay("regressions", name, target);
    }
}
