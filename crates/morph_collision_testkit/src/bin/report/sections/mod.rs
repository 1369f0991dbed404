//! The sections of the page and the functions that make them. Those that are more than a sweep have
//! their own files.

mod bytes;
mod faces;
mod kernels;
mod memory;
mod paper;
mod rays;
mod scale;
mod threads;

use std::error::Error;
use std::path::PathBuf;

use morph_collision_testkit::bench::{Experiment, Plan, Row, disagreement, measure};
use morph_collision_testkit::rivals::Wanted;

use super::render;
use super::sweeps::{self, Candidate};

/// The input of every section.
pub(crate) struct Context {
    /// Use every Nth step of an experiment.
    pub(crate) every: usize,
    pub(crate) rounds: usize,
    /// Whether rough numbers are enough.
    pub(crate) quick: bool,
    /// The folder for plots and their data, beside the page.
    pub(crate) plots: PathBuf,
}

/// A section of the page, and a function that makes it from the context and the section's current
/// text.
pub(crate) struct Section {
    pub(crate) name: &'static str,
    pub(crate) make: Make,
}

impl Section {
    /// Whether it measures several cores and therefore must not be pinned to one.
    pub(crate) fn uses_all_cores(&self) -> bool {
        self.name == "threads"
    }
}

type Make = fn(&Context, &str) -> Result<String, Box<dyn Error>>;

/// All sections.
pub(crate) const SECTIONS: &[Section] = &[
    Section {
        name: "leaves",
        make: |context, _| sweep(context, "leaves", &Experiment::tuning(context.every), sweeps::leaves),
    },
    Section {
        name: "memory",
        make: memory::memory,
    },
    Section {
        name: "methods",
        make: |context, _| sweep(context, "methods", &Experiment::tuning(context.every), sweeps::methods),
    },
    Section {
        name: "steps",
        make: paper::steps,
    },
    Section {
        name: "resolution",
        make: paper::resolution,
    },
    Section {
        name: "claims",
        make: paper::claims,
    },
    Section {
        name: "faces",
        make: faces::faces,
    },
    Section {
        name: "rays",
        make: rays::rays,
    },
    Section {
        name: "bytes",
        make: bytes::bytes,
    },
    Section {
        name: "kernels",
        make: kernels::kernels,
    },
    Section {
        name: "threads",
        make: threads::threads,
    },
    Section {
        name: "scale",
        make: scale::scale,
    },
];

/// A table per experiment.
fn sweep(
    context: &Context,
    name: &str,
    experiments: &[Experiment],
    rows: fn(&Experiment) -> Vec<Candidate>,
) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    for experiment in experiments {
        eprintln!("{name}: {}", experiment.title);
        let candidates = rows(experiment);
        let all = race(experiment, &candidates, Wanted::All, context.rounds)?;
        let first = race(experiment, &candidates, Wanted::First, context.rounds)?;
        text += &render::table(experiment, &all, &first);
    }
    Ok(text)
}

/// Measures candidates, and checks that they agree.
pub(crate) fn race(
    experiment: &Experiment,
    candidates: &[Candidate],
    wanted: Wanted,
    rounds: usize,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let contenders = candidates.iter().map(|candidate| candidate.set_up(experiment));
    let plan = Plan {
        wanted,
        rounds,
        split_rounds: 0,
    };
    let rows = measure(experiment, contenders.collect::<Result<_, _>>()?, plan, || ())?;
    match disagreement(experiment, &rows, wanted) {
        None => Ok(rows),
        Some(wrong) => Err(wrong.into()),
    }
}
