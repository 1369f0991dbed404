//! Every bad input ends with exit code 2 and a message that names the file and the place in it, never with a panic.

use std::error::Error;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::tempdir;

use crate::support::{RawMesh, TestResult, asset, command, error_of, run_program, write_gltf, write_scene};

fn error_of_run(scene: &Path) -> Result<String, Box<dyn Error>> {
    Ok(error_of(&run_program(["run".as_ref(), scene.as_os_str()])?))
}

fn error_of_inspect(model: &Path) -> Result<String, Box<dyn Error>> {
    Ok(error_of(&run_program(["inspect".as_ref(), model.as_os_str()])?))
}

/// A scene of two triangles that is valid except for the given state of the second body in frame 1.
fn scene_with(dir: &Path, state: &Value) -> Result<PathBuf, Box<dyn Error>> {
    write_gltf(dir, "triangle.gltf", &[RawMesh::triangle("Triangle")])?;
    let body = json!({ "model": "triangle.gltf" });
    write_scene(
        dir,
        &json!({ "bodies": [body, body], "frames": [[{}, {}], [{}, state], [{}, {}]] }),
    )
}

fn assert_names(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "no {part:?} in: {message}");
    }
}

#[test]
fn a_missing_file_is_named() -> TestResult {
    let dir = tempdir()?;
    assert_names(&error_of_inspect(&dir.path().join("absent.glb"))?, &["absent.glb"]);
    assert_names(&error_of_run(&dir.path().join("absent.json"))?, &["absent.json"]);
    let scene = write_scene(
        dir.path(),
        &json!({ "bodies": [{ "model": "absent.glb" }], "frames": [] }),
    )?;
    assert_names(&error_of_run(&scene)?, &["absent.glb"]);
    Ok(())
}

#[test]
fn a_file_that_is_no_gltf_is_named() -> TestResult {
    let dir = tempdir()?;
    for (name, content) in [
        ("text.glb", "hello"),
        ("empty.gltf", ""),
        ("cut.glb", "glTF\u{2}\0\0\0"),
    ] {
        let path = dir.path().join(name);
        std::fs::write(&path, content)?;
        assert_names(&error_of_inspect(&path)?, &[name]);
    }
    assert_names(&error_of_inspect(dir.path())?, &[&dir.path().display().to_string()]);
    Ok(())
}

#[test]
fn a_broken_scene_is_named_with_line_and_column() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("scene.json");
    for content in [
        "{\n  \"bodies\": [",
        "{\n  \"bodies\": [], \"frame\": []}",
        "{\n  \"bodies\": [{\"model\": 3}], \"frames\": []}",
        "{\n  \"bodies\": [{\"model\": \"a\"}], \"frames\": [[{\"weights\": [NaN]}]]}",
    ] {
        std::fs::write(&path, content)?;
        assert_names(&error_of_run(&path)?, &["scene.json", "line 2", "column"]);
    }
    Ok(())
}

#[test]
fn a_frame_that_forgets_a_body_is_named() -> TestResult {
    let dir = tempdir()?;
    write_gltf(dir.path(), "triangle.gltf", &[RawMesh::triangle("Triangle")])?;
    let body = json!({ "model": "triangle.gltf" });
    let scene = write_scene(
        dir.path(),
        &json!({ "bodies": [body, body], "frames": [[{}, {}], [{}]] }),
    )?;
    assert_names(&error_of_run(&scene)?, &["scene.json", "frame 1"]);
    Ok(())
}

#[test]
fn weights_of_the_wrong_length_are_named_with_frame_and_body() -> TestResult {
    let dir = tempdir()?;
    let scene = scene_with(dir.path(), &json!({ "weights": [0.5, 0.5, 0.5] }))?;
    assert_names(
        &error_of_run(&scene)?,
        &["scene.json", "frame 1", "body 1", "3 weights", "1 targets"],
    );
    Ok(())
}

#[test]
fn numbers_that_are_not_finite_are_named_with_their_place() -> TestResult {
    let dir = tempdir()?;
    // Finite in JSON, infinite in f32; the file is one line long.
    for state in [
        json!({ "weights": [1e39] }),
        json!({ "rotation": [0, 0, 0, 1e39] }),
        json!({ "scale": [1, 1, 1e39] }),
        json!({ "translation": [1e39, 0, 0] }),
    ] {
        let scene = scene_with(dir.path(), &state)?;
        assert_names(
            &error_of_run(&scene)?,
            &["scene.json", "number out of range at line 1 column"],
        );
    }
    // A weight that takes vertices beyond the range of f32.
    let scene = scene_with(dir.path(), &json!({ "weights": [3e38] }))?;
    assert_names(&error_of_run(&scene)?, &["scene.json", "frame 1", "body 1", "weight 0"]);
    Ok(())
}

#[test]
fn a_rotation_of_length_zero_is_named() -> TestResult {
    let dir = tempdir()?;
    let scene = scene_with(dir.path(), &json!({ "rotation": [0, 0, 0, 0] }))?;
    assert_names(&error_of_run(&scene)?, &["scene.json", "frame 1", "body 1", "rotation"]);
    Ok(())
}

#[test]
fn a_mesh_that_the_model_has_not_is_named_with_the_body() -> TestResult {
    let dir = tempdir()?;
    write_gltf(dir.path(), "triangle.gltf", &[RawMesh::triangle("Triangle")])?;
    let bodies = json!([{ "model": "triangle.gltf" }, { "model": "triangle.gltf", "mesh": 3 }]);
    let scene = write_scene(dir.path(), &json!({ "bodies": bodies, "frames": [] }))?;
    assert_names(
        &error_of_run(&scene)?,
        &["scene.json", "body 1", "triangle.gltf", "mesh 3"],
    );
    Ok(())
}

#[test]
fn a_broken_mesh_is_named_with_file_mesh_and_index() -> TestResult {
    let sound = RawMesh::triangle("Broken");
    let mut out_of_range = sound.clone();
    out_of_range.indices[2] = 7;
    let mut no_triangles = sound.clone();
    no_triangles.positions.clear();
    no_triangles.indices.clear();
    no_triangles.targets.clear();
    let mut short_target = sound.clone();
    short_target.targets.push(vec![[0.0; 3]; 2]);
    let mut not_a_number = sound.clone();
    not_a_number.targets[0][2][1] = f32::NAN;

    let dir = tempdir()?;
    for (mesh, index) in [
        (out_of_range, "7"),
        (no_triangles, "no "),
        (short_target, "target 1"),
        (not_a_number, "target 0, vertex 2"),
    ] {
        let path = write_gltf(dir.path(), "broken.gltf", &[mesh])?;
        let names = ["broken.gltf", "mesh 0", "Broken", index];
        assert_names(&error_of_inspect(&path)?, &names);
        let scene = write_scene(
            dir.path(),
            &json!({ "bodies": [{ "model": "broken.gltf" }], "frames": [[{}]] }),
        )?;
        assert_names(&error_of_run(&scene)?, &names);
    }
    Ok(())
}

#[test]
fn a_file_without_meshes_is_named() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("bare.gltf");
    std::fs::write(&path, r#"{"asset": {"version": "2.0"}}"#)?;
    assert_names(&error_of_inspect(&path)?, &["bare.gltf", "no usable mesh"]);
    Ok(())
}

#[test]
fn a_csv_file_that_cannot_be_written_is_named() -> TestResult {
    let dir = tempdir()?;
    let scene = scene_with(dir.path(), &json!({}))?;
    let csv = dir.path().join("absent").join("pairs.csv");
    let output = run_program(["run".as_ref(), scene.as_os_str(), "--pairs".as_ref(), csv.as_os_str()])?;
    assert_names(&error_of(&output), &["pairs.csv"]);
    Ok(())
}

#[test]
fn a_command_line_that_makes_no_sense_is_an_error_too() -> TestResult {
    for args in [
        &["run"][..],
        &["frobnicate"],
        &["run", "a.json", "--mode", "some"],
        &["run", "a.json", "--leaf", "0"],
        &["run", "a.json", "--method", "paper"],
        &["inspect", "a.glb", "--memory-limit", "much"],
    ] {
        error_of(&run_program(args)?);
    }
    Ok(())
}

#[test]
fn a_time_without_a_clip_is_named_with_frame_and_body() -> TestResult {
    let dir = tempdir()?;
    let scene = scene_with(dir.path(), &json!({ "time": 0.5 }))?;
    assert_names(
        &error_of_run(&scene)?,
        &[
            "scene.json",
            "frame 1, body 1",
            "\"time\" has no effect without \"clip\"",
        ],
    );
    Ok(())
}

#[test]
fn a_model_in_place_of_a_scene_and_a_scene_in_place_of_a_model_get_a_hint() -> TestResult {
    let dir = tempdir()?;
    let scene = scene_with(dir.path(), &json!({}))?;
    let model = dir.path().join("triangle.gltf");
    assert_names(
        &error_of_run(&model)?,
        &[
            "triangle.gltf: this is a model, not a scene file",
            "morph-collide scene",
        ],
    );
    let motion = error_of(&run_program(["motion".as_ref(), model.as_os_str()])?);
    assert_names(&motion, &["this is a model, not a scene file"]);
    let query = ["query".as_ref(), scene.as_os_str(), "--self".as_ref()];
    assert_names(
        &error_of(&run_program(query)?),
        &["scene.json: this is a scene file, not a model", "morph-collide run"],
    );
    // Other JSON is what the reader says.
    let other = dir.path().join("other.json");
    std::fs::write(&other, "{}")?;
    assert_names(&error_of_inspect(&other)?, &["other.json: not a glTF 2.0 file"]);
    Ok(())
}

/// The messages were "expected value at line 1 column 1" and the like.
#[test]
fn pointers_of_git_lfs_are_called_so() -> TestResult {
    let dir = tempdir()?;
    let pointer = dir.path().join("pointer.json");
    std::fs::write(
        &pointer,
        "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n",
    )?;
    let [pointer, model] = [pointer, asset("dolphin_564.glb")].map(|path| path.display().to_string());
    let weights = format!("@{pointer}");
    for args in [
        &["run", &pointer][..],
        &["query", &model, "--self", "--weights", &weights],
        &["lint", &model, "--baseline", &pointer],
        &["lint", &model, "--capture", &pointer],
    ] {
        let message = error_of(&command().args(args).output()?);
        assert!(message.contains("pointer.json: is a Git LFS pointer"), "{message}");
    }
    Ok(())
}
