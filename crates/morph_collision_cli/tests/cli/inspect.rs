//! `inspect` reports what is in a file.

use glam::Vec3;
use morph_collision_models::generated;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use serde_json::Value;
use tempfile::tempdir;

use crate::support::{RawMesh, TestResult, asset, error_of, run_program, stdout_of, write_gltf};

fn inspect_json(path: &std::path::Path) -> Result<Value, Box<dyn std::error::Error>> {
    let output = run_program(["inspect".as_ref(), path.as_os_str(), "--json".as_ref()])?;
    Ok(serde_json::from_str(&stdout_of(&output))?)
}

#[test]
fn the_json_describes_the_mesh_its_targets_its_clip_and_its_tree() -> TestResult {
    let path = asset("dolphin_564.glb");
    let report = inspect_json(&path)?;
    assert_eq!(report["file"], path.display().to_string());
    assert_eq!(report["meshes"].as_array().map(Vec::len), Some(1));
    let mesh = &report["meshes"][0];
    let dolphin = generated::dolphin(0);
    let model = dolphin.to_model()?;
    assert_eq!(mesh["index"], 0);
    assert_eq!(mesh["name"], dolphin.name);
    assert_eq!(mesh["rigid"], false);
    assert_eq!(mesh["triangles"], 564);
    assert_eq!(mesh["vertices_stored"], dolphin.positions.len());
    assert_eq!(mesh["vertices_welded"], model.vertex_count());
    assert_eq!(mesh.get("error"), None);

    for (index, name) in ["tail_down", "tail_up"].into_iter().enumerate() {
        let target = &mesh["targets"][index];
        assert_eq!(target["name"], name);
        let moved = model.displaced_vertex_count(index as u32);
        assert_eq!(target["vertices_moved"], moved);
        let share = 1.0 - moved as f64 / model.vertex_count() as f64;
        assert_eq!(target["share_left_alone"].as_f64(), Some(share));
    }

    let clip = &mesh["animations"][0];
    assert_eq!(clip["name"], "swim");
    assert_eq!(clip["keys"], dolphin.animations[0].times.len());
    assert_eq!(clip["weights"].as_array().map(Vec::len), Some(2));
    assert_eq!(clip["weights"][0]["min"], 0.0);
    assert_eq!(clip["weights"][0]["max"], 1.0);
    assert_eq!(clip["weight_sum"]["min"], 0.0);
    assert_eq!(clip["weight_sum"]["max"], 1.0);
    assert!(clip["seconds"].as_f64() > Some(1.0));

    let tree = &mesh["tree"];
    assert!(
        tree["nodes"].as_u64() > Some(1) && tree["depth"].as_u64() > Some(1) && tree["bytes"].as_u64() > Some(1000)
    );
    Ok(())
}

#[test]
fn the_tables_name_targets_and_clips() -> TestResult {
    let stdout = stdout_of(&run_program([
        "inspect".as_ref(),
        asset("dolphin_564.glb").as_os_str(),
    ])?);
    for part in [
        "564",
        "tail_down",
        "tail_up",
        "\"swim\"",
        "0.000 .. 1.000",
        "welded",
        "nodes",
        " KiB",
    ] {
        assert!(stdout.contains(part), "no {part} in\n{stdout}");
    }
    Ok(())
}

#[test]
fn a_mesh_without_targets_is_rigid() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("box.glb");
    let looks = Appearance {
        base_color: [1.0; 4],
        roughness: 1.0,
    };
    write_glb(&path, &generated::rigid::box_mesh(Vec3::ONE), &looks)?;
    let report = inspect_json(&path)?;
    assert_eq!(report["meshes"][0]["rigid"], true);
    assert_eq!(report["meshes"][0]["targets"].as_array().map(Vec::len), Some(0));
    let stdout = stdout_of(&run_program(["inspect".as_ref(), path.as_os_str()])?);
    assert!(stdout.contains("none: rigid"), "{stdout}");
    Ok(())
}

#[test]
fn an_unusable_mesh_shows_its_error_beside_usable_ones() -> TestResult {
    let dir = tempdir()?;
    let mut broken = RawMesh::triangle("Cracked");
    broken.positions[1][2] = f32::NAN;
    let path = write_gltf(dir.path(), "two.gltf", &[broken, RawMesh::triangle("Sound")])?;
    let report = inspect_json(&path)?;
    let [cracked, sound] = [&report["meshes"][0], &report["meshes"][1]];
    let error = cracked["error"].as_str().unwrap_or_default();
    assert!(error.contains("base, vertex 1"), "{error}");
    assert_eq!(cracked.get("tree"), None);
    assert_eq!(sound["name"], "Sound");
    assert_eq!(sound["targets"][0]["share_left_alone"], 0.0);
    let stdout = stdout_of(&run_program(["inspect".as_ref(), path.as_os_str()])?);
    assert!(stdout.contains("base, vertex 1"), "{stdout}");
    Ok(())
}

/// Rewrites the JSON of a file.
fn bend(path: &std::path::Path, bend: impl FnOnce(&mut Value)) -> TestResult {
    let mut gltf = serde_json::from_slice(&std::fs::read(path)?)?;
    bend(&mut gltf);
    Ok(std::fs::write(path, gltf.to_string())?)
}

#[test]
fn a_mesh_of_points_says_so() -> TestResult {
    let dir = tempdir()?;
    let path = write_gltf(dir.path(), "points.gltf", &[RawMesh::triangle("Cloud")])?;
    bend(&path, |gltf| gltf["meshes"][0]["primitives"][0]["mode"] = 0.into())?;
    for command in [&["inspect"][..], &["query", "--self"]] {
        let args = command.iter().map(AsRef::as_ref).chain([path.as_os_str()]);
        let message = error_of(&run_program(args)?);
        assert!(message.contains("made of points"), "{message}");
    }
    Ok(())
}

#[test]
fn what_is_broken_and_not_needed_is_shown_beside_the_rest() -> TestResult {
    let dir = tempdir()?;
    let path = write_gltf(
        dir.path(),
        "parts.gltf",
        &[RawMesh::triangle("Sound"), RawMesh::triangle("Lost")],
    )?;
    bend(&path, |gltf| {
        gltf["meshes"][1]["primitives"][0]["attributes"]["POSITION"] = 99.into();
        gltf["nodes"] = serde_json::json!([{"mesh": 0}]);
        let channel = |node: u32| serde_json::json!({"sampler": 9, "target": {"node": node, "path": "weights"}});
        gltf["animations"] = serde_json::json!([{"name": "talk", "channels": [channel(0), channel(7)]}]);
    })?;
    let report = inspect_json(&path)?;
    assert_eq!(report["meshes"][0]["triangles"], 1);
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    assert!(text(&report["meshes"][1]["error"]).contains("accessor 99"), "{report}");
    assert!(
        text(&report["meshes"][0]["warnings"][0]).contains("\"talk\" is left out"),
        "{report}"
    );
    assert!(
        text(&report["warnings"][0]).contains("channel 1: node 7 does not exist"),
        "{report}"
    );
    Ok(())
}

#[test]
fn names_reach_the_terminal_escaped() -> TestResult {
    let dir = tempdir()?;
    let path = write_gltf(dir.path(), "names.gltf", &[RawMesh::triangle("x")])?;
    let name = "\u{1b}[2J\u{202e}evil\nmesh 7 \"fake\"\u{9b}31m";
    bend(&path, |gltf| {
        gltf["meshes"][0]["name"] = name.into();
        gltf["meshes"][0]["extras"] = serde_json::json!({ "targetNames": [name] });
    })?;
    let is_safe = |text: &str| !text.contains(['\u{1b}', '\u{202e}', '\u{9b}']) && !text.contains("\nmesh 7");
    let stdout = stdout_of(&run_program(["inspect".as_ref(), path.as_os_str()])?);
    assert!(is_safe(&stdout) && stdout.contains("evil"), "{stdout:?}");
    let output = run_program(["inspect".as_ref(), path.as_os_str(), "--json".as_ref()])?;
    let json = stdout_of(&output);
    assert!(is_safe(&json), "{json:?}");
    let report: Value = serde_json::from_str(&json)?;
    assert_eq!(report["meshes"][0]["name"], name);
    // The same holds in messages.
    bend(&path, |gltf| gltf["meshes"][0]["primitives"][0]["indices"] = 99.into())?;
    let message = error_of(&run_program(["query".as_ref(), path.as_os_str(), "--self".as_ref()])?);
    assert!(
        is_safe(&message) && message.contains("evil") && message.lines().count() == 1,
        "{message:?}"
    );
    Ok(())
}

#[test]
fn sums_of_large_weights_are_numbers_in_json() -> TestResult {
    let mut mesh = generated::dolphin(0);
    for key in &mut mesh.animations[0].weights {
        key.fill(3e38);
    }
    let dir = tempdir()?;
    let path = dir.path().join("large.glb");
    let looks = Appearance {
        base_color: [1.0; 4],
        roughness: 1.0,
    };
    write_glb(&path, &mesh, &looks)?;
    let report = inspect_json(&path)?;
    let sum = &report["meshes"][0]["animations"][0]["weight_sum"]["max"];
    assert!(sum.as_f64().is_some_and(|sum| sum > 5e38), "{sum}");
    Ok(())
}

#[test]
fn bounds_nodes_and_reach_are_shown() -> TestResult {
    let dir = tempdir()?;
    let path = write_gltf(dir.path(), "placed.gltf", &[RawMesh::triangle("Placed")])?;
    bend(&path, |gltf| {
        gltf["nodes"] = serde_json::json!([
            {"children": [1], "scale": [2, 2, 2]},
            {"mesh": 0, "name": "stand", "translation": [0, 3, 0]},
        ]);
        gltf["extensionsRequired"] = serde_json::json!(["VRMC_vrm"]);
    })?;
    let report = inspect_json(&path)?;
    assert_eq!(
        (&report["version"], &report["extension_notes"][0]),
        (
            &1.into(),
            &"VRMC_vrm: its expressions are read; gaze is not applied".into()
        )
    );
    let mesh = &report["meshes"][0];
    assert_eq!(mesh["bounds"]["max"], serde_json::json!([1.0, 1.0, 0.0]));
    assert_eq!(mesh["targets"][0]["reach"], 1.0);
    let node = &mesh["nodes"][0];
    assert_eq!((&node["index"], &node["name"]), (&1.into(), &"stand".into()));
    assert_eq!((&node["translation"][1], &node["scale"][0]), (&6.0.into(), &2.0.into()));
    let text = stdout_of(&run_program(["inspect".as_ref(), path.as_os_str()])?);
    for part in [
        "note: VRMC_vrm: its expressions are read",
        "bounds      0 0 0 to 1 1 0 at rest",
        "node 1 \"stand\": translation 0 6 0",
    ] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
    Ok(())
}

#[test]
fn a_file_of_many_meshes_is_summed_up_and_one_can_be_shown_in_full() -> TestResult {
    let dir = tempdir()?;
    let names = ["a", "b", "c", "d", "elbow"].map(RawMesh::triangle);
    let path = write_gltf(dir.path(), "many.gltf", &names)?;
    let text = stdout_of(&run_program(["inspect".as_ref(), path.as_os_str()])?);
    assert!(
        text.contains("mesh  name") && text.contains("--mesh N") && !text.contains("bounds"),
        "{text}"
    );
    for mesh in ["elbow", "4"] {
        let args = ["inspect".as_ref(), path.as_os_str(), "--mesh".as_ref(), mesh.as_ref()];
        let text = stdout_of(&run_program(args)?);
        assert!(text.contains("mesh 4 \"elbow\"") && text.contains("bounds"), "{text}");
    }
    let args = [
        "inspect".as_ref(),
        path.as_os_str(),
        "--mesh".as_ref(),
        "elbwo".as_ref(),
    ];
    let message = error_of(&run_program(args)?);
    assert!(message.contains("did you mean \"elbow\"?"), "{message}");
    Ok(())
}

#[test]
fn several_files_get_one_line_each_and_totals() -> TestResult {
    let dir = tempdir()?;
    let two = write_gltf(
        dir.path(),
        "two.gltf",
        &[RawMesh::triangle("a"), RawMesh::triangle("b")],
    )?;
    let dolphin = asset("dolphin_564.glb");
    let text = stdout_of(&run_program([
        "inspect".as_ref(),
        two.as_os_str(),
        dolphin.as_os_str(),
    ])?);
    assert_eq!(text.lines().count(), 4, "{text}");
    assert!(
        text.ends_with("2 files: 3 of 3 meshes can collide; 566 triangles, 298 vertices, 4 targets\n"),
        "{text}"
    );
    let absent = dir.path().join("absent.glb");
    let output = run_program(["inspect".as_ref(), two.as_os_str(), absent.as_os_str()])?;
    assert!(error_of(&output).contains("1 of 2 files failed"));
    assert!(String::from_utf8_lossy(&output.stdout).contains("absent.glb: No such file"));
    let args = [
        "inspect".as_ref(),
        two.as_os_str(),
        dolphin.as_os_str(),
        "--json".as_ref(),
    ];
    let report: Value = serde_json::from_str(&stdout_of(&run_program(args)?))?;
    assert_eq!(
        (&report["files"][0]["usable"], &report["files"][1]["triangles"]),
        (&2.into(), &564.into())
    );
    Ok(())
}

#[test]
fn a_glb_comes_through_a_pipe() -> TestResult {
    let mut child = crate::support::command()
        .args(["inspect", "-"])
        .stdin(std::fs::File::open(asset("dolphin_564.glb"))?)
        .stdout(std::process::Stdio::piped())
        .spawn()?;
    let mut text = String::new();
    std::io::Read::read_to_string(&mut child.stdout.take().ok_or("no stdout")?, &mut text)?;
    assert!(child.wait()?.success() && text.contains("564"), "{text}");
    Ok(())
}
