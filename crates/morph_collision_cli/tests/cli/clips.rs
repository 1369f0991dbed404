//! Clips in every command: where they end, and what a bad one spoils.

use std::error::Error;
use std::path::PathBuf;
use std::process::Output;

use serde_json::Value;
use tempfile::tempdir;

use crate::support::{TestResult, asset, command, data, error_of, stdout_of};

/// Touches itself only in the last key of its clip, at 1 s.
fn closes_once() -> PathBuf {
    data("c43_touches_only_in_the_last_key.glb")
}

fn run(command_name: &str, model: &PathBuf, args: &[&str]) -> Result<Output, Box<dyn Error>> {
    Ok(command().arg(command_name).arg(model).args(args).output()?)
}

/// The number of pairs that `query --self` finds.
fn pairs(args: &[&str]) -> Result<Option<usize>, Box<dyn Error>> {
    let args = [&["--clip", "close_once", "--self", "--json"], args].concat();
    let report: Value = serde_json::from_str(&stdout_of(&run("query", &closes_once(), &args)?))?;
    Ok(report["pairs"].as_array().map(Vec::len))
}

#[test]
fn a_clip_ends_in_its_last_pose_and_holds_it() -> TestResult {
    let touching = pairs(&["--time", "1"])?;
    assert!(touching > Some(0), "{touching:?}");
    assert_eq!(pairs(&["--time", "7.5"])?, touching);
    assert_eq!(pairs(&["--time", "-0.5"])?, Some(0));
    for time in ["0", "1", "7"] {
        assert_eq!(pairs(&["--time", time, "--loop"])?, Some(0), "{time}");
    }
    Ok(())
}

#[test]
fn the_last_pose_is_exported_unless_the_clip_is_a_loop() -> TestResult {
    let dir = tempdir()?;
    let out = dir.path().join("out.ply").display().to_string();
    let touching = |args: &[&str]| {
        let args = [&["--clip", "0", "--time", "1", "--json", "--output", &out], args].concat();
        let report: Value = serde_json::from_str(&stdout_of(&run("export", &closes_once(), &args)?))?;
        Ok::<_, Box<dyn Error>>(report["touching_pairs"].as_u64())
    };
    assert!(touching(&[])? > Some(0));
    assert_eq!(touching(&["--loop"])?, Some(0));
    Ok(())
}

#[test]
fn every_command_that_plays_clips_tries_the_last_pose() -> TestResult {
    let model = closes_once();
    assert_eq!(run("sweep", &model, &["--fail-on-touch"])?.status.code(), Some(1));
    assert_eq!(
        run("sweep", &model, &["--fail-on-touch", "--loop"])?.status.code(),
        Some(0)
    );
    let quiet = ["--mixtures", "0", "--json"];
    let found = |args: &[&str]| {
        let output = run("lint", &model, &[&quiet[..], args].concat())?;
        let report: Value = serde_json::from_slice(&output.stdout)?;
        let findings = report["meshes"][0]["findings"].as_array().cloned().unwrap_or_default();
        let of_clip = findings
            .iter()
            .filter(|finding| finding["found_with"] == "clip close_once");
        Ok::<_, Box<dyn Error>>(of_clip.map(|finding| finding["at"].as_f64()).collect::<Vec<_>>())
    };
    assert_eq!(found(&[])?, [Some(1.0)]);
    assert!(found(&["--loop"])?.is_empty());
    Ok(())
}

#[test]
fn the_shorter_clip_of_a_scene_holds_or_starts_again() -> TestResult {
    let (short, long) = (closes_once(), asset("dolphin_564.glb"));
    let times = |args: &[&str]| {
        let models = [short.display().to_string(), long.display().to_string()];
        let mut made = command();
        made.arg("scene").args(models).args(args);
        made.args(["--clip", "close_once", "--clip", "swim", "--fps", "2"]);
        let scene: Value = serde_json::from_str(&stdout_of(&made.output()?))?;
        let frames = scene["frames"].as_array().cloned().unwrap_or_default();
        let times = |body: usize| {
            frames
                .iter()
                .filter_map(|frame| frame[body]["time"].as_f64())
                .collect::<Vec<_>>()
        };
        Ok::<_, Box<dyn Error>>([times(0), times(1)])
    };
    let all = vec![0.0, 0.5, 1.0, 1.5, 1.6];
    assert_eq!(times(&[])?, [all.clone(), all]);
    assert_eq!(
        times(&["--loop"])?,
        [vec![0.0, 0.5, 0.0, 0.5], vec![0.0, 0.5, 1.0, 1.5]]
    );
    let looped = times(&["--loop", "--frames", "5"])?;
    assert_eq!(looped[1][..4], [0.0, 0.5, 1.0, 1.5]);
    assert!((looped[1][4] - 0.4).abs() < 1e-6, "{looped:?}");
    Ok(())
}

#[test]
fn a_clip_of_any_length_is_refused_instead_of_filling_the_memory() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("long.glb");
    let mut mesh = morph_collision_testkit::models::dolphin(0);
    if let Some(last) = mesh.animations[0].times.last_mut() {
        *last = 3e38;
    }
    morph_collision_testkit::gltf_write::write_glb(&path, &mesh, &Default::default())?;
    let message = error_of(&run("sweep", &path, &[])?);
    assert!(
        message.contains("--fps") && message.contains("--memory-limit"),
        "{message}"
    );
    Ok(())
}
