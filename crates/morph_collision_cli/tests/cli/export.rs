//! `export` writes posed meshes that other programs read.

use std::error::Error;
use std::path::Path;

use morph_collision_models::gltf::read::read_meshes;
use serde_json::Value;
use tempfile::tempdir;

use crate::support::{TestResult, asset, command, error_of, stdout_of};

fn export(input: &Path, output: &Path, args: &[&str]) -> Result<Value, Box<dyn Error>> {
    let run = command()
        .arg("export")
        .arg(input)
        .arg("--output")
        .arg(output)
        .args(args)
        .arg("--json")
        .output()?;
    Ok(serde_json::from_str(&stdout_of(&run))?)
}

#[test]
fn a_posed_mesh_is_read_back_where_it_was() -> TestResult {
    let dir = tempdir()?;
    let (model, out) = (asset("dolphin_564.glb"), dir.path().join("posed.glb"));
    let report = export(&model, &out, &["--weights", "tail_up=0.75"])?;
    let source = read_meshes(&model)?.remove(0);
    let posed = source.posed(&[0.0, 0.75]);
    let written = read_meshes(&out)?.remove(0);
    assert_eq!(report["triangles"], 564);
    assert_eq!(
        written.primitives.len(),
        2,
        "touching triangles have a material of their own"
    );
    assert_eq!(report["touching_triangles"], written.primitives[1].len());
    assert!(!written.primitives[1].is_empty());
    let corners = |positions: &[glam::Vec3], triangles: &[[u32; 3]]| {
        let mut corners: Vec<_> = triangles
            .iter()
            .map(|triangle| triangle.map(|vertex| positions[vertex as usize].to_array().map(f32::to_bits)))
            .collect();
        corners.sort_unstable();
        corners
    };
    assert_eq!(
        corners(&written.positions, &written.triangles),
        corners(&posed, &source.triangles)
    );
    Ok(())
}

#[test]
fn all_formats_hold_the_same_triangles_of_a_scene() -> TestResult {
    let dir = tempdir()?;
    let scene = asset("scenes/two_dolphins.json");
    let frame = ["--frame", "12"];
    let glb = export(&scene, &dir.path().join("a.glb"), &frame)?;
    assert_eq!(
        (&glb["triangles"], &glb["bodies"][1]),
        (&1128.into(), &"dolphin_564".into())
    );
    for (name, face) in [("a.ply", "3 "), ("a.obj", "f ")] {
        let out = dir.path().join(name);
        let report = export(&scene, &out, &frame)?;
        assert_eq!(report["touching_triangles"], glb["touching_triangles"]);
        let text = std::fs::read_to_string(&out)?;
        let faces = text
            .lines()
            .filter(|line| line.starts_with(face) && line.split(' ').count() == 4);
        assert_eq!(faces.count(), 1128, "{name}");
    }
    let csv = dir.path().join("a.csv");
    let report = export(&scene, &csv, &frame)?;
    let text = std::fs::read_to_string(&csv)?;
    assert_eq!(report["touching_pairs"], text.lines().count() - 1);
    assert!(text.starts_with("body_a,triangle_a,targets_a,body_b,"), "{text}");
    let row: Vec<&str> = text.lines().nth(1).unwrap_or_default().split(',').collect();
    assert!(row[0] == "dolphin_564" && row[6].parse::<f64>().is_ok(), "{row:?}");
    Ok(())
}

/// They were written after all others.
#[test]
fn triangles_that_touch_keep_their_numbers() -> TestResult {
    let dir = tempdir()?;
    let model = asset("dolphin_564.glb");
    let bent = ["--weights", "tail_up=0.75"];
    let query = command()
        .arg("query")
        .arg(&model)
        .args(bent)
        .args(["--self", "--json"])
        .output()?;
    let query: Value = serde_json::from_str(&stdout_of(&query))?;
    let mut expected = vec![false; 564];
    for pair in query["pairs"].as_array().ok_or("no pairs")? {
        for triangle in pair.as_array().ok_or("no pair")? {
            expected[triangle.as_u64().ok_or("no number")? as usize] = true;
        }
    }
    assert!(expected.contains(&true) && !expected.iter().rev().take(20).all(|is| *is));
    let source = read_meshes(&model)?.remove(0);
    let posed = source.posed(&[0.0, 0.75]);
    for (name, vertex, face, first) in [("a.ply", "", "3 ", 0), ("a.obj", "v ", "f ", 1)] {
        let out = dir.path().join(name);
        export(&model, &out, &bent)?;
        let text = std::fs::read_to_string(&out)?;
        let of = |start: &str, count: usize| {
            let lines = text.lines().filter_map(|line| line.strip_prefix(start));
            let numbers = lines.map(|line| line.split(' ').filter_map(|number| number.parse().ok()).collect());
            numbers
                .filter(|numbers: &Vec<f32>| numbers.len() == count)
                .collect::<Vec<_>>()
        };
        let (vertices, faces) = (of(vertex, 6), of(face, 3));
        assert_eq!(faces.len(), 564, "{name}");
        for (triangle, face) in faces.iter().enumerate() {
            for (corner, &source) in face.iter().zip(&source.triangles[triangle]) {
                let found = &vertices[*corner as usize - first];
                let at = glam::Vec3::from_slice(found);
                assert!(at.distance(posed[source as usize]) < 1e-6, "{name} {triangle}");
                assert_eq!(
                    found[3] > found[5],
                    expected[triangle],
                    "red is the colour of what touches: {name} {triangle}"
                );
            }
        }
    }
    Ok(())
}

#[test]
fn a_file_on_stdout_is_alone_there() -> TestResult {
    let output = command()
        .args(["export", "--output", "-", "--format", "obj"])
        .arg(asset("dolphin_564.glb"))
        .output()?;
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout)?;
    assert!(
        text.starts_with("# morph-collide") && text.lines().all(|line| "#ovf".contains(&line[..1])),
        "{text}"
    );
    assert!(String::from_utf8_lossy(&output.stderr).contains("564 triangles"));
    Ok(())
}

#[test]
fn what_does_not_fit_is_refused() -> TestResult {
    let dir = tempdir()?;
    let (model, scene) = (asset("dolphin_564.glb"), asset("scenes/two_dolphins.json"));
    let out = dir.path().join("a.ply").display().to_string();
    for (input, args, parts) in [
        (
            &model,
            &["--output", "a.xyz"][..],
            &["--output", "a.xyz", "--format"][..],
        ),
        (&model, &["--output", &out, "--frame", "1"], &["--frame"]),
        (&scene, &["--output", &out, "--frame", "40"], &["--frame", "0 to 39"]),
        (&scene, &["--output", &out, "--weights", "1,2"], &["--weights", "scene"]),
        (&model, &["--output", &out, "--clip", "walk"], &["--clip", "\"swim\""]),
        (&model, &[], &["--output"]),
    ] {
        let message = error_of(&command().arg("export").arg(input).args(args).output()?);
        for part in parts {
            assert!(message.contains(part), "{args:?}: no {part:?} in {message}");
        }
    }
    Ok(())
}
