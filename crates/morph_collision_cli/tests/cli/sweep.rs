//! `sweep` finds what touches while clips play, and fails if it is told to.

use std::error::Error;
use std::path::Path;
use std::process::Output;

use glam::Vec3;
use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_models::mesh::MorphMesh;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::support::{TestResult, asset, command, error_of, stdout_of};

fn sweep(input: &Path, args: &[&str]) -> Result<Output, Box<dyn Error>> {
    Ok(command().arg("sweep").arg(input).args(args).output()?)
}

fn json(input: &Path, args: &[&str]) -> Result<Value, Box<dyn Error>> {
    Ok(serde_json::from_str(&stdout_of(&sweep(
        input,
        &[args, &["--json"]].concat(),
    )?))?)
}

/// Two triangles, one above the other, that touch while the target "down" has a weight of 0.5. The clip "press" raises it from 0 to 1 in a
/// second; "rest" keeps it at 0.
fn model() -> Result<(TempDir, std::path::PathBuf), Box<dyn Error>> {
    let floor = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let above = floor.map(|corner| corner + Vec3::Z * 0.5);
    let mut mesh = MorphMesh::rigid("press", [floor, above].concat(), vec![[0, 1, 2], [3, 4, 5]]);
    mesh.target_names = vec!["aside".into(), "down".into()];
    mesh.targets = vec![vec![Vec3::ZERO; 6], [[Vec3::ZERO; 3], [-Vec3::Z; 3]].concat()];
    let clip = |name: &str, to: f32| WeightAnimation {
        name: name.into(),
        times: vec![0.0, 1.0],
        weights: vec![vec![0.0, 0.0], vec![0.0, to]],
        ..WeightAnimation::default()
    };
    mesh.animations = vec![clip("press", 1.0), clip("rest", 0.0)];
    let dir = tempdir()?;
    let path = dir.path().join("press.glb");
    write_glb(&path, &mesh, &Appearance::default())?;
    Ok((dir, path))
}

#[test]
fn the_frame_the_pairs_and_the_targets_are_named() -> TestResult {
    let (dir, path) = model()?;
    let csv = dir.path().join("rows.csv");
    let report = json(&path, &["--fps", "4", "--csv", &csv.display().to_string()])?;
    assert_eq!((&report["frames"], &report["frames_touching"]), (&10.into(), &1.into()));
    let rows = report["rows"].as_array().ok_or("no rows")?;
    assert_eq!(rows.len(), 1, "{report}");
    let row = &rows[0];
    assert_eq!(
        (&row["frame"], &row["clip"], &row["seconds"]),
        (&2.into(), &"press".into(), &0.5.into())
    );
    assert_eq!((&row["pairs"], &row["new"]), (&1.into(), &1.into()));
    assert_eq!(row["targets"], serde_json::json!(["down"]));
    let csv = std::fs::read_to_string(csv)?;
    assert!(csv.ends_with("\n2,press,0.5,0,0,press,press,1,1,0,down,\n"), "{csv}");
    let text = stdout_of(&sweep(&path, &["--fps", "4"])?);
    assert!(
        text.ends_with("in 1 of 10 frames. The most new pairs are in frame 2, press at 0.500 s: 1 of 1.\n"),
        "{text}"
    );
    Ok(())
}

#[test]
fn a_pipeline_fails_if_something_touches() -> TestResult {
    let (_dir, path) = model()?;
    let code = |args: &[&str]| Ok::<_, Box<dyn Error>>(sweep(&path, args)?.status.code());
    assert_eq!(code(&["--fps", "4", "--fail-on-touch"])?, Some(1));
    assert_eq!(code(&["--fps", "4"])?, Some(0));
    assert_eq!(code(&["--clip", "rest", "--fail-on-touch"])?, Some(0));
    assert_eq!(
        code(&["--clip", "1", "--fail-on-touch"])?,
        Some(0),
        "an index is as good as a name"
    );
    assert_eq!(code(&["--fps", "4", "--among", "bodies", "--fail-on-touch"])?, Some(0));
    let text = stdout_of(&sweep(&path, &["--clip", "rest"])?);
    assert!(text.ends_with("Nothing touches in any of 31 frames.\n"), "{text}");
    Ok(())
}

#[test]
fn what_touches_at_rest_can_be_left_out() -> TestResult {
    let path = asset("dolphin_564.glb");
    let all = json(&path, &["--fps", "5"])?;
    let new = json(&path, &["--fps", "5", "--ignore-rest"])?;
    let sum = |report: &Value, key: &str| -> u64 {
        report["rows"]
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(|row| row[key].as_u64())
            .sum()
    };
    assert!(sum(&all, "pairs") > sum(&all, "new"));
    assert_eq!(sum(&new, "pairs"), sum(&all, "new"));
    assert_eq!(sum(&new, "pairs"), sum(&new, "new"));
    Ok(())
}

#[test]
fn a_scene_is_swept_as_it_is() -> TestResult {
    let scene = asset("scenes/two_dolphins.json");
    let report = json(&scene, &["--among", "bodies"])?;
    let run = command().args(["run", "--json"]).arg(&scene).output()?;
    let run: Value = serde_json::from_str(&stdout_of(&run))?;
    let mut pairs = vec![0; 40];
    for row in report["rows"].as_array().ok_or("no rows")? {
        let frame = row["frame"].as_u64().ok_or("no frame")? as usize;
        pairs[frame] = row["pairs"].as_u64().ok_or("no pairs")?;
        assert!(row["depth"].as_f64() >= Some(0.0), "{row}");
    }
    assert_eq!(run["pairs"], serde_json::json!(pairs));
    for flag in [&["--clip", "swim"][..], &["--mesh", "0"], &["--fps", "4"]] {
        let message = error_of(&sweep(&scene, flag)?);
        assert!(message.contains(flag[0]), "{message}");
    }
    let message = error_of(&sweep(&asset("dolphin_564.glb"), &["--clip", "walk"])?);
    assert!(message.contains("no clip \"walk\"; the mesh has \"swim\""), "{message}");
    Ok(())
}
