//! `query` answers about one mesh in one shape.

use std::error::Error;
use std::path::Path;

use serde_json::Value;
use tempfile::tempdir;

use crate::support::{RawMesh, TestResult, asset, error_of, run_program, stdout_of, write_gltf};

fn query(model: &Path, flags: &[&str]) -> Result<std::process::Output, Box<dyn Error>> {
    let mut args = vec!["query".as_ref(), model.as_os_str()];
    args.extend(flags.iter().map(AsRef::<std::ffi::OsStr>::as_ref));
    run_program(args)
}

fn json(model: &Path, flags: &[&str]) -> Result<Value, Box<dyn Error>> {
    let flags = [flags, &["--json"]].concat();
    Ok(serde_json::from_str(&stdout_of(&query(model, &flags)?))?)
}

#[test]
fn a_ray_hits_the_shape_that_the_weights_make() -> TestResult {
    let dir = tempdir()?;
    let path = write_gltf(dir.path(), "triangle.gltf", &[RawMesh::triangle("Triangle")])?;
    for (weight, t, facing) in [("0.5", 1.5, "front"), ("-1", 3.0, "front")] {
        let answer = json(&path, &["--weights", weight, "--ray", "0.25,0.25,2,0,0,-1"])?;
        let hit = &answer["hits"][0];
        assert_eq!(hit["triangle"], 0);
        assert_eq!(hit["t"].as_f64(), Some(t));
        assert_eq!(hit["facing"], facing);
        assert_eq!(hit["point"][0].as_f64(), Some(0.25));
        assert!(answer["work"]["triangle_tests"].as_u64() > Some(0));
    }
    let text = stdout_of(&query(&path, &["--ray", "0.25,0.25,-2,0,0,1"])?);
    assert!(text.contains("1 hits") && text.contains("back"), "{text}");
    assert_eq!(
        json(&path, &["--ray", "9,9,2,0,0,-1"])?["hits"]
            .as_array()
            .map(Vec::len),
        Some(0)
    );
    Ok(())
}

#[test]
fn hits_are_listed_along_the_ray() -> TestResult {
    let answer = json(
        &asset("dolphin_564.glb"),
        &["--ray=0.1,3,0.01,0,-1,0", "--weights=0.3,0"],
    )?;
    let hits = answer["hits"].as_array().ok_or("no list of hits")?;
    let ts: Vec<_> = hits.iter().filter_map(|hit| hit["t"].as_f64()).collect();
    assert!(ts.len() >= 2 && ts.is_sorted(), "{ts:?}");
    Ok(())
}

#[test]
fn a_point_is_projected() -> TestResult {
    let dir = tempdir()?;
    let triangle = RawMesh::triangle("Triangle");
    let path = write_gltf(dir.path(), "two.gltf", &[triangle.clone(), triangle])?;
    let answer = json(&path, &["--mesh", "1", "--weights", "1", "--point", "-2,0,1"])?;
    assert_eq!(answer["closest"]["distance"].as_f64(), Some(2.0));
    assert_eq!(answer["closest"]["triangle"], 0);
    let text = stdout_of(&query(&path, &["--point", "-2,0,0"])?);
    assert!(text.contains("distance 2.000000"), "{text}");
    Ok(())
}

#[test]
fn bad_input_names_the_flag() -> TestResult {
    let dir = tempdir()?;
    let path = write_gltf(dir.path(), "triangle.gltf", &[RawMesh::triangle("Triangle")])?;
    let point = "--point=0,0,0";
    for (flags, names) in [
        (&["--ray", "1,2,3"][..], &["--ray", "expected 6 numbers, found 3"][..]),
        (&["--ray", "0,0,0,0,0,0"], &["--ray", "direction"]),
        (&["--ray", "0,0,NaN,0,0,1"], &["--ray", "origin"]),
        (&["--point", "1,x,3"], &["--point", "number 1", "x"]),
        (&["--point", "1,1e60,3"], &["--point", "coordinate 1"]),
        (&[point, "--weights", "1,2"], &["--weights", "2 weights", "1 targets"]),
        (&[point, "--weights", "1;2"], &["--weights", "1;2"]),
        (&[point, "--weights", "inf"], &["--weights", "inf"]),
        (&[point, "--mesh", "1"], &["--mesh", "triangle.gltf"]),
        (&[point, "--mesh", "-1"], &["-1"]),
        (&[], &["--ray", "--point"]),
        (&[point, "--ray", "0,0,0,1,0,0"], &["--point", "--ray"]),
    ] {
        let message = error_of(&query(&path, flags)?);
        for name in names {
            assert!(message.contains(name), "no {name:?} in: {message}");
        }
    }
    let message = error_of(&query(&dir.path().join("absent.glb"), &[point])?);
    assert!(message.contains("absent.glb"), "{message}");
    Ok(())
}

#[test]
fn a_dolphin_intersects_itself_where_its_fins_stick_in_its_body() -> TestResult {
    let answer = json(&asset("dolphin_564.glb"), &["--self", "--weights", "0.3,0"])?;
    let pairs = answer["pairs"].as_array().ok_or("no list of pairs")?;
    assert!(!pairs.is_empty());
    assert!(pairs.iter().all(|pair| pair[0].as_u64() < pair[1].as_u64()));
    let dir = tempdir()?;
    let path = write_gltf(dir.path(), "triangle.gltf", &[RawMesh::triangle("Triangle")])?;
    let text = stdout_of(&query(&path, &["--self"])?);
    assert!(
        text.starts_with("mesh 0 \"Triangle\", all 1 weights 0\n0 pairs"),
        "{text}"
    );
    Ok(())
}
