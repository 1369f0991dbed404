//! The paper's figures and numbers again: Fig. 5, Fig. 8 and Sect. 5.

use std::error::Error;
use std::fmt::Write;

use morph_collision::BuildOptions;
use morph_collision_testkit::bench::{Experiment, Plan, Row, measure};
use morph_collision_testkit::rivals::{MethodKind, MorphTuning, Wanted};

use super::{Context, race};
use crate::plot::{Axis, Figure, Panel, Series, exponent};
use crate::sweeps::{Candidate, morph};

const MODES: [(Wanted, &str); 2] = [(Wanted::All, "all pairs"), (Wanted::First, "first pair")];

fn hybrid(label: &str, arity: usize) -> Candidate {
    Candidate {
        label: label.to_owned(),
        method: MethodKind::Hybrid,
        options: BuildOptions::default().with_arity(arity).with_leaf_size(4),
        tuning: MorphTuning::default(),
    }
}

fn methods() -> Vec<Candidate> {
    vec![
        morph("morph", BuildOptions::default()),
        morph("morph, the paper's tree", BuildOptions::paper()),
        hybrid("hybrid", 8),
        hybrid("hybrid, binary", 2),
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

/// What the paper reports beside its figures, next to what comes out here.
pub(crate) fn claims(context: &Context, _: &str) -> Result<String, Box<dyn Error>> {
    let mut text =
        "\n| | the paper | here, the paper's tree | here, the default tree |\n|---|--:|--:|--:|\n".to_owned();
    let trees = [BuildOptions::paper(), BuildOptions::default()];
    // The more general method over ours, at the resolutions of Fig. 8.
    for ((wanted, mode), theirs) in MODES.into_iter().zip(["1.5 to 9", "2 to 58"]) {
        write!(text, "| dolphins, {mode}: hybrid's time over morph's | {theirs} |")?;
        for tree in &trees {
            let mut ratios = Vec::new();
            for level in 0..4 {
                let experiment = Experiment::dolphins(level, context.every);
                eprintln!("claims: {}, {mode}", experiment.title);
                let candidates = [morph("morph", tree.clone()), hybrid("hybrid", 8), hybrid("binary", 2)];
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
    for (experiment, theirs) in [
        (Experiment::pass_through(5, context.every), "15 %"),
        (Experiment::dolphins(3, context.every), "10 %"),
    ] {
        eprintln!("claims: stamps, {}", experiment.title);
        write!(text, "| {}, all pairs: saved by stamps | {theirs} |", experiment.title)?;
        for tree in &trees {
            write!(text, " {} |", stamps(context, &experiment, tree)?)?;
        }
        writeln!(text)?;
    }
    let experiment = Experiment::pass_through(5, context.every);
    eprintln!("claims: in-betweens");
    let mut gains = Vec::new();
    for tree in &trees {
        let candidates = [
            morph("with", tree.clone().with_in_betweens(true)),
            morph("without", tree.clone()),
        ];
        let rows = race(&experiment, &candidates, Wanted::All, context.rounds)?;
        let steps = rows[0].frame_times.iter().zip(&rows[1].frame_times);
        let best = steps.map(|(with, without)| without / with).fold(0.0, f64::max);
        gains.push((rows[1].ratio, best));
    }
    let percent = |ratio: f64| format!("{:+.0} %", 100.0 * (ratio - 1.0));
    let row = |what: &str, theirs: &str, of: fn(&(f64, f64)) -> f64| {
        let ours: Vec<String> = gains.iter().map(|gain| percent(of(gain))).collect();
        format!(
            "| {}, all pairs: {what} | {theirs} | {} |\n",
            experiment.title,
            ours.join(" | ")
        )
    };
    text += &row("faster with in-betweens", "+5 %", |gain| gain.0);
    text += &row("the same in the step that gains most", "up to +40 %", |gain| gain.1);
    Ok(text
        + "\nMeasured anew, times as ratios within rounds: the paper's processor ran at 1333 MHz and its hybrid was another program, so only ratios can be \
           compared. *Stamps* keep a node from being refitted again in a frame. The library has no switch to turn them off, so their row is not a measurement \
           of it: without stamps every tested node would be refitted, so that the counts with and without are those of volumes blended and of node \
           tests; the time is estimated from them at the price of a volume, which two neighbours give that blend volumes and no vertices.\n")
}

/// How many refits stamps save, and about how much time.
fn stamps(context: &Context, experiment: &Experiment, tree: &BuildOptions) -> Result<String, Box<dyn Error>> {
    let candidate = morph("morph", tree.clone());
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
    let price = refit * neighbours.frames.len() as f64 / prices[0].work.volumes_blended.max(1) as f64;
    let saved = row.work.node_tests.saturating_sub(row.work.volumes_blended) as f64;
    let time = row.time * experiment.frames.len() as f64;
    Ok(format!(
        "{:.1} times fewer refits, about {:.0} % of time",
        row.work.node_tests as f64 / row.work.volumes_blended.max(1) as f64,
        100.0 * saved * price / (time + saved * price),
    ))
}
