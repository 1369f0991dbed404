//! `stress` tries generated, difficult meshes.

use std::error::Error;

use serde_json::Value;

use crate::support::{TestResult, error_of, run_program, stdout_of};

fn stress(flags: &[&str]) -> Result<Value, Box<dyn Error>> {
    let args = [&["stress", "--json"], flags].concat();
    Ok(serde_json::from_str(&stdout_of(&run_program(args)?))?)
}

/// The rows without their times.
fn rows(report: &Value) -> Result<Vec<Value>, Box<dyn Error>> {
    let mut rows = report["families"].as_array().ok_or("no list of families")?.clone();
    for row in &mut rows {
        let slowdown = row.as_object_mut().and_then(|row| row.remove("worst_slowdown"));
        assert!(slowdown.is_some_and(|slowdown| slowdown.is_f64()), "{row}");
    }
    Ok(rows)
}

#[test]
fn every_family_has_a_row_and_nothing_goes_wrong() -> TestResult {
    let report = stress(&["--cases", "4", "--seed", "5"])?;
    assert_eq!(report["seed"], 5);
    let rows = rows(&report)?;
    assert_eq!(rows.len(), 22);
    for row in &rows {
        assert_eq!(row["cases"], 4);
        for count in ["missed", "spurious", "containment_violations", "unexpected", "panics"] {
            assert_eq!(row[count], 0, "{count} in {row}");
        }
        let expected = if row["family"] == "bad-input" { 4 } else { 0 };
        assert_eq!(row["errors_reported"], expected, "{row}");
    }
    Ok(())
}

#[test]
fn the_seed_decides_the_cases() -> TestResult {
    let of_seed = |seed| rows(&stress(&["--cases", "1", "--seed", seed])?);
    assert_eq!(of_seed("1")?, of_seed("1")?);
    assert_ne!(of_seed("1")?, of_seed("2")?);
    Ok(())
}

#[test]
fn the_table_has_a_line_for_every_family() -> TestResult {
    let text = stdout_of(&run_program(["stress", "--cases", "1"])?);
    assert_eq!(text.lines().count(), 25, "{text}");
    assert!(text.contains("not-orthonormal") && text.contains("slowdown"), "{text}");
    error_of(&run_program(["stress", "--cases", "many"])?);
    assert!(text.ends_with(" answers agree with brute force.\n"), "{text}");
    let nothing = run_program(["stress", "--cases", "0"])?;
    assert_eq!(nothing.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&nothing.stdout).ends_with("Nothing was compared; ask for more --cases.\n"));
    Ok(())
}
