//! Renders rows as Markdown.

use std::fmt::Write;

use morph_collision_testkit::bench::{self, Experiment, Row};

/// A table with the experiment's name: the average work per frame, and times relative to the first row's. `all` and `first` are
/// rows of the same contenders in the two modes.
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

/// A table of the same methods in several scenes with rays, side by side.
pub(crate) fn ray_table(scenes: &[(Experiment, Vec<Row>)]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_ray_table(&mut text, scenes);
    text
}

fn write_ray_table(text: &mut String, scenes: &[(Experiment, Vec<Row>)]) -> std::fmt::Result {
    let Some((experiment, rows)) = scenes.first() else {
        return Ok(());
    };
    write!(text, "\n**{}.** {} frames", experiment.title, experiment.frames.len())?;
    for (experiment, rows) in scenes {
        let rays: usize = experiment.rays.iter().map(Vec::len).sum();
        if let Some(base) = rows.first() {
            let (per_frame, time) = (rays / experiment.frames.len().max(1), base.time * 1e6);
            let hits = 100.0 * base.pairs() as f64 / rays as f64;
            write!(
                text,
                "; with {per_frame} of them in a frame, of which {hits:.0} % hit, time 1 is {time:.1} us a frame"
            )?;
        }
    }
    write!(text, ".\n\n| ")?;
    for (experiment, _) in scenes {
        let rays = experiment.rays.first().map_or(0, Vec::len);
        write!(
            text,
            "| {rays}: volumes | vertices | node tests | triangle tests | time "
        )?;
    }
    writeln!(text, "|\n|---{}|", "|--:".repeat(5 * scenes.len()))?;
    for (index, row) in rows.iter().enumerate() {
        write!(text, "| {} ", row.name)?;
        for (experiment, rows) in scenes {
            let frames = experiment.frames.len() as f64;
            let Some(row) = rows.get(index) else { continue };
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

/// The machine and the way in which the numbers were measured.
pub(crate) fn machine(every: usize, rounds: usize) -> String {
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    format!(
        "{}, {cores} cores, {}-{}, one thread; every {every}th step of 400, medians of {rounds} interleaved rounds.\n",
        bench::cpu(),
        std::env::consts::OS,
        std::env::consts::ARCH,
    )
}
