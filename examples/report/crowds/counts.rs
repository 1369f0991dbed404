//! Instructions of the crowds' frames, counted by valgrind in new processes of this program.

use std::process::Command;

use clap::ValueEnum;
use morph_collision_testkit::report::Table;

use super::physics::Way;
use super::run::{Crowd, With};

/// The instructions of a frame of each crowd around whose queries a frame is timed.
pub(super) fn of_runs() -> Result<String, String> {
    let mut table = Table::new(["", "Bevy alone", "with collisions", "with bounds, too"]);
    for crowd in Crowd::value_variants() {
        let name = named(crowd);
        let mut row = vec![name.clone()];
        for with in With::value_variants() {
            let options = ["--count-run", &name, "--with", &named(with)];
            row.push(millions(count(&options, "counted_update", super::run::COUNTED)?));
        }
        table.row(row);
    }
    Ok(table.to_string())
}

/// The instructions of a frame of each crowd in physics.
pub(super) fn of_physics() -> Result<String, String> {
    let mut table = Table::new([
        "",
        "without surfaces",
        "with surfaces, nobody near",
        "for each surface",
        "a player walks into one",
    ]);
    for (engine, ways) in ["Rapier", "Avian"].into_iter().zip(Way::value_variants().chunks(3)) {
        let mut counts = Vec::new();
        for way in ways {
            counts.push(count(
                &["--count", &named(way)],
                "counted_frames",
                super::physics::COUNTED,
            )?);
        }
        let each = (counts[1] - counts[0]) / super::physics::CHARACTERS as f64;
        table.row([
            engine.to_owned(),
            millions(counts[0]),
            millions(counts[1]),
            millions(each),
            millions(counts[2]),
        ]);
    }
    Ok(table.to_string())
}

fn named(value: &impl ValueEnum) -> String {
    let named = value.to_possible_value();
    named.map(|value| value.get_name().to_owned()).unwrap_or_default()
}

fn millions(count: f64) -> String {
    format!("{:.3}", count / 1e6)
}

/// The instructions of a frame when this program runs with these options, which calls `function` for the frames that are counted.
fn count(options: &[&str], function: &str, frames: usize) -> Result<f64, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let output = Command::new("valgrind")
        // Otherwise, a thread that waits for another one keeps it from running.
        .args(["--fair-sched=yes", "--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(format!("--toggle-collect=*{function}*"))
        .arg(program)
        .arg("crowds")
        .args(options)
        .output()
        .map_err(|error| format!("valgrind, which counts instructions: {error}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let collected = text.lines().find_map(|line| line.split_once("Collected : "));
    let count = collected.and_then(|(_, count)| count.trim().parse::<f64>().ok());
    match count {
        Some(count) if output.status.success() && count > 0.0 => Ok(count / frames as f64),
        _ => Err(format!("valgrind did not count `{}`: {text}", options.join(" "))),
    }
}
