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
    let mut mesh = morph_collision_models::generated::dolphin(0);
    if let Some(last) = mesh.animations[0].times.last_mut() {
        *last = 3e38;
    }
    morph_collision_models::gltf::write::write_glb(&path, &mesh, &Default::default())?;
    let message = error_of(&run("sweep", &path, &[])?);
    assert!(
        message.contains("--fps") && message.contains("--memory-limit"),
        "{message}"
    );
    Ok(())
}

/// Its only clip has a sampler whose interpolation is a number. Nothing touches.
fn bad_clip() -> PathBuf {
    data("c47_interpolation_is_a_number.glb")
}

/// The warnings of a run that must not have failed.
fn warnings(output: &Output) -> String {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    stderr
        .lines()
        .filter(|line| line.contains("warning"))
        .collect::<Vec<_>>()
        .join("\n")
}

/// All of these were errors.
#[test]
fn a_bad_clip_spoils_only_itself() -> TestResult {
    let (model, dir) = (bad_clip(), tempdir()?);
    let out = dir.path().join("out.ply").display().to_string();
    let scene = dir.path().join("scene.json");
    for (name, args) in [
        ("export", &["--output", &*out][..]),
        ("scene", &["--output", &scene.display().to_string()]),
        ("sweep", &[]),
        ("lint", &["--mixtures", "3"]),
    ] {
        let told = warnings(&run(name, &model, args)?);
        assert!(
            told.contains("warning: left out: ") && told.contains("animation 0 \"clip\""),
            "{name}: {told}"
        );
        assert_eq!(told.matches("animation 0").count(), 1, "{name}: {told}");
    }
    assert_eq!(warnings(&run("run", &scene, &[])?), "");
    assert_eq!(warnings(&run("query", &model, &["--self"])?), "");
    Ok(())
}

#[test]
fn a_bad_clip_that_is_asked_for_is_an_error_with_its_reason() -> TestResult {
    let (model, dir) = (bad_clip(), tempdir()?);
    let out = dir.path().join("out.ply").display().to_string();
    for (name, args) in [
        ("query", &["--self"][..]),
        ("export", &["--output", &out]),
        ("scene", &[]),
        ("sweep", &[]),
        ("lint", &["--mixtures", "0"]),
    ] {
        for clip in ["clip", "0"] {
            let output = run(name, &model, &[args, &["--clip", clip]].concat())?;
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{name}: {stderr}");
            assert!(
                stderr.contains("error: --clip: ") && stderr.contains("animation 0 \"clip\": channel 0"),
                "{name}: {stderr}"
            );
        }
    }
    let state = serde_json::json!({"bodies": [{"model": model}], "frames": [[{"clip": "clip"}]]});
    let scene = crate::support::write_scene(dir.path(), &state)?;
    let output = run("run", &scene, &[])?;
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        stderr.contains("frame 0, body 0: ") && stderr.contains("channel 0"),
        "{stderr}"
    );
    Ok(())
}

/// It was "no clip", although the file has it.
#[test]
fn a_bad_clip_of_joints_gives_its_reason() -> TestResult {
    let (_dir, path) = crate::support::bound_and_free()?;
    let mut gltf: Value = serde_json::from_slice(&std::fs::read(&path)?)?;
    for sampler in gltf["animations"][0]["samplers"].as_array_mut().ok_or("no samplers")? {
        sampler["interpolation"] = "BOUNCE".into();
    }
    std::fs::write(&path, gltf.to_string())?;
    let output = run("query", &path, &["--self", "--clip", "rise"])?;
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        stderr.contains("unknown interpolation") && !stderr.contains("no clip"),
        "{stderr}"
    );
    let told = warnings(&run("sweep", &path, &[])?);
    assert_eq!(told.matches("animation 0").count(), 1, "{told}");
    Ok(())
}
