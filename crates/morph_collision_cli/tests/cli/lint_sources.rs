//! `lint` lists what an artist would act on first, counts findings by source, and fails if there is nothing to try.

use morph_collision_models::generated::random::random_blob;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use serde_json::{Value, json};
use tempfile::tempdir;

use crate::lint::{findings, lint, model, report};
use crate::support::{TestResult, error_of};

#[test]
fn single_targets_come_first_and_mixtures_last_whatever_their_depth() -> TestResult {
    let (dir, path) = model(1.01)?;
    let capture = dir.path().join("take.csv");
    std::fs::write(&capture, "down,near,nearer\n1,1,1\n")?;
    let capture = capture.display().to_string();
    let args = ["--pairs", "--prove", "--mixtures", "300", "--capture", &capture];
    let report = report(&path, &args)?;
    let found = findings(&report);
    let kinds: Vec<&str> = found.iter().filter_map(|finding| finding["kind"].as_str()).collect();
    assert_eq!(kinds, ["target", "clip", "capture", "pair", "mixture"]);
    let depth = |finding: &Value| finding["depth"].as_f64();
    assert!(depth(found[0]) < depth(found[4]), "a mixture is deeper: {report}");
    for of_kind in found.chunk_by(|one, other| one["kind"] == other["kind"]) {
        assert!(
            of_kind.windows(2).all(|pair| depth(pair[0]) >= depth(pair[1])),
            "{kinds:?}"
        );
    }
    let sources = &report["meshes"][0]["sources"];
    assert_eq!(sources[0], json!({ "kind": "target", "shapes": 16, "findings": 1 }));
    assert_eq!(sources[3], json!({ "kind": "pair", "shapes": 24, "findings": 1 }));
    let text = String::from_utf8(lint(&path, &args)?.stdout)?;
    let counts = "  findings: 1 of single targets, 1 of clips, 1 of captures, 1 of pairs, ";
    assert!(text.contains(counts) && text.contains(" 1 of mixtures\n"), "{text}");
    Ok(())
}

#[test]
fn mixtures_near_a_capture_find_what_its_frames_nearly_do() -> TestResult {
    // 1.2 w reaches the floor at w = 5/6.
    let (dir, path) = model(0.0)?;
    let capture = dir.path().join("take.csv");
    std::fs::write(&capture, "near,nearer\n0.8,0.8\n")?;
    let with = report(&path, &["--clip", "rest", "--capture", &capture.display().to_string()])?;
    let kinds: Vec<&Value> = findings(&with).into_iter().map(|finding| &finding["kind"]).collect();
    assert_eq!(kinds, ["mixture"], "the frame itself does not clip");
    assert_eq!(
        with,
        report(&path, &["--clip", "rest", "--capture", &capture.display().to_string()])?
    );
    Ok(())
}

#[test]
fn a_file_with_nothing_to_try_is_an_error() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("still.glb");
    write_glb(&path, &random_blob(1, 2, 0, 0.0), &Appearance::default())?;
    // It ended with 0 and "Nothing touches that does not touch at rest, in 0 shapes."
    let error = error_of(&lint(&path, &[])?);
    assert!(
        error.contains("still.glb: nothing was tried: no target and no animation"),
        "{error}"
    );
    Ok(())
}
