//! Weights by name, from files and from the model, wherever weights are given.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::support::{RawMesh, TestResult, command, error_of, run_program, stdout_of, write_gltf, write_scene};

/// A triangle with the targets "up" and "right", which move it by 1 along z and x. Its node has the default weights 0.5 and 0.
fn model() -> Result<(TempDir, PathBuf), Box<dyn Error>> {
    let dir = tempdir()?;
    let mut mesh = RawMesh::triangle("Triangle");
    mesh.targets.push(vec![[1.0, 0.0, 0.0]; 3]);
    let path = write_gltf(dir.path(), "named.gltf", &[mesh])?;
    bend(&path, |gltf| {
        gltf["meshes"][0]["extras"] = json!({"targetNames": ["up", "right"]});
        gltf["meshes"][0]["weights"] = json!([9, 9]);
        gltf["nodes"] = json!([{"mesh": 0, "weights": [0.5, 0]}]);
    })?;
    Ok((dir, path))
}

fn bend(path: &Path, bend: impl FnOnce(&mut Value)) -> TestResult {
    let mut gltf = serde_json::from_slice(&std::fs::read(path)?)?;
    bend(&mut gltf);
    Ok(std::fs::write(path, gltf.to_string())?)
}

/// The closest point to the one given, which tells where the triangle is.
fn closest(path: &Path, flags: &[&str]) -> Result<[f64; 3], Box<dyn Error>> {
    let mut args = vec![
        "query".as_ref(),
        path.as_os_str(),
        "--json".as_ref(),
        "--point=0,0,0".as_ref(),
    ];
    args.extend(flags.iter().map(AsRef::<std::ffi::OsStr>::as_ref));
    let report: Value = serde_json::from_str(&stdout_of(&run_program(args)?))?;
    let point = &report["closest"]["point"];
    Ok([0, 1, 2].map(|axis| point[axis].as_f64().unwrap_or(f64::NAN)))
}

#[test]
fn default_weights_hold_until_others_are_given() -> TestResult {
    let (dir, path) = model()?;
    assert_eq!(closest(&path, &[])?, [0.0, 0.0, 0.5]);
    assert_eq!(closest(&path, &["--weights", "right=2"])?, [2.0, 0.0, 0.5]);
    assert_eq!(closest(&path, &["--weights", "right=2,up=0"])?, [2.0, 0.0, 0.0]);
    assert_eq!(closest(&path, &["--weights", "1=2"])?, [2.0, 0.0, 0.5]);
    assert_eq!(closest(&path, &["--weights=0,-0.25"])?, [0.0; 3]);
    // Without a node, those of the mesh count.
    bend(&path, |gltf| gltf["nodes"] = json!([]))?;
    assert_eq!(closest(&path, &[])?, [9.0, 0.0, 9.0]);
    let scene = json!({
        "bodies": [{"model": "named.gltf"}, {"model": "named.gltf"}],
        "frames": [[{}, {"weights": {"right": 9.5}}], [{"weights": [0, 0]}, {}], [{"weights": {"up": 0}}, {"weights": {"up": 0}}]],
    });
    let scene = write_scene(dir.path(), &scene)?;
    let report = run_program(["run".as_ref(), scene.as_os_str(), "--json".as_ref()])?;
    let report: Value = serde_json::from_str(&stdout_of(&report))?;
    assert_eq!(report["pairs"], json!([1, 0, 1]));
    Ok(())
}

#[test]
fn the_weights_that_hold_are_shown() -> TestResult {
    let (_dir, path) = model()?;
    let text = stdout_of(&run_program(["query".as_ref(), path.as_os_str(), "--self".as_ref()])?);
    assert!(
        text.starts_with("mesh 0 \"Triangle\", 1 of 2 weights not 0: up 0.5\n"),
        "{text}"
    );
    let text = stdout_of(&run_program(["inspect".as_ref(), path.as_os_str()])?);
    let row = text.lines().find(|line| line.contains("  up ")).unwrap_or_default();
    let cells: Vec<&str> = row.split_whitespace().collect();
    assert_eq!(cells, ["0", "up", "0.5", "1", "0.0", "%"], "{text}");
    Ok(())
}

#[test]
fn weights_come_from_files_and_from_stdin() -> TestResult {
    let (dir, path) = model()?;
    for (name, content) in [
        ("lines.txt", "# a face\nright=2\nup=0\n"),
        ("table.csv", "target,weight\r\nright,2\r\nup,0\r\n"),
        ("object.json", "{\"right\": 2, \"up\": 0}"),
        ("list.json", "[0, 2]"),
    ] {
        let file = dir.path().join(name);
        std::fs::write(&file, content)?;
        let flag = format!("@{}", file.display());
        assert_eq!(closest(&path, &["--weights", &flag])?, [2.0, 0.0, 0.0], "{name}");
    }
    let mut child = command()
        .args(["query", "--json", "--point=0,0,0", "--weights", "@-"])
        .arg(&path)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    child.stdin.take().ok_or("no stdin")?.write_all(b"right=3")?;
    let report: Value = serde_json::from_slice(&child.wait_with_output()?.stdout)?;
    assert_eq!(report["closest"]["point"][0], 3.0);
    Ok(())
}

#[test]
fn a_typo_gets_the_nearest_names_everywhere() -> TestResult {
    let (dir, path) = model()?;
    let scene = json!({"bodies": [{"model": "named.gltf"}], "frames": [[{}], [{"weights": {"rihgt": 1}}]]});
    let scene = write_scene(dir.path(), &scene)?;
    let out = dir.path().join("out.ply");
    let model = path.as_os_str();
    let commands: [&[&std::ffi::OsStr]; 4] = [
        &[
            "query".as_ref(),
            model,
            "--self".as_ref(),
            "--weights".as_ref(),
            "rihgt=1".as_ref(),
        ],
        &[
            "export".as_ref(),
            model,
            "--output".as_ref(),
            out.as_os_str(),
            "--weights".as_ref(),
            "rihgt=1".as_ref(),
        ],
        &["scene".as_ref(), model, "--weights".as_ref(), "rihgt=1".as_ref()],
        &["run".as_ref(), scene.as_os_str()],
    ];
    for args in commands {
        let message = error_of(&run_program(args)?);
        assert!(
            message.contains("no target \"rihgt\"") && message.contains("did you mean \"right\"?"),
            "{args:?}: {message}"
        );
    }
    for (flag, part) in [
        ("right=x", "expected name=number, found \"right=x\""),
        ("right=1,right=2", "\"right\" is given twice"),
        ("@absent.json", "absent.json"),
    ] {
        let args = [
            "query".as_ref(),
            model,
            "--self".as_ref(),
            "--weights".as_ref(),
            flag.as_ref(),
        ];
        let message = error_of(&run_program(args)?);
        assert!(message.contains("--weights") && message.contains(part), "{message}");
    }
    Ok(())
}

#[test]
fn wrong_default_weights_are_told() -> TestResult {
    let (_dir, path) = model()?;
    bend(&path, |gltf| gltf["nodes"][0]["weights"] = json!([1, 2, 3]))?;
    let message = error_of(&run_program(["query".as_ref(), path.as_os_str(), "--self".as_ref()])?);
    assert!(message.contains("3 default weights for 2 targets"), "{message}");
    let report = run_program(["inspect".as_ref(), path.as_os_str(), "--json".as_ref()])?;
    let report: Value = serde_json::from_str(&stdout_of(&report))?;
    let warning = report["meshes"][0]["warnings"][0].as_str().unwrap_or_default();
    assert!(warning.contains("3 default weights"), "{report}");
    Ok(())
}

#[test]
fn tiny_weights_are_printed_in_a_few_characters() -> TestResult {
    let (_dir, path) = model()?;
    let args = ["--point=0,0,0", "--weights", "up=1e-42,right=0.25"].map(AsRef::<std::ffi::OsStr>::as_ref);
    let report = stdout_of(&run_program(
        ["query".as_ref(), path.as_os_str()].into_iter().chain(args),
    )?);
    assert!(report.contains("up 1e-42, right 0.25"), "{report}");
    Ok(())
}

#[test]
fn weights_to_export_that_do_not_fit_are_blamed_on_the_option() -> TestResult {
    let (dir, path) = model()?;
    let out = dir.path().join("out.ply");
    for (weights, reason) in [("1,2,3", "3 weights"), ("nope=1", "there is no target \"nope\"")] {
        let run = command()
            .arg("export")
            .arg(&path)
            .args(["--weights", weights, "--output"])
            .arg(&out)
            .output()?;
        let error = error_of(&run);
        assert!(error.contains(&format!("error: --weights: {reason}")), "{error}");
        assert!(!out.exists());
    }
    Ok(())
}
