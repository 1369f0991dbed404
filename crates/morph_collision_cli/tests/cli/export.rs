//! `export` writes posed meshes that other programs read.

use std::error::Error;
use std::path::Path;

use morph_collision_testkit::gltf_read::read_meshes;
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
