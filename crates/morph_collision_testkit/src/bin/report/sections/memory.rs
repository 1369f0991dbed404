//! What remembering data from frame to frame saves, in consecutive frames.

use std::error::Error;

use morph_collision_testkit::bench::{Experiment, NoExperiment};

use super::faces::kept;
use super::{Context, sweep};
use crate::sweeps;

/// A table for each experiment. The table of a missing model stays as it is in the page.
pub(crate) fn memory(context: &Context, old: &str) -> Result<String, Box<dyn Error>> {
    let steps = if context.quick { 60 } else { 100 };
    let experiments: Vec<_> = [1, 2, 8]
        .into_iter()
        .flat_map(|rate| Experiment::consecutive(steps, rate))
        .collect();
    let mut text = sweep(context, "memory", &experiments, sweeps::memory)?;
    for (name, title) in Experiment::walkers() {
        match Experiment::named(name, 1) {
            Ok(mut experiment) => {
                experiment.title += ", 60 frames a second";
                text += &sweep(context, "memory", &[experiment], sweeps::memory)?;
            }
            Err(missing @ NoExperiment::Missing { .. }) => {
                eprintln!("memory: {missing}; {title} stay as they are in the page");
                text += &kept(old, title);
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(text)
}
