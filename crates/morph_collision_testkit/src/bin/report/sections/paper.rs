//! Reproduces the paper's figures and numbers: Fig. 5, Fig. 8 and Sect. 5.

use std::error::Error;
use std::fmt::Write;

use morph_collision_testkit::bench::{Experiment, Plan, Row, measure};
use morph_collision_testkit::rivals::{MethodKind, MethodOptions, PaperOptions, Wanted};

use super::{Context, race};
use crate::sweeps::{Candidate, morph, rival};
use morph_collision_testkit::plot::{Axis, Figure, Panel, Series, exponent};

const MODES: [(Wanted, &str); 2] = [(Wanted::All, "all pairs"), (Wanted::First, "first pair")];

fn binary() -> Candidate {
    let mut binary = rival("hybrid, binary", MethodKind::Hybrid);
    binary.options.arity = 2;
    binary
}

fn ours() -> Candidate {
    morph("morph", MethodOptions::default())
}

fn theirs(options: PaperOptions) -> Candidate {
    rival("paper", MethodKind::Paper(options))
}

fn methods() -> Vec<Candidate> {
    vec![
        ours(),
        theirs(PaperOptions::BOXES),
        rival("hybrid", MethodKind::Hybrid),
        binary(),
    ]
}

/// Fig. 5: every step of the pass-through.
pub(crate) fn steps(context: &Context, _: &str) -> Result<String, Box<dyn Error>> {
    let experiment = Experiment::pass_through(5, if context.quick { 10 } else { 1 });
    let mut panels = Vec::new();
    for (wanted, mode) in MODES {
        eprintln!("steps: {}, {mode}", experiment.title);
        let rows = race(&experiment, &methods(), wanted, context.rounds)?;
        let series = rows.iter().map(|row| Series {
            name: row.name.clone(),
            points: experiment
                .steps
                .iter()
                .zip(&row.frame_times)
                .map(|(&step, time)| (step as f64, time * 1e6))
                .collect(),
            marked: false,
        });
        panels.push(Panel {
            title: format!("Pass-through, {mode}"),
            x: Axis {
                label: "step",
                log: false,
            },
            y: Axis {
                label: "time of a step, us",
                log: true,
            },
            series: series.collect(),
        });
    }
    let figure = Figure {
        name: "steps".to_owned(),
        panels,
    };
    let shown = figure.write(&context.plots, "Time of every step of the pass-through")?;
    Ok(format!(
        "\n{shown}\nThe paper's Fig. 5: two bodies of 20480 triangles pass right through each other. Each point is one step's time, the median of {} \
         rounds; lower is better. Vertical axes are logarithmic. The bodies touch from step 41 to step 364.\n",
        context.rounds
    ))
}

/// Fig. 8: dolphins of growing resolution.
pub(crate) fn resolution(context: &Context, _: &str) -> Result<String, Box<dyn Error>> {
    let dolphins = [0, 1, 2, 3].map(|level| Experiment::dolphins(level, context.every));
    let mut text = String::new();
    let mut panels = Vec::new();
    for (wanted, mode) in MODES {
        let mut rows = Vec::new();
        for experiment in &dolphins {
            eprintln!("resolution: {}, {mode}", experiment.title);
            rows.push(race(experiment, &methods(), wanted, context.rounds)?);
        }
        write!(text, "\n| {mode}, us a frame |")?;
        for experiment in &dolphins {
            write!(text, " {} |", experiment.mesh.triangles.len())?;
        }
        writeln!(text, " grows with the power |\n|---|--:|--:|--:|--:|--:|")?;
        let mut series = Vec::new();
        for contender in 0..rows[0].len() {
            let of_size = |(experiment, rows): (&Experiment, &Vec<Row>)| {
                (experiment.mesh.triangles.len() as f64, rows[contender].time * 1e6)
            };
            let points: Vec<(f64, f64)> = dolphins.iter().zip(&rows).map(of_size).collect();
            let name = rows[0][contender].name.clone();
            write!(text, "| {name} |")?;
            for (experiment_rows, (_, time)) in rows.iter().zip(&points) {
                write!(text, " {time:.0} ({:.2}) |", experiment_rows[contender].ratio)?;
            }
            writeln!(text, " {:.2} |", exponent(&points))?;
            series.push(Series {
                name: format!("{name}: {:.2}", exponent(&points)),
                points,
                marked: true,
            });
        }
        panels.push(Panel {
            title: format!("Twelve dolphins, {mode}"),
            x: Axis {
                label: "triangles of a dolphin",
                log: true,
            },
            y: Axis {
                label: "time of a frame, us",
                log: true,
            },
            series,
        });
    }
    let figure = Figure {
        name: "resolution".to_owned(),
        panels,
    };
    let shown = figure.write(&context.plots, "Time against the number of triangles, twelve dolphins")?;
    Ok(format!(
        "\n{shown}\nThe paper's Fig. 8: twelve dolphins of the same shape at four resolutions. Both axes are logarithmic, so that a line's slope is the \
         power with which time grows (behind the names, fitted by least squares); 1 is linear. In the tables, times in microseconds and their ratio to \
         morph's.\n{text}"
    ))
}

/// The further numbers that the paper reports, next to ours.
pub(crate) fn claims(context: &Context, _: &str) -> Result<String, Box<dyn Error>> {
    let mut text = "\n| | the paper | here, the method `paper` | here, `morph` |\n|---|--:|--:|--:|\n".to_owned();
    let methods = || [theirs(PaperOptions::BOXES), ours()];
    // The time of the more general method over that of the one for morphing, at the resolutions of
    // Fig. 8.
    for ((wanted, mode), reported) in MODES.into_iter().zip(["1.5 to 9", "2 to 58"]) {
        write!(text, "| dolphins, {mode}: hybrid's time over it | {reported} |")?;
        for method in 0..2 {
            let mut ratios = Vec::new();
            for level in 0..4 {
                let experiment = Experiment::dolphins(level, context.every);
                eprintln!("claims: {}, {mode}", experiment.title);
                let [theirs, ours] = methods();
                let first = if method == 0 { theirs } else { ours };
                let candidates = [first, rival("hybrid", MethodKind::Hybrid), binary()];
                let rows = race(&experiment, &candidates, wanted, context.rounds)?;
                ratios.push([rows[1].ratio, rows[2].ratio]);
            }
            let range = |form: usize| {
                let of_form = ratios.iter().map(|pair| pair[form]);
                let (least, most) = (
                    of_form.clone().fold(f64::INFINITY, f64::min),
                    of_form.fold(0.0, f64::max),
                );
                format!("{least:.2} to {most:.2}")
            };
            write!(text, " {} (binary: {}) |", range(0), range(1))?;
        }
        writeln!(text)?;
    }
    for (experiment, reported) in [
        (Experiment::pass_through(5, context.every), "15 %"),
        (Experiment::dolphins(3, context.every), "10 %"),
    ] {
        eprintln!("claims: stamps, {}", experiment.title);
        write!(
            text,
            "| {}, all pairs: saved by stamps | {reported} |",
            experiment.title
        )?;
        for method in methods() {
            write!(text, " {} |", stamps(context, &experiment, method)?)?;
        }
        writeln!(text)?;
    }
    let experiment = Experiment::pass_through(5, context.every);
    eprintln!("claims: in-betweens");
    let with = theirs(PaperOptions {
        in_betweens: true,
        ..PaperOptions::BOXES
    });
    let rows = race(
        &experiment,
        &[with, theirs(PaperOptions::BOXES)],
        Wanted::All,
        context.rounds,
    )?;
    let steps = rows[0].frame_times.iter().zip(&rows[1].frame_times);
    let best = steps.map(|(with, without)| without / with).fold(0.0, f64::max);
    let percent = |ratio: f64| format!("{:+.0} %", 100.0 * (ratio - 1.0));
    for (what, reported, ratio) in [
        ("faster with in-betweens", "+5 %", rows[1].ratio),
        ("the same in the step that gains most", "up to +40 %", best),
    ] {
        let (title, ratio) = (&experiment.title, percent(ratio));
        writeln!(text, "| {title}, all pairs: {what} | {reported} | {ratio} | |")?;
    }
    Ok(text
        + "\nMeasured anew, times as ratios within rounds: the paper's processor ran at 1333 MHz and its hybrid was another program, so only ratios can be \
           compared. *Stamps* keep a node from being refitted again in a frame. Neither method has a switch to turn them off, so their row is not a measurement \
           of it: without stamps every tested node would be refitted, so that the counts with and without are those of volumes blended and of node \
           tests; the time is estimated from them at the price of a volume, which two neighbours give that blend volumes and no vertices.\n")
}

/// How many refits, and about how much time, the stamps save.
fn stamps(context: &Context, experiment: &Experiment, candidate: Candidate) -> Result<String, Box<dyn Error>> {
    let row = race(
        experiment,
        std::slice::from_ref(&candidate),
        Wanted::All,
        context.rounds,
    )?
    .remove(0);
    let mut neighbours = Experiment::neighbours(2);
    neighbours.frames.truncate(100);
    let plan = Plan {
        wanted: Wanted::All,
        rounds: context.rounds,
        split_rounds: context.rounds,
    };
    let prices = measure(&neighbours, vec![candidate.set_up(&neighbours)?], plan, || ())?;
    let refit = prices[0].parts.map_or(0.0, |parts| parts.refit);
    let price = refit * neighbours.frames.len() as f64 / prices[0].work.nodes_blended.max(1) as f64;
    let saved = row.work.node_tests.saturating_sub(row.work.nodes_blended) as f64;
    let time = row.time * experiment.frames.len() as f64;
    Ok(format!(
        "{:.1} times fewer refits, about {:.0} % of time",
        row.work.node_tests as f64 / row.work.nodes_blended.max(1) as f64,
        100.0 * saved * price / (time + saved * price),
    ))
}
