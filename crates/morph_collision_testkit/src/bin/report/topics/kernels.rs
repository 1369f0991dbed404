//! The effect of the processor's vector instructions: the same queries with each instruction set.

use std::error::Error;

use morph_collision::Kernel;
use morph_collision_testkit::bench::{Experiment, Stopwatch, median};
use morph_collision_testkit::rivals::Wanted;

use super::batches::Run;
use super::{Measure, Topic, no_losses};
use crate::comparison::every_method;
use crate::context::Context;
use crate::page::Page;
use crate::record::{ALL, FIRST, Record, Scene, scenes};
use crate::store::Store;
use crate::table::short;

pub(super) const NAME: &str = "kernels";

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::OneCore(measure),
    page,
    losses: no_losses,
};

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let mut rows = Vec::new();
    for experiment in Experiment::paper(context.every) {
        eprintln!("{NAME}: {}", experiment.title);
        for (wanted, name) in [(Wanted::All, ALL), (Wanted::First, FIRST)] {
            let times = times(&experiment, wanted, context.rounds)?;
            for (kernel, own) in Kernel::available().iter().zip(&times) {
                let each = median(own.iter().copied()) / experiment.frames.len().max(1) as f64;
                rows.push(Record {
                    scene: experiment.name.clone(),
                    title: experiment.title.clone(),
                    wanted: name.to_owned(),
                    method: kernel.name().to_owned(),
                    frames: experiment.frames.len(),
                    microseconds: short(each * 1e6),
                    ratio: short(median(own.iter().zip(&times[0]).map(|(own, first)| own / first))),
                    measured: context.timed(context.every, context.rounds),
                    ..Record::default()
                });
            }
        }
    }
    context.store.write(NAME, &rows)
}

/// Seconds of all frames in each round, for each instruction set.
fn times(experiment: &Experiment, wanted: Wanted, rounds: usize) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let kernels = Kernel::available().iter();
    let mut runs = kernels
        .map(|&kernel| Run::with_kernel(experiment, kernel))
        .collect::<Result<Vec<_>, _>>()?;
    let mut times = vec![Vec::new(); runs.len()];
    // Round 0 fills caches.
    for round in 0..=rounds {
        for (run, times) in runs.iter_mut().zip(&mut times) {
            let start = Stopwatch::start();
            run.pass(experiment, wanted, 1);
            if round > 0 {
                times.push(start.elapsed().as_secs_f64());
            }
        }
    }
    Ok(times)
}

/// The times with the baseline's instructions over those with the best ones.
pub(super) fn baseline(rows: &[Record]) -> Vec<f64> {
    let of_scene = |scene: Scene<'_>| {
        let last = |wanted: &&str| Some(scene.asked(wanted).last()?.ratio);
        scene.wanted().iter().filter_map(last).collect::<Vec<_>>()
    };
    scenes(rows).flat_map(of_scene).collect()
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Record> = store.rows(NAME)?;
    let table = every_method(&rows, "all pairs / first pairs");
    let page = Page {
        name: NAME,
        title: "Vector instructions",
        intro: "The same queries with each instruction set of the processor, in turns. The last one is the baseline that every processor of this\n\
            architecture has.\n",
        command: "just report --only kernels",
        data: &[NAME],
        body: format!("Times as ratios to the first instruction set:\n\n{table}"),
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(Record::origin)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::scene_of;

    #[test]
    fn the_baseline_is_the_last_instruction_set() {
        let rows = scene_of(
            "dolphins",
            &[("avx2", 1.0, 1.0), ("sse4.2", 1.1, 1.2), ("sse2", 1.3, 1.4)],
        );
        assert_eq!(baseline(&rows), [1.3, 1.4]);
    }
}
