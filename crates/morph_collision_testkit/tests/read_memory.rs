//! The memory that reading takes, compared with what is counted or documented.

use std::path::Path;

use morph_collision::TreeFile;
use morph_collision_models::memory::MemoryBudget;
use morph_collision_models::scenes::Scene;
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// A result, and the most bytes that were allocated at once for it.
fn measured<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let made = work();
    (made, (MEMORY.peak_usage() - before) as u64)
}

const COUNT: usize = 70_000;

/// Scenes that take much memory for their length.
fn scenes() -> [(&'static str, String); 7] {
    let one_body = |states: String| format!(r#"{{"bodies": [{{"model": "a"}}], "frames": [{states}]}}"#);
    let list = |item: &dyn Fn(usize) -> String| (0..COUNT).map(item).collect::<Vec<_>>().join(",");
    let bodies = list(&|_| r#"{"model":"a"}"#.to_owned());
    [
        (
            "empty frames",
            format!(r#"{{"bodies": [], "frames": [{}]}}"#, list(&|_| "[]".to_owned())),
        ),
        ("frames", one_body(list(&|_| "[{}]".to_owned()))),
        ("bodies", format!(r#"{{"bodies": [{bodies}], "frames": []}}"#)),
        (
            "states",
            format!(
                r#"{{"bodies": [{bodies}], "frames": [[{}]]}}"#,
                list(&|_| "{}".to_owned())
            ),
        ),
        (
            "weights",
            one_body(format!(r#"[{{"weights": [{}]}}]"#, list(&|_| "1".to_owned()))),
        ),
        (
            "named weights",
            one_body(format!(
                r#"[{{"weights": {{{}}}}}]"#,
                list(&|i| format!(r#""{i:x}":1"#))
            )),
        ),
        (
            "frames with named weights",
            one_body(list(&|_| r#"[{"weights":{"":1},"clip":"","comment":""}]"#.to_owned())),
        ),
    ]
}

/// Files of trees that take much memory for their length: what follows their headers.
fn files() -> [(&'static str, Vec<u8>); 5] {
    // Label, joints, version, fingerprint, leaf size, and then, empty: nodes, triangles, certificates.
    const SMALLEST: [u8; 8] = [0, 0, 0, 0, 1, 0, 0, 0];
    // 10^6 as an integer of variable length.
    const MILLION: [u8; 3] = [0xc0, 0x84, 0x3d];
    let trees = [&MILLION[..], &SMALLEST.repeat(1_000_000)].concat();
    let nodes = [&[1][..], &SMALLEST[..5], &MILLION, &[0; 1_000_000], &[0, 0]].concat();
    // Limits of weights, none, then neighbours of five bytes or children of four, then two fields.
    let certified = [&[1][..], &SMALLEST[..7], &[1, 0, 0]].concat();
    let neighbours = [&certified[..], &MILLION, &[0; 5_000_000], &[0, 0, 0]].concat();
    let apart = [&certified[..], &[0], &MILLION, &[0; 4_000_000], &[0, 0]].concat();
    // Many nodes are claimed, and there are none.
    let claimed = [&[1][..], &SMALLEST[..5], &[0xff, 0xff, 0xff, 0x7f], &[0; 100]].concat();
    [
        ("trees", trees),
        ("nodes", nodes),
        ("neighbours", neighbours),
        ("apart", apart),
        ("claimed", claimed),
    ]
}

/// One test, because the allocator counts everything in the process.
#[test]
fn reading_takes_no_more_than_is_counted_or_documented() {
    let path = Path::new("scene.json");
    for (name, json) in scenes() {
        let budget = MemoryBudget::new(1 << 40);
        let (scene, peak) = measured(|| Scene::read_from(json.as_bytes(), path, &budget));
        scene.unwrap_or_else(|error| panic!("{name}: {error}"));
        let counted = budget.limit() - budget.left();
        println!(
            "{name}: {} bytes of text, {counted} counted, at most {peak}",
            json.len()
        );
        assert!(peak <= counted, "{name}: {peak} bytes, {counted} counted");
        let small = MemoryBudget::new(counted - 1);
        let error = Scene::read_from(json.as_bytes(), path, &small)
            .map(drop)
            .map_err(|error| error.to_string());
        assert!(error.is_err_and(|error| error.contains("over the limit of")), "{name}");
    }
    for (name, trees) in files() {
        let bytes = TreeFile::forged(&trees);
        drop(trees);
        let (file, peak) = measured(|| TreeFile::from_bytes(&bytes));
        assert_eq!(file.is_ok(), name != "claimed", "{name}");
        println!("{name}: {} bytes of file, at most {peak}", bytes.len());
        assert!(peak <= (1 << 20) + 32 * bytes.len() as u64, "{name}: {peak}");
    }
}
