//! `run`: all methods find what the library finds.

use std::error::Error;
use std::ffi::OsString;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::tempdir;

use crate::support::{TestResult, asset, bound_and_free, error_of, mixed_scene, run_program, stdout_of, write_scene};

/// Runs a scene and returns its JSON and the text of its CSV file.
fn run(scene: &Path, options: &[&str]) -> Result<(Value, String), Box<dyn Error>> {
    let dir = tempdir()?;
    let csv = dir.path().join("pairs.csv");
    let mut args: Vec<OsString> = vec!["run".into(), scene.into(), "--json".into(), "--pairs".into()];
    args.push(csv.clone().into());
    args.extend(options.iter().map(Into::into));
    let stdout = stdout_of(&run_program(args)?);
    Ok((serde_json::from_str(&stdout)?, std::fs::read_to_string(csv)?))
}

/// The complaint of a run that must fail.
fn error(scene: &Path, options: &[&str]) -> Result<String, Box<dyn Error>> {
    let mut args: Vec<OsString> = vec!["run".into(), scene.into()];
    args.extend(options.iter().map(Into::into));
    Ok(error_of(&run_program(args)?))
}

#[test]
fn every_method_and_every_tree_finds_the_same_pairs() -> TestResult {
    let dir = tempdir()?;
    let scene = mixed_scene(dir.path())?;
    // The oracle.
    let (report, expected) = run(&scene, &["--method", "brute-force"])?;
    assert_eq!(report["method"], "brute-force");
    assert!(expected.lines().count() > 1000);
    let methods = [
        "morph",
        "hybrid",
        "bottom-up",
        "paper",
        "bottom-up-scalar",
        "hybrid-scalar",
        "parry-trimesh",
        "joint-boxes",
    ];
    for method in methods {
        let (report, csv) = run(&scene, &["--method", method])?;
        assert_eq!(csv, expected, "{method}");
        assert_eq!(report["method"], method);
    }
    let (report, csv) = run(&scene, &["--method", "hybrid-binary"])?;
    assert_eq!((csv, &report["method"]), (expected.clone(), &"hybrid-scalar".into()));
    for tree in [
        &["--leaf", "9"][..],
        &["--method", "hybrid-scalar", "--arity", "2", "--leaf", "1"],
    ] {
        assert_eq!(run(&scene, tree)?.1, expected, "{tree:?}");
    }
    for volume in ["aabb", "kdop14", "kdop18", "kdop26", "sphere"] {
        let paper = ["--method", "paper", "--volume", volume];
        for options in [&paper[..], &[&paper[..], &["--in-betweens"]].concat()] {
            assert_eq!(run(&scene, options)?.1, expected, "{options:?}");
        }
    }
    Ok(())
}

#[test]
fn the_tree_changes_the_work() -> TestResult {
    let scene = asset("scenes/two_dolphins.json");
    let work = |options: &[&str]| -> Result<Option<u64>, Box<dyn Error>> {
        Ok(run(&scene, options)?.0["node_tests"].as_u64())
    };
    let default = work(&[])?;
    for options in [["--leaf", "4"], ["--method", "hybrid-scalar"]] {
        assert_ne!(work(&options)?, default, "{options:?}");
    }
    let paper = ["--method", "paper"];
    let boxes = work(&paper)?;
    assert_eq!(work(&[&paper[..], &["--volume", "aabb"]].concat())?, boxes);
    for options in [&["--volume", "kdop18"][..], &["--volume", "sphere"], &["--in-betweens"]] {
        assert_ne!(work(&[&paper[..], options].concat())?, boxes, "{options:?}");
    }
    Ok(())
}

#[test]
fn methods_pose_joints_by_clips() -> TestResult {
    let (dir, model) = bound_and_free()?;
    let model = model.file_name().map(|name| name.to_string_lossy());
    let there = |z: f32| json!({"translation": [10, 0, z]});
    let scene = json!({
        "bodies": [{"model": model}, {"model": model, "mesh": 1}],
        "frames": [
            [{}, there(0.0)],
            [{}, {}],
            [{"clip": "rise", "time": 0.5}, there(2.5)],
            [{"clip": "rise", "time": 1.25, "scale": [1, 1, 2], "translation": [0, 0, 1]}, there(11.0)],
        ],
    });
    let scene = write_scene(dir.path(), &scene)?;
    for method in ["morph", "bottom-up", "bottom-up-scalar", "brute-force"] {
        let (report, _) = run(&scene, &["--method", method])?;
        assert_eq!(report["pairs"], json!([1, 0, 1, 1]), "{method}");
    }
    Ok(())
}

#[test]
fn every_method_draws_the_same_picture() -> TestResult {
    let dir = tempdir()?;
    let mut pictures = Vec::new();
    for method in ["morph", "brute-force"] {
        let picture = dir.path().join(format!("{method}.png"));
        let path = picture.to_str().ok_or("not UTF-8")?;
        run(
            &asset("scenes/two_dolphins.json"),
            &["--method", method, "--picture", path],
        )?;
        pictures.push(std::fs::read(&picture)?);
    }
    assert!(pictures[0] == pictures[1] && !pictures[0].is_empty());
    Ok(())
}

#[test]
fn an_option_that_the_method_or_the_mode_does_not_know_is_an_error() -> TestResult {
    let scene = asset("scenes/two_dolphins.json");
    for (options, names) in [
        (
            &["--method", "bottom-up", "--volume", "sphere"][..],
            &["--volume", "bottom-up"][..],
        ),
        (&["--arity", "2"], &["--arity", "morph"]),
        (&["--volume", "kdop18"], &["--volume", "morph"]),
        (&["--in-betweens"], &["--in-betweens", "morph"]),
        (&["--method", "paper", "--arity", "2"], &["--arity", "paper"]),
        (
            &["--method", "parry-trimesh", "--arity", "2"],
            &["--arity", "parry-trimesh"],
        ),
        (
            &["--method", "parry-trimesh", "--leaf", "2"],
            &["--leaf", "parry-trimesh"],
        ),
        (
            &["--method", "parry-trimesh", "--witness"],
            &["--witness", "parry-trimesh"],
        ),
        (&["--witness"], &["--witness", "--mode first"]),
        (&["--mode", "contacts", "--method", "hybrid"], &["--method", "contacts"]),
        (&["--mode", "contacts", "--witness"], &["--witness"]),
        (&["--mode", "contacts", "--arity", "2"], &["--arity"]),
        (&["--arity", "3"], &["--arity"]),
        (&["--volume", "cube"], &["cube"]),
        (&["--method", "magic"], &["magic"]),
    ] {
        let message = error(&scene, options)?;
        for name in names {
            assert!(message.contains(name), "{options:?}: {message}");
        }
    }
    for options in [
        &["--method", "hybrid", "--leaf", "3"][..],
        &["--method", "bottom-up-scalar", "--arity", "2", "--leaf", "2"],
        &["--method", "bottom-up", "--leaf", "2"],
        &["--witness", "--mode", "any"],
    ] {
        run(&scene, options)?;
    }
    Ok(())
}

#[test]
fn pairs_of_collapsed_bodies_are_counted() -> TestResult {
    let dir = tempdir()?;
    // Triangles that are all the same point: 400 million pairs, which would take 12 GB.
    let model = json!({
        "asset": {"version": "2.0"},
        "accessors": [{"componentType": 5126, "type": "VEC3", "count": 60_000}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    });
    std::fs::write(dir.path().join("point.gltf"), model.to_string())?;
    let scene = json!({"bodies": [{"model": "point.gltf"}, {"model": "point.gltf"}], "frames": [[{}, {}]]});
    let scene = write_scene(dir.path(), &scene)?;
    let message = error(&scene, &["--method", "bottom-up-scalar", "--memory-limit", "256MiB"])?;
    // 256 MiB have room for 2097152 pairs, and the models take some of it.
    let named = message.contains("frame 0, bodies 0 and 1") && message.contains("pairs of triangles");
    assert!(named && message.contains("--memory-limit"), "{message}");
    Ok(())
}
