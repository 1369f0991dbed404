//! Rows as Markdown.

use std::fmt::Write;

use super::experiments::Experiment;
use super::measure::{Pass, Row};

/// A table under the experiment's name: the work of a frame on average, and times over the first row's.
pub(crate) fn table(experiment: &Experiment, rows: &[Row]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_table(&mut text, experiment, rows);
    text
}

fn write_table(text: &mut String, experiment: &Experiment, rows: &[Row]) -> std::fmt::Result {
    let Some(base) = rows.first() else { return Ok(()) };
    let frames = experiment.frames.len() as f64;
    let micros = |pass: &Pass| pass.time.as_secs_f64() * 1e6;
    writeln!(
        text,
        "\n**{}.** {} frames, {:.1} pairs of triangles in a frame; time 1 is {:.0} us a frame for all pairs, {:.0} us for first pairs.\n",
        experiment.name,
        experiment.frames.len(),
        base.all.pairs as f64 / frames,
        micros(&base.all),
        micros(&base.first),
    )?;
    writeln!(
        text,
        "| | all: volumes | vertices | node tests | triangle tests | time | first: volumes | vertices | node tests | triangle tests | time |"
    )?;
    writeln!(text, "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|")?;
    for row in rows {
        write!(text, "| {} ", row.label)?;
        for pass in [&row.all, &row.first] {
            let work = pass.work;
            for count in [
                work.volumes_blended,
                work.vertices_blended,
                work.node_tests,
                work.triangle_tests,
            ] {
                write!(text, "| {:.0} ", count as f64 / frames)?;
            }
            write!(text, "| {:.2} ", pass.ratio)?;
        }
        writeln!(text, "|")?;
    }
    Ok(())
}

/// What the numbers were taken on, and how.
pub(crate) fn machine(every: usize, rounds: usize) -> String {
    let cpu = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|info| {
        let line = info.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let cpu = cpu.unwrap_or_else(|| "unknown processor".to_owned());
    format!(
        "{cpu}, {cores} cores, {}-{}, one thread; every {every}th step of 400, medians of {rounds} interleaved rounds.\n",
        std::env::consts::OS,
        std::env::consts::ARCH,
    )
}
