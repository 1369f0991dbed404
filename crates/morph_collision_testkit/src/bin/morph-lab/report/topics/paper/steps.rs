//! Fig. 5: every step of the pass-through.

use std::error::Error;

use morph_collision_testkit::bench::Experiment;
use morph_collision_testkit::report::{Axis, Figure, Panel, Series, Store, Table, ratios, short};
use morph_collision_testkit::rivals::Wanted;
use serde::{Deserialize, Serialize};

use super::methods;
use crate::report::context::Context;
use crate::report::race::race;
use crate::report::record::{ALL, FIRST, Record, scene};

pub(super) const DATA: &str = "paper_steps";

const SCENE: &str = "pass-through-20480";

/// A method's time for a step.
#[derive(Debug, Serialize, Deserialize)]
struct Step {
    wanted: String,
    method: String,
    step: usize,
    microseconds: f64,
}

/// Stores the steps, and returns the rows of all steps together.
pub(super) fn measure(context: &Context) -> Result<Vec<Record>, Box<dyn Error>> {
    let every = if context.quick { 10 } else { 1 };
    let experiment = Experiment::pass_through(5, every);
    let (mut steps, mut records) = (Vec::new(), Vec::new());
    for (wanted, name) in [(Wanted::All, ALL), (Wanted::First, FIRST)] {
        eprintln!("paper: every step, {name}");
        for row in race(&experiment, &methods(), wanted, context.rounds)? {
            let times = experiment.steps.iter().zip(&row.frame_times);
            steps.extend(times.map(|(&step, time)| Step {
                wanted: name.to_owned(),
                method: row.name.clone(),
                step,
                microseconds: short(time * 1e6),
            }));
            records.push(Record::new(
                &experiment,
                name,
                &row,
                context.timed(every, context.rounds),
            ));
        }
    }
    context.store.write(DATA, &steps)?;
    Ok(records)
}

pub(super) fn show(store: &Store, rows: &[Record]) -> Result<String, Box<dyn Error>> {
    let steps: Vec<Step> = store.rows(DATA)?;
    let panels = [(ALL, "all pairs"), (FIRST, "first pair")].map(|(wanted, title)| {
        let of_question: Vec<&Step> = steps.iter().filter(|step| step.wanted == wanted).collect();
        let series = of_question.chunk_by(|a, b| a.method == b.method).map(|steps| Series {
            name: steps[0].method.clone(),
            points: steps.iter().map(|step| (step.step as f64, step.microseconds)).collect(),
            marked: false,
        });
        Panel {
            title: format!("Pass-through, {title}"),
            x: Axis {
                label: "step",
                log: false,
            },
            y: Axis {
                label: "time of a step, us",
                log: true,
            },
            series: series.collect(),
        }
    });
    let figure = Figure {
        name: "steps".to_owned(),
        panels: panels.into(),
    };
    let plot = store.plot(&figure, "Time of every step of the pass-through")?;
    let mut table = Table::new(["all steps together", "all / first"]);
    if let Some(scene) = scene(rows, SCENE) {
        for row in scene.asked(ALL) {
            table.row([
                row.method.clone(),
                ratios([ALL, FIRST].map(|wanted| scene.ratio(&row.method, wanted))),
            ]);
        }
    }
    Ok(format!(
        "{plot}\nTwo bodies of 20480 triangles pass right through each other. Each point is one step's time, the median of all rounds; lower is better.\n\
         Vertical axes are logarithmic.\n\n{table}"
    ))
}
