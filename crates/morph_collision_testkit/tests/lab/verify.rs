//! `verify` compares trees with brute force.

use std::error::Error;
use std::path::Path;

use serde_json::Value;
use tempfile::tempdir;

use morph_collision_models::generated::rigs::tube;
use morph_collision_models::gltf::write::{Appearance, write_glb};

use crate::support::{RawMesh, TestResult, asset, bound_and_free, error_of, field, run_program, stdout_of, write_gltf};

fn verify(model: &Path, flags: &[&str]) -> Result<std::process::Output, Box<dyn Error>> {
    let mut args = vec!["verify".as_ref(), model.as_os_str()];
    args.extend(flags.iter().map(AsRef::<std::ffi::OsStr>::as_ref));
    run_program(args)
}

fn json(model: &Path, flags: &[&str]) -> Result<Value, Box<dyn Error>> {
    let flags = [flags, &["--json"]].concat();
    Ok(serde_json::from_str(&stdout_of(&verify(model, &flags)?))?)
}

#[test]
fn a_dolphin_is_verified_with_trees_of_several_leaf_sizes() -> TestResult {
    let report = json(&asset("dolphin_564.glb"), &["--frames", "12", "--seed", "3"])?;
    assert_eq!((&report["frames"], &report["seed"]), (&12.into(), &3.into()));
    assert!(report["pairs_truth"].as_u64() > Some(20), "{report}");
    assert!(report["containment_checks"].as_u64() > Some(100_000));
    let motion = &report["motion"];
    for count in ["missed", "spurious", "wrong_times", "wrong_geometry"] {
        assert_eq!(motion[count], 0, "{motion}");
    }
    assert!(
        motion["contacts"].as_u64() > Some(0) && motion["pairs"].as_u64() > Some(0),
        "{motion}"
    );
    for count in ["missed", "spurious", "containment_violations"] {
        assert_eq!(report[count], 0, "{count}");
    }
    assert!(report["undecided_by_filter"].is_u64());
    assert!(report["reproduction"].is_null());
    let trees = report["trees"].as_array().ok_or("no list of trees")?;
    let leaf_sizes: Vec<_> = trees.iter().filter_map(|row| row["leaf_size"].as_u64()).collect();
    assert_eq!(leaf_sizes, [8, 2, 20]);
    for row in trees {
        assert_eq!(
            (&row["frames"], &row["pairs_truth"]),
            (&report["frames"], &report["pairs_truth"])
        );
    }
    Ok(())
}

#[test]
fn the_seed_decides_the_situations() -> TestResult {
    let model = asset("dolphin_564.glb");
    let of_seed = |seed| json(&model, &["--frames", "8", "--leaf", "3", "--seed", seed]);
    assert_eq!(of_seed("1")?, of_seed("1")?);
    assert_ne!(of_seed("1")?["pairs_truth"], of_seed("2")?["pairs_truth"]);
    Ok(())
}

#[test]
fn two_models_and_other_trees_are_verified_too() -> TestResult {
    let dir = tempdir()?;
    let two = [RawMesh::triangle("One"), RawMesh::triangle("Two")];
    let path = write_gltf(dir.path(), "two.gltf", &two)?;
    let dolphin = asset("dolphin_564.glb").display().to_string();
    let flags = ["--against", &*dolphin, "--mesh", "Two", "--frames", "20", "--leaf", "1"];
    let report = json(&path, &flags)?;
    assert_eq!(report["bodies"][0]["mesh"], 1);
    assert_eq!(report["bodies"][1]["model"], *dolphin);
    assert!(report["pairs_truth"].as_u64() > Some(0), "{report}");
    assert_eq!(report["missed"], 0);
    let text = stdout_of(&verify(&path, &["--frames", "5", "--leaf", "7"])?);
    assert!(
        text.starts_with("5 frames of seed 1") && text.contains("\n       7 ") && !text.contains("\n       8 "),
        "{text}"
    );
    Ok(())
}

#[test]
fn bad_input_is_named() -> TestResult {
    let dir = tempdir()?;
    let path = write_gltf(
        dir.path(),
        "two.gltf",
        &[RawMesh::triangle("One"), RawMesh::triangle("Two")],
    )?;
    let second = path.display().to_string();
    for (flags, names) in [
        (&["--mesh", "2"][..], &["--mesh", "two.gltf", "2"][..]),
        (&["--mesh", "Tow"], &["--mesh", "\"Tow\"", "did you mean \"Two\"?"]),
        (&["--against-mesh", "1"], &["--against"]),
        (
            &["--against", &second, "--against-mesh", "5"],
            &["--against-mesh", "two.gltf"],
        ),
        (&[&second, "--mesh", "1"], &["--mesh", "one model"]),
        (&["--leaf", "0"], &["--leaf", "0"]),
        (&["--frames", "-1"], &["-1"]),
    ] {
        let message = error_of(&verify(&path, flags)?);
        for name in names {
            assert!(message.contains(name), "no {name:?} in: {message}");
        }
    }
    let message = error_of(&verify(&dir.path().join("absent.glb"), &[])?);
    assert!(message.contains("absent.glb"), "{message}");
    let mut huge = RawMesh::triangle("Huge");
    huge.positions[2] = [0.0, 3e37, 0.0];
    let huge = write_gltf(dir.path(), "huge.gltf", &[huge])?.display().to_string();
    let message = error_of(&verify(&path, &["--against", &huge])?);
    assert!(
        message.contains("huge.gltf") && message.contains("vertex 2"),
        "{message}"
    );
    Ok(())
}

#[test]
fn the_last_line_is_the_verdict_and_a_comparison_of_nothing_fails() -> TestResult {
    let text = stdout_of(&verify(&asset("dolphin_564.glb"), &["--frames", "4", "--leaf", "8"])?);
    let last = text.lines().last().unwrap_or_default();
    assert!(
        last.starts_with("All ") && last.ends_with(" answers agree with brute force."),
        "{text}"
    );
    let output = verify(&asset("dolphin_564.glb"), &["--frames", "0"])?;
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        text.ends_with("Nothing was compared, because no frames were asked for.\n"),
        "{text}"
    );
    Ok(())
}

#[test]
fn several_models_get_a_line_per_mesh_and_a_total() -> TestResult {
    let dir = tempdir()?;
    let meshes = [RawMesh::triangle("One"), RawMesh::triangle("Two")];
    let path = write_gltf(dir.path(), "two.gltf", &meshes)?.display().to_string();
    let text = stdout_of(&verify(
        &asset("dolphin_564.glb"),
        &[&path, "--frames", "20", "--leaf", "8"],
    )?);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 4, "{text}");
    assert!(lines[0].contains("dolphin_564.glb mesh 0: agrees, "), "{text}");
    assert!(lines[2].contains("two.gltf mesh 1: agrees, "), "{text}");
    assert!(lines[3].starts_with("3 of 3 meshes agree with brute force"), "{text}");
    let absent = verify(
        &asset("dolphin_564.glb"),
        &["absent.glb", "--frames", "2", "--leaf", "8"],
    )?;
    assert_eq!(absent.status.code(), Some(2));
    let text = String::from_utf8_lossy(&absent.stdout);
    assert!(
        text.contains("absent.glb mesh 0: error: ") && text.contains("1 of 2 meshes agree"),
        "{text}"
    );
    Ok(())
}

#[test]
fn without_a_terminal_progress_comes_in_lines() -> TestResult {
    let flags = ["--frames", "3", "--leaf", "8", "--progress", "0"];
    let output = verify(&asset("dolphin_564.glb"), &flags)?;
    let stderr = String::from_utf8_lossy(&output.stderr);
    let lines: Vec<&str> = stderr.lines().collect();
    // Three situations, and one motion.
    let expected = ["frame 1 of 3", "frame 2 of 3", "frame 3 of 3", "motion 1 of 1"];
    assert_eq!(lines.len(), expected.len(), "{stderr}");
    for (line, what) in lines.iter().zip(expected) {
        let start = format!("morph-lab: progress: {what} after ");
        assert!(line.starts_with(&start), "{line}");
    }
    Ok(())
}

#[test]
fn a_broken_clip_is_left_out_with_a_warning() -> TestResult {
    let dir = tempdir()?;
    let path = write_gltf(
        dir.path(),
        "clip.gltf",
        &[RawMesh::triangle("One"), RawMesh::triangle("Two")],
    )?;
    let mut gltf: Value = serde_json::from_slice(&std::fs::read(&path)?)?;
    gltf["nodes"] = serde_json::json!([{"mesh": 0}]);
    gltf["animations"] = serde_json::json!([{
        "name": "talk",
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
        "samplers": [{"input": 77, "output": 77}],
    }]);
    std::fs::write(&path, gltf.to_string())?;
    let output = verify(&path, &["--frames", "30"])?;
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && told.contains("warning: left out: ") && told.contains("animation 0 \"talk\""),
        "{told}"
    );
    // The clip is not one of this mesh.
    json(&path, &["--frames", "30", "--mesh", "1"])?;
    Ok(())
}

#[test]
fn joints_are_drawn() -> TestResult {
    let (_dir, path) = bound_and_free()?;
    let report = json(&path, &["--frames", "20"])?;
    assert_eq!((&report["missed"], &report["spurious"]), (&0.into(), &0.into()));
    assert!(report["containment_checks"].as_u64() > Some(100), "{report}");
    Ok(())
}

#[test]
fn triangles_of_vertices_without_joint_weights_are_left_out() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("rig.glb");
    let mut mesh = tube(3, 6, 4, 1);
    let mut write = |count: usize| {
        if let Some(skin) = &mut mesh.skin {
            for set in &mut skin.sets {
                set.weights
                    .iter_mut()
                    .take(count)
                    .for_each(|weights| *weights = [0.0; 4]);
            }
        }
        write_glb(&path, &mesh, &Appearance::default())
    };
    write(2)?;
    let output = verify(&path, &["--frames", "8"])?;
    let warning = String::from_utf8_lossy(&output.stderr);
    assert!(warning.contains("2 vertices have no joint weights"), "{warning}");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && text.contains("agree with brute force"),
        "{text}"
    );
    write(usize::MAX)?;
    let output = verify(&path, &["--frames", "8"])?;
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr.contains("have no joint weights") && stderr.contains("error: "),
        "{stderr}"
    );
    Ok(())
}

#[test]
fn bad_triangles_are_left_out_on_demand() -> TestResult {
    // Of its 68 triangles, six have a vertex with a weight that is NaN.
    let model = field("c34_nan_weight_of_one_vertex.glb");
    let error = error_of(&verify(&model, &["--frames", "1"])?);
    assert!(error.contains("; --skip-bad leaves out what is bad"), "{error}");
    let output = verify(&model, &["--frames", "1", "--skip-bad", "--json"])?;
    let report: Value = serde_json::from_slice(&output.stdout)?;
    assert_eq!(report["left_out"][0]["triangles"], 6, "{report}");
    Ok(())
}

#[test]
fn a_model_that_needs_too_much_memory_is_refused() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("bomb.gltf");
    let bomb = serde_json::json!({
        "asset": {"version": "2.0"},
        "accessors": [{"componentType": 5126, "type": "VEC3", "count": 15_000_000}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    });
    std::fs::write(&path, bomb.to_string())?;
    let model = path.to_str().ok_or("not UTF-8")?;
    for args in [
        &["verify", model, "--frames", "1"][..],
        &["bench", model, "--method", "hybrid"],
    ] {
        let message = error_of(&run_program(args)?);
        let named = message.contains("bomb.gltf") && message.contains("mesh 0") && message.contains("tree");
        assert!(named && message.contains("--memory-limit"), "{args:?}: {message}");
    }
    Ok(())
}
