//! Rows as Markdown.

use std::fmt::Write;

use morph_collision_testkit::bench::{self, Experiment, Row};

/// A table under the experiment's name: the work of a frame on average, and times over the first row's. `all` and `first` are the
/// same contenders' rows in both modes.
pub(crate) fn table(experiment: &Experiment, all: &[Row], first: &[Row]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_table(&mut text, experiment, all, first);
    text
}

fn write_table(text: &mut String, experiment: &Experiment, all: &[Row], first: &[Row]) -> std::fmt::Result {
    let (Some(base), Some(base_first)) = (all.first(), first.first()) else {
        return Ok(());
    };
    let frames = experiment.frames.len() as f64;
    writeln!(
        text,
        "\n**{}.** {} frames, {:.1} pairs of triangles in a frame; time 1 is {:.0} us a frame for all pairs, {:.0} us for first pairs.\n",
        experiment.title,
        experiment.frames.len(),
        base.pairs() as f64 / frames,
        base.time * 1e6,
        base_first.time * 1e6,
    )?;
    writeln!(
        text,
        "| | all: volumes | vertices | node tests | triangle tests | time | first: volumes | vertices | node tests | triangle tests | time |"
    )?;
    writeln!(text, "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|")?;
    for (all, first) in all.iter().zip(first) {
        write!(text, "| {} ", all.name)?;
        for row in [all, first] {
            let work = row.work;
            for count in [
                work.nodes_blended,
                work.vertices_blended,
                work.node_tests,
                work.triangle_tests,
            ] {
                write!(text, "| {:.0} ", count as f64 / frames)?;
            }
            write!(text, "| {:.2} ", row.ratio)?;
        }
        writeln!(text, "|")?;
    }
    Ok(())
}

/// What the numbers were taken on, and how.
pub(crate) fn machine(every: usize, rounds: usize) -> String {
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    format!(
        "{}, {cores} cores, {}-{}, one thread; every {every}th step of 400, medians of {rounds} interleaved rounds.\n",
        bench::cpu(),
        std::env::consts::OS,
        std::env::consts::ARCH,
    )
}
