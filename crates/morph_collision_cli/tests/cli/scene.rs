//! `scene` makes scenes that the other commands read.

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::process::{Output, Stdio};

use morph_collision_models::scenes::Scene;
use serde_json::{Value, json};
use tempfile::tempdir;

use crate::support::{TestResult, asset, command, error_of, run_program, stdout_of};

fn scene(args: &[&str]) -> Result<Output, Box<dyn Error>> {
    Ok(command().arg("scene").args(args).output()?)
}

fn json_of(args: &[&str]) -> Result<Value, Box<dyn Error>> {
    Ok(serde_json::from_str(&stdout_of(&scene(args)?))?)
}

fn dolphin() -> String {
    asset("dolphin_564.glb").display().to_string()
}

/// Runs a scene that comes through a pipe.
fn run(scene: &str, args: &[&str]) -> Result<Value, Box<dyn Error>> {
    let mut child = command()
        .args(["run", "-", "--json"])
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    child.stdin.take().ok_or("no stdin")?.write_all(scene.as_bytes())?;
    Ok(serde_json::from_str(&stdout_of(&child.wait_with_output()?))?)
}

#[test]
fn one_body_per_model_plays_the_clip_to_its_end() -> TestResult {
    let dolphin = dolphin();
    let made = json_of(&[
        &dolphin,
        &dolphin,
        "--clip",
        "swim",
        "--place",
        "0,0,0",
        "--place",
        "x=1,turn-y=180",
    ])?;
    assert_eq!(
        (&made["version"], made["bodies"].as_array().map(Vec::len)),
        (&1.into(), Some(2))
    );
    assert_eq!(
        (&made["bodies"][0]["name"], &made["bodies"][1]["name"]),
        (&json!("dolphin_564"), &json!("dolphin_564 (2)"))
    );
    let frames = made["frames"].as_array().ok_or("no frames")?;
    // 1.6 s at 30 frames a second, and the end.
    assert_eq!(frames.len(), 49);
    assert_eq!(
        (&frames[47][1]["time"], &frames[48][1]["time"]),
        (&json!(1.566_666_7), &json!(1.6))
    );
    assert_eq!(frames[15][1]["time"], 0.5);
    assert_eq!(frames[15][1]["clip"], "swim");
    assert_eq!(frames[15][1]["translation"], json!([1.0, 0.0, 0.0]));
    assert!(frames[15][1]["rotation"][1].as_f64() > Some(0.999), "{}", frames[15][1]);
    Ok(())
}

#[test]
fn a_scene_through_a_pipe_is_run() -> TestResult {
    let dolphin = dolphin();
    let through = stdout_of(&scene(&[
        &dolphin, &dolphin, "--place", "0,0,0", "--place", "y=-4..4", "--frames", "9",
    ])?);
    let report = run(&through, &[])?;
    let pairs: Vec<u64> = report["pairs"]
        .as_array()
        .ok_or("no pairs")?
        .iter()
        .filter_map(Value::as_u64)
        .collect();
    assert_eq!(pairs.len(), 9);
    assert!(pairs[0] == 0 && pairs[4] > 0 && pairs[8] == 0, "{pairs:?}");
    Ok(())
}

#[test]
fn paths_are_relative_to_the_file_that_is_written() -> TestResult {
    let dir = tempdir()?;
    std::fs::create_dir(dir.path().join("scenes"))?;
    std::fs::copy(asset("dolphin_564.glb"), dir.path().join("dolphin.glb"))?;
    let output = command()
        .current_dir(dir.path())
        .args(["scene", "dolphin.glb", "dolphin.glb", "--output", "scenes/two.json"])
        .output()?;
    stdout_of(&output);
    let written = Scene::read(&dir.path().join("scenes/two.json"))?;
    assert_eq!(written.bodies[0].model, Path::new("../dolphin.glb"));
    stdout_of(&run_program([
        "run".as_ref(),
        dir.path().join("scenes/two.json").as_os_str(),
    ])?);
    Ok(())
}

#[test]
fn node_transforms_place_meshes_and_clips_move_them() -> TestResult {
    let (dir, path) = crate::support::bound_and_free()?;
    let mut gltf: Value = serde_json::from_slice(&std::fs::read(&path)?)?;
    // The free mesh hangs on the node that the clip lifts.
    gltf["nodes"][1]["children"] = json!([3]);
    gltf["nodes"][3]["translation"] = json!([0, 0, 1]);
    gltf["nodes"][3]["name"] = json!("hanging");
    std::fs::write(&path, gltf.to_string())?;
    let model = path.display().to_string();
    let all = format!("{model}#all");
    let args = [&*all, "--clip", "rise", "--fps", "4", "--node-transforms"];
    let made = json_of(&args)?;
    assert_eq!(made["bodies"][0]["node"], 2, "its skin and its weights count");
    assert_eq!(
        (&made["bodies"][1]["node"], &made["bodies"][1]["name"]),
        (&3.into(), &json!("hanging"))
    );
    // The skinned triangle is lifted by its joint to 4 t and by its target to t, the other by the node to 4 t + 1.
    let report = run(&stdout_of(&scene(&args)?), &["--mode", "distance"])?;
    let distances = report["distances"].as_array().ok_or("no distances")?;
    for (frame, row) in distances.iter().enumerate() {
        let expected = 1.0 - 0.25 * frame as f64;
        assert_eq!(row["distance"].as_f64(), Some(expected), "{row}");
    }
    assert_eq!(distances.len(), 5);
    // Without node transforms, it is in its own space.
    let apart = json_of(&[&all, "--clip", "rise", "--fps", "4"])?;
    assert_eq!(apart["bodies"][1].get("node"), None);
    drop(dir);
    Ok(())
}

#[test]
fn what_does_not_fit_is_refused() -> TestResult {
    let dolphin = dolphin();
    for (args, parts) in [
        (
            &[&*dolphin, "--clip", "swmi"][..],
            &["--clip", "\"swmi\"", "did you mean \"swim\"?"][..],
        ),
        (
            &[&dolphin, "--clip", "swim", "--clip", "swim"],
            &["--clip", "2 times for 1 model"],
        ),
        (&[&dolphin, "--place", "1,2"], &["--place", "expected X,Y,Z"]),
        (
            &[&dolphin, "--place", "0,0,0", "--place", "0,0,0"],
            &["--place", "2 times for 1 model"],
        ),
        (&[&dolphin, "--weights", "1"], &["--weights", "1 weights for 2 targets"]),
        (&[&dolphin, "--fps", "0"], &["--fps"]),
        (&[&format!("{dolphin}#fin")], &["no mesh named \"fin\""]),
        (&[&dolphin, "--frames", "4000000"], &["--frames", "--memory-limit"]),
        (&["absent.glb"], &["absent.glb"]),
    ] {
        let message = error_of(&scene(args)?);
        for part in parts {
            assert!(message.contains(part), "{args:?}: no {part:?} in {message}");
        }
    }
    Ok(())
}

#[test]
fn names_and_comments_are_allowed_and_other_versions_are_refused() -> TestResult {
    let dir = tempdir()?;
    let write = |version: u32| {
        let body = json!({"model": asset("dolphin_564.glb"), "name": "Flipper", "comment": "the left one"});
        let scene = json!({"version": version, "name": "two", "comment": "a test", "bodies": [body], "frames": [[{"comment": "rest"}]]});
        crate::support::write_scene(dir.path(), &scene)
    };
    stdout_of(&run_program(["run".as_ref(), write(1)?.as_os_str()])?);
    let message = error_of(&run_program(["run".as_ref(), write(2)?.as_os_str()])?);
    assert!(
        message.contains("version 2") && message.contains("only version 1"),
        "{message}"
    );
    Ok(())
}

#[test]
fn a_key_of_a_place_that_is_given_twice_is_an_error() -> TestResult {
    let error = error_of(&scene(&[&dolphin(), "--place", "x=1,x=2"])?);
    assert!(
        error.contains("--place") && error.contains("x is given twice"),
        "{error}"
    );
    Ok(())
}

#[test]
fn a_scene_may_name_its_schema() -> TestResult {
    let mut made = json_of(&[&dolphin()])?;
    made["$schema"] = json!("https://example.org/scene.schema.json");
    assert_eq!(run(&made.to_string(), &[])?["pairs"], json!([0]));
    Ok(())
}
