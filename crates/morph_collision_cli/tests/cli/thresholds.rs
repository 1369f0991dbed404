//! `--min-depth` and `--gap` of `lint` and `sweep`.

use std::path::Path;

use glam::Vec3;
use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_models::mesh::MorphMesh;
use serde_json::Value;
use tempfile::tempdir;

use crate::lint::{QUICK, findings, lint, model, report};
use crate::support::{TestResult, asset, command, error_of, stdout_of};

#[test]
fn lint_leaves_out_what_is_less_deep() -> TestResult {
    let (_dir, path) = model(1.2)?;
    let found = |more: &[&str]| {
        let report = report(&path, &[QUICK, more].concat())?;
        let depths = findings(&report)
            .into_iter()
            .filter_map(|finding| finding["depth"].as_f64());
        Ok::<_, Box<dyn std::error::Error>>(depths.collect::<Vec<f64>>())
    };
    let all = found(&[])?;
    assert!(all.len() == 1 && (0.19..0.21).contains(&all[0]), "{all:?}");
    assert_eq!(found(&["--min-depth", "0.1"])?, all);
    assert!(found(&["--min-depth", "0.3"])?.is_empty());
    // The largest weight is the one at which it is deep enough.
    let limit = |least: &str| {
        let text = lint(&path, &[QUICK, &["--suggest", "--min-depth", least]].concat())?.stdout;
        Ok::<_, Box<dyn std::error::Error>>(String::from_utf8(text)?)
    };
    assert!(limit("0")?.contains("  down: at most 0.83"));
    assert!(limit("0.1")?.contains("  down: at most 0.91"));
    Ok(())
}

#[test]
fn lint_finds_what_comes_closer_than_a_gap() -> TestResult {
    let (_dir, path) = model(0.9)?;
    assert!(findings(&report(&path, QUICK)?).is_empty());
    assert!(findings(&report(&path, &[QUICK, &["--gap", "0.09"]].concat())?).is_empty());
    let near = report(&path, &[QUICK, &["--gap", "0.11"]].concat())?;
    let found = findings(&near);
    assert_eq!((found.len(), &found[0]["found_with"]), (1, &"target down".into()));
    let depth = found[0]["depth"].as_f64().ok_or("no depth")?;
    assert!((depth + 0.1).abs() < 1e-6, "minus the distance: {depth}");
    // Nothing is new if all is close at rest.
    let wide = report(&path, &[QUICK, &["--gap", "1.5"]].concat())?;
    assert_eq!(
        (findings(&wide).len(), &wide["meshes"][0]["pairs_at_rest"]),
        (0, &3.into())
    );
    let known = path.with_extension("json").display().to_string();
    report(&path, &[QUICK, &["--gap", "0.11", "--write-baseline", &known]].concat())?;
    let accepted = report(&path, &[QUICK, &["--gap", "0.11", "--baseline", &known]].concat())?;
    assert_eq!(
        findings(&accepted)[0]["accepted"],
        true,
        "a negative depth is no deeper than itself"
    );
    Ok(())
}

fn rows(path: &Path, args: &[&str]) -> Result<Vec<Value>, Box<dyn std::error::Error>> {
    let output = command().arg("sweep").arg(path).args(args).arg("--json").output()?;
    let report: Value = serde_json::from_str(&stdout_of(&output))?;
    Ok(report["rows"].as_array().ok_or("no rows")?.clone())
}

#[test]
fn sweep_has_both_for_one_body() -> TestResult {
    let floor = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner * 8.0);
    let wall = [
        Vec3::new(1.0, 1.0, 0.5),
        Vec3::new(1.2, 1.0, 0.5),
        Vec3::new(1.0, 1.1, 2.0),
    ];
    let mut mesh = MorphMesh::rigid("press", [floor, wall].concat(), vec![[0, 1, 2], [3, 4, 5]]);
    mesh.target_names = vec!["down".into()];
    mesh.targets = vec![[[Vec3::ZERO; 3], [-Vec3::Z; 3]].concat()];
    mesh.animations = vec![WeightAnimation {
        name: "press".into(),
        times: vec![0.0, 1.0],
        weights: vec![vec![0.0], vec![1.0]],
        ..WeightAnimation::default()
    }];
    let dir = tempdir()?;
    let path = dir.path().join("press.glb");
    write_glb(&path, &mesh, &Appearance::default())?;
    // Heights of 0.5, 0.25, 0, and -0.25.
    let depths = |args: &[&str]| {
        let rows = rows(&path, &[&["--fps", "4"], args].concat())?;
        let depth = |row: &Value| row["depth"].as_f64().map(|depth| (depth * 100.0).round());
        Ok::<_, Box<dyn std::error::Error>>(rows.iter().filter_map(depth).take(4).collect::<Vec<f64>>())
    };
    assert_eq!(depths(&[])?[..2], [0.0, 25.0]);
    assert_eq!(depths(&["--min-depth", "0.1"])?[0], 25.0);
    assert_eq!(depths(&["--gap", "0.3"])?[..3], [-25.0, 0.0, 25.0]);
    assert_eq!(depths(&["--gap", "0.6"])?, [-50.0, -25.0, 0.0, 25.0]);
    let fails = |gap: &str| {
        let mut run = command();
        let output = run
            .arg("sweep")
            .arg(&path)
            .args(["--fail-on-touch", "--gap", gap, "--ignore-rest"]);
        Ok::<_, Box<dyn std::error::Error>>(output.output()?.status.code())
    };
    assert_eq!(
        (fails("0.1")?, fails("0.7")?),
        (Some(1), Some(0)),
        "all is close at rest"
    );
    Ok(())
}

#[test]
fn sweep_has_both_between_bodies() -> TestResult {
    let scene = asset("scenes/two_dolphins.json");
    let depths = |args: &[&str]| {
        let rows = rows(&scene, &[&["--among", "bodies"], args].concat())?;
        Ok::<_, Box<dyn std::error::Error>>(
            rows.iter()
                .filter_map(|row| row["depth"].as_f64())
                .collect::<Vec<f64>>(),
        )
    };
    let touching = depths(&[])?;
    let near = depths(&["--gap", "0.5"])?;
    let apart: Vec<f64> = near.iter().copied().filter(|depth| *depth < 0.0).collect();
    assert_eq!(near.len(), touching.len() + apart.len());
    assert!(
        !apart.is_empty() && apart.iter().all(|depth| (-0.5..0.0).contains(depth)),
        "{apart:?}"
    );
    let middle = touching.iter().sum::<f64>() / touching.len() as f64;
    let deep = depths(&["--min-depth", &middle.to_string()])?;
    assert_eq!(
        deep,
        touching
            .into_iter()
            .filter(|depth| *depth >= middle)
            .collect::<Vec<f64>>()
    );
    Ok(())
}

/// The sentences said "touches" whatever the threshold.
#[test]
fn the_sentences_name_the_threshold() -> TestResult {
    let (_dir, apart) = model(0.9)?;
    let (_dir, touching) = model(1.2)?;
    for (name, args, part) in [
        ("sweep", &["--min-depth", "100"][..], "Nothing is at least 100 deep"),
        (
            "sweep",
            &["--min-depth", "100", "--ignore-rest"],
            "Nothing that does not touch at rest is at least 100 deep",
        ),
        ("sweep", &["--gap", "4"], "Triangles are at most 4 apart in "),
        (
            "sweep",
            &[
                "--gap",
                "0.001",
                "--ignore-rest",
                "--clip",
                "press",
                "--fps",
                "0.1",
                "--loop",
            ],
            "Nothing that is farther apart at rest is at most 0.001 apart",
        ),
        (
            "lint",
            &["--min-depth", "0.3"],
            "Nothing is at least 0.3 deep that is not so at rest, in ",
        ),
        (
            "lint",
            &["--min-depth", "0.3"],
            "; 0 pairs are at least 0.3 deep at rest",
        ),
    ] {
        let path = if args.contains(&"--gap") { &apart } else { &touching };
        let quick = if name == "lint" { QUICK } else { &[] };
        let output = command().arg(name).arg(path).args(quick).args(args).output()?;
        let text = stdout_of(&output);
        assert!(text.contains(part), "no {part:?} in {text}");
    }
    Ok(())
}

#[test]
fn thresholds_are_lengths() -> TestResult {
    let (_dir, path) = model(1.0)?;
    for command_name in ["lint", "sweep"] {
        for (args, part) in [
            (&["--gap", "-1"][..], "expected a finite number of at least 0"),
            (&["--min-depth", "NaN"], "expected a finite number of at least 0"),
            (&["--min-depth", "1", "--gap", "1"], "cannot be used with"),
        ] {
            let output = command().arg(command_name).arg(&path).args(args).output()?;
            let message = error_of(&output);
            assert!(message.contains(part), "{message}");
        }
    }
    Ok(())
}
