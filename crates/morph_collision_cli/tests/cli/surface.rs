//! `run` describes contacts and distances.

use std::error::Error;

use serde_json::Value;
use tempfile::tempdir;

use crate::support::{TestResult, asset, command, error_of, stdout_of};

fn run(args: &[&str]) -> Result<Value, Box<dyn Error>> {
    let output = command()
        .args(["run", "--json"])
        .arg(asset("scenes/two_dolphins.json"))
        .args(args)
        .output()?;
    Ok(serde_json::from_str(&stdout_of(&output))?)
}

#[test]
fn contacts_and_distances_agree_with_the_pairs() -> TestResult {
    let pairs = run(&[])?;
    let contacts = run(&["--mode", "contacts"])?;
    let distances = run(&["--mode", "distance"])?;
    let mut of_frame = vec![0; 40];
    for contact in contacts["contacts"].as_array().ok_or("no contacts")? {
        of_frame[contact["frame"].as_u64().ok_or("no frame")? as usize] =
            contact["pairs"].as_u64().ok_or("no pairs")?;
        assert!(contact["depth"].as_f64() >= Some(0.0));
        let points = contact["points"].as_array().ok_or("no points")?;
        assert!((1..=4).contains(&points.len()), "{contact}");
    }
    assert_eq!(pairs["pairs"], serde_json::json!(of_frame));
    let distances = distances["distances"].as_array().ok_or("no distances")?;
    assert_eq!(distances.len(), 40);
    for (row, pairs) in distances.iter().zip(of_frame) {
        assert_eq!(row["distance"].as_f64() == Some(0.0), pairs > 0, "{row}");
    }
    Ok(())
}

#[test]
fn they_are_written_as_tables() -> TestResult {
    let dir = tempdir()?;
    for (mode, header) in [
        ("contacts", "frame,body_a,body_b,pairs,depth,normal_x,"),
        ("distance", "frame,body_a,body_b,distance,ax,"),
    ] {
        let csv = dir.path().join("rows.csv");
        run(&["--mode", mode, "--pairs", &csv.display().to_string()])?;
        let text = std::fs::read_to_string(&csv)?;
        let columns = |line: &str| line.split(',').count();
        assert!(text.starts_with(header), "{text}");
        let expected = columns(text.lines().next().unwrap_or_default());
        assert!(
            text.lines().count() > 10 && text.lines().all(|line| columns(line) == expected),
            "{text}"
        );
    }
    let text = command()
        .args(["run", "--mode", "distance"])
        .arg(asset("scenes/two_dolphins.json"))
        .output()?;
    assert!(stdout_of(&text).contains("are closest in frame "));
    Ok(())
}

#[test]
fn options_that_do_not_fit_are_refused() -> TestResult {
    let scene = asset("scenes/two_dolphins.json");
    for (args, flag) in [
        (&["--mode", "contacts", "--picture", "a.png"][..], "--picture"),
        (&["--mode", "distance", "--picture", "a.png"], "--picture"),
    ] {
        let message = error_of(&command().arg("run").arg(&scene).args(args).output()?);
        assert!(message.contains(flag), "{args:?}: {message}");
    }
    Ok(())
}
