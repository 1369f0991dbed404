//! `lint` finds the weights that make a mesh run into itself, and fails a pipeline if there are new ones.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Output;

use glam::Vec3;
use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_models::mesh::MorphMesh;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::support::{RawMesh, TestResult, asset, command, error_of, stdout_of, write_gltf};

pub(crate) fn lint(input: &Path, args: &[&str]) -> Result<Output, Box<dyn Error>> {
    Ok(command().arg("lint").arg(input).args(args).output()?)
}

/// The JSON of a run that may end with exit code 1.
pub(crate) fn report(input: &Path, args: &[&str]) -> Result<Value, Box<dyn Error>> {
    let output = lint(input, &[args, &["--json"]].concat())?;
    let has_findings = output.status.code() == Some(1);
    assert!(
        has_findings || output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let report: Value = serde_json::from_slice(&output.stdout)?;
    let findings = report["meshes"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|mesh| mesh["findings"].as_array());
    let open = findings
        .flatten()
        .filter(|finding| finding["accepted"] == false)
        .count();
    let is_recorded = args.contains(&"--write-baseline");
    assert_eq!(has_findings, open > 0 && !is_recorded, "{report}");
    Ok(report)
}

pub(crate) fn findings(report: &Value) -> Vec<&Value> {
    let meshes = report["meshes"].as_array().into_iter().flatten();
    meshes
        .filter_map(|mesh| mesh["findings"].as_array())
        .flatten()
        .collect()
}

/// A floor, a wall that stands on it at rest, and another wall that hovers at a height of 1. "down" lowers the second wall by `down`; "near" and
/// "nearer" lower it by 0.6 each, so that it touches only with both.
pub(crate) fn model(down: f32) -> Result<(TempDir, PathBuf), Box<dyn Error>> {
    let floor = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner * 8.0);
    let hovering = [
        Vec3::new(1.0, 1.0, 1.0),
        Vec3::new(2.0, 1.0, 1.0),
        Vec3::new(1.0, 1.0, 5.0),
    ];
    let standing = [
        Vec3::new(3.0, 1.0, 0.0),
        Vec3::new(4.0, 1.0, 0.0),
        Vec3::new(3.0, 1.0, 5.0),
    ];
    let positions = [floor, standing, hovering].concat();
    let mut mesh = MorphMesh::rigid("walls", positions, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
    let lowered = |by: f32| [[Vec3::ZERO; 3], [Vec3::ZERO; 3], [-Vec3::Z * by; 3]].concat();
    mesh.target_names = ["still", "down", "near", "nearer"].map(str::to_owned).to_vec();
    mesh.targets = vec![vec![Vec3::ZERO; 9], lowered(down), lowered(0.6), lowered(0.6)];
    let clip = |name: &str, weights: [f32; 4]| WeightAnimation {
        name: name.into(),
        times: vec![0.0, 1.0],
        weights: vec![vec![0.0; 4], weights.to_vec()],
        ..WeightAnimation::default()
    };
    mesh.animations = vec![clip("press", [0.0, 0.0, 1.0, 1.0]), clip("rest", [1.0, 0.0, 0.0, 0.0])];
    let dir = tempdir()?;
    let path = dir.path().join("walls.glb");
    write_glb(&path, &mesh, &Appearance::default())?;
    Ok((dir, path))
}

pub(crate) const QUICK: &[&str] = &["--mixtures", "0", "--clip", "rest"];

#[test]
fn a_target_that_clips_alone_is_found_with_the_weight_that_does() -> TestResult {
    let (_dir, path) = model(2.0)?;
    let report = report(&path, QUICK)?;
    let mesh = &report["meshes"][0];
    // Four targets, one of which is stored although it moves nothing, and the frames of a clip.
    assert_eq!(
        (&mesh["pairs_at_rest"], &mesh["shapes"]),
        (&1.into(), &(4 * 4 + 31).into())
    );
    let found = findings(&report);
    let [finding] = found[..] else {
        return Err(format!("not one finding: {report}").into());
    };
    assert_eq!(
        (&finding["kind"], &finding["found_with"]),
        (&"target".into(), &"target down".into())
    );
    assert_eq!((&finding["pairs"], &finding["shapes"]), (&1.into(), &3.into()));
    assert_eq!(finding["weights"], json!({ "down": 1.0 }), "the deepest");
    assert_eq!(
        finding["meshes"],
        json!([{ "mesh": 0, "name": "walls", "triangles": [0, 2] }])
    );
    assert_eq!(finding["near"], json!(["down", "near", "nearer"]));
    let options = finding["reproduce"].as_str().ok_or("no options")?.split(' ');
    let query = command()
        .arg("query")
        .arg(&path)
        .args(options)
        .args(["--self", "--json"])
        .output()?;
    let query: Value = serde_json::from_str(&stdout_of(&query))?;
    assert_eq!(
        query["pairs"],
        json!([[0, 1], [0, 2]]),
        "the one at rest and the new one"
    );
    let text = String::from_utf8(lint(&path, &[QUICK, &["--suggest"]].concat())?.stdout)?;
    assert!(
        text.contains("  down: at most 0.498046") && text.contains(" (it clips at 1)\n"),
        "{text}"
    );
    assert!(text.ends_with("1 finding in 47 shapes.\n"), "{text}");
    Ok(())
}

#[test]
fn two_targets_that_clip_only_together_are_found_and_limited() -> TestResult {
    let (_dir, path) = model(0.0)?;
    assert!(findings(&report(&path, QUICK)?).is_empty());
    let report = report(&path, &[QUICK, &["--pairs", "--suggest"]].concat())?;
    let found = findings(&report);
    assert_eq!(found.len(), 1, "{report}");
    assert_eq!(
        (&found[0]["found_with"], &found[0]["shapes"]),
        (&"pair near + nearer".into(), &1.into())
    );
    let suggestions = report["meshes"][0]["suggestions"].as_array().ok_or("no suggestions")?;
    assert_eq!(suggestions.len(), 2);
    for (suggestion, [target, other]) in suggestions.iter().zip([["near", "nearer"], ["nearer", "near"]]) {
        assert_eq!(
            (&suggestion["target"], &suggestion["while_other"]),
            (&target.into(), &json!([other, 1.0]))
        );
        let largest = suggestion["largest"].as_f64().ok_or("no weight")?;
        // 0.6 + 0.6 w reaches the floor at w = 2/3.
        assert!((2.0 / 3.0 - 1.0 / 512.0..2.0 / 3.0).contains(&largest), "{largest}");
    }
    Ok(())
}

#[test]
fn what_a_target_does_alone_is_not_reported_again_for_its_pairs() -> TestResult {
    let (_dir, path) = model(2.0)?;
    let report = report(&path, &[QUICK, &["--pairs"]].concat())?;
    let with: Vec<&Value> = findings(&report)
        .into_iter()
        .map(|finding| &finding["found_with"])
        .collect();
    assert!(
        with.contains(&&"target down".into()) && with.contains(&&"pair near + nearer".into()),
        "{with:?}"
    );
    assert!(
        !with
            .iter()
            .any(|with| with.as_str().is_some_and(|with| with.contains("pair down"))),
        "{with:?}"
    );
    Ok(())
}

#[test]
fn clips_and_captures_are_tried_frame_by_frame() -> TestResult {
    let (dir, path) = model(0.0)?;
    let played = report(&path, &["--mixtures", "0", "--fps", "10"])?;
    let found = findings(&played);
    assert_eq!(found.len(), 1, "{played}");
    assert_eq!(
        (&found[0]["found_with"], &found[0]["at"]),
        (&"clip press".into(), &json!(1.0))
    );
    // 1.2 w reaches 1 after frame 8 of 10.
    assert_eq!(
        (&found[0]["shapes"], &found[0]["reproduce"]),
        (&2.into(), &"--mesh 0 --clip press --time 1".into())
    );
    let capture = dir.path().join("take.csv");
    std::fs::write(&capture, "time,Near,nearer\n0,0.5,0.5\n1,1,1\n2,1,0.9\n")?;
    let capture = capture.display().to_string();
    let output = lint(&path, &[QUICK, &["--capture", &capture]].concat())?;
    assert_eq!(output.status.code(), Some(1));
    let warning = String::from_utf8_lossy(&output.stderr);
    assert!(warning.contains("ignored the column \"time\""), "{warning}");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains(&format!("capture {capture}: row 1\n")), "{text}");
    Ok(())
}

#[test]
fn a_baseline_accepts_what_it_has_and_nothing_deeper() -> TestResult {
    let (dir, path) = model(1.2)?;
    let (_deeper_dir, deeper) = model(2.0)?;
    let known = dir.path().join("known.json").display().to_string();
    let with = |path: &Path, option: &str| report(path, &[QUICK, &[option, &known]].concat());
    with(&path, "--write-baseline")?;
    let same = with(&path, "--baseline")?;
    assert_eq!(findings(&same)[0]["accepted"], true);
    let text = stdout_of(&lint(&path, &[QUICK, &["--baseline", &known]].concat())?);
    assert!(
        text.ends_with("1 finding in 47 shapes; 1 of them accepted by the baseline.\n"),
        "{text}"
    );
    let worse = with(&deeper, "--baseline")?;
    assert_eq!(findings(&worse)[0]["accepted"], false, "{worse}");
    Ok(())
}

#[test]
fn the_number_of_threads_changes_nothing() -> TestResult {
    let path = asset("mh_character_low.glb");
    let run = |threads: &str| report(&path, &["--mixtures", "40", "--fps", "5", "--threads", threads]);
    let one = run("1")?;
    assert!(findings(&one).len() > 10);
    assert_eq!(one, run("3")?);
    Ok(())
}

#[test]
fn a_proof_finds_what_no_shape_shows_and_clears_the_rest() -> TestResult {
    // 0.6 and 0.6 clip only together, which is not tried without --pairs.
    let (_dir, path) = model(0.0)?;
    let proved = report(&path, &[QUICK, &["--prove", "--effort", "64"]].concat())?;
    let found = findings(&proved);
    assert_eq!(found.len(), 1, "{proved}");
    assert_eq!(
        (&found[0]["kind"], &found[0]["meshes"][0]["triangles"]),
        (&"proof".into(), &json!([0, 2]))
    );
    let proof = &proved["meshes"][0]["proof"];
    // The wall at rest, and the other one with both targets. The third pair is free.
    assert_eq!(
        (&proof["pairs"], &proof["touching"], &proof["undecided"]),
        (&3.into(), &2.into(), &0.into())
    );
    let text = stdout_of(&lint(
        &asset("heaving_body_5120.glb"),
        &["--mixtures", "1", "--fps", "1", "--prove"],
    )?);
    assert!(text.contains("all pairs of triangles are proved free"), "{text}");
    // Joints have no proof.
    let skinned = lint(
        &asset("mh_character_low.glb"),
        &["--mixtures", "0", "--fps", "1", "--prove"],
    )?;
    let warning = String::from_utf8_lossy(&skinned.stderr);
    assert!(warning.contains("skinned, so nothing is proved"), "{warning}");
    Ok(())
}

#[test]
fn the_page_has_a_picture_of_each_finding_and_the_weights() -> TestResult {
    let (dir, path) = model(2.0)?;
    let page = dir.path().join("page.html");
    let output = lint(
        &path,
        &[QUICK, &["--suggest", "--html", &page.display().to_string()]].concat(),
    )?;
    assert_eq!(output.status.code(), Some(1));
    let html = std::fs::read_to_string(&page)?;
    assert_eq!(html.matches("<svg").count(), 1);
    // The floor is red and the wall is blue; the wall that stands there at rest is grey.
    let classes = ["class=\"t\"", "class=\"u\"", "class=\"g s"].map(|class| html.matches(class).count());
    assert_eq!(classes, [1, 1, 1], "{html}");
    for part in [
        "value=\"--mesh 0 --weights down=1\"",
        "<b>target down</b>",
        "<li>down: at most 0.498",
    ] {
        assert!(html.contains(part), "no {part} in {html}");
    }
    assert!(
        !html.contains("http") && !html.contains("<script"),
        "it needs nothing else"
    );
    Ok(())
}

#[test]
fn mistakes_are_named() -> TestResult {
    let (dir, path) = model(1.0)?;
    let file = |name: &str, text: &str| -> Result<String, Box<dyn Error>> {
        let path = dir.path().join(name);
        std::fs::write(&path, text)?;
        Ok(path.display().to_string())
    };
    let wrong = file("wrong.csv", "near\n0\nx\n")?;
    let other = file("other.json", r#"{"version":9,"accepted":[]}"#)?;
    for (args, parts) in [
        (
            ["--capture", wrong.as_str()],
            ["--capture: ", "wrong.csv: line 3: near"],
        ),
        (["--capture", "absent.csv"], ["--capture: absent.csv", ""]),
        (["--baseline", other.as_str()], ["--baseline: ", "version 9"]),
        (["--clip", "pres"], ["--clip: ", "did you mean \"press\""]),
        (["--mesh", "7"], ["--mesh: ", "no mesh 7"]),
        (["--memory-limit", "2KiB"], ["error: ", "memory-limit"]),
    ] {
        let message = error_of(&lint(&path, &args)?);
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
    // A shape that leaves the range of numbers names itself.
    let mut huge = RawMesh::triangle("huge");
    huge.positions = vec![[5e36, 0.0, 0.0], [5e36, 1.0, 0.0], [5e36, 0.0, 1.0]];
    huge.targets = vec![vec![[9e36, 0.0, 0.0]; 3], vec![[9e36, 0.0, 0.0]; 3]];
    let path = write_gltf(dir.path(), "huge.gltf", &[huge])?;
    let message = error_of(&lint(&path, &["--pairs"])?);
    assert!(
        message.contains("mesh 0 \"huge\": pair target_0 + target_1: "),
        "{message}"
    );
    Ok(())
}

#[test]
fn a_mesh_that_does_not_clip_is_clean() -> TestResult {
    let path = asset("heaving_body_5120.glb");
    let text = stdout_of(&lint(&path, &["--mixtures", "20", "--fps", "5"])?);
    assert!(
        text.contains("Nothing touches that does not touch at rest, in "),
        "{text}"
    );
    Ok(())
}
