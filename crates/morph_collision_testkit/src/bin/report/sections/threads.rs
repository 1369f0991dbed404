//! Batches of pairs on several threads, and the most that the machine's cores can give.

use std::error::Error;
use std::fmt::Write;
use std::sync::Arc;
use std::thread;
use std::time::Instant;

use morph_collision::batch::{BatchQuery, PairTask, ThreadWorkers};
use morph_collision::{Body, BuildOptions, Kernel, MorphBvh, Pose, WorldFromModel, overlapping_pairs};
use morph_collision_testkit::bench::{Experiment, Frame, median};
use morph_collision_testkit::rivals::Wanted;

use super::Context;

/// Makes the section.
pub(crate) fn threads(context: &Context, _: &str) -> Result<String, Box<dyn Error>> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let mut counts = vec![1, 2, 4, 8, cores];
    counts.retain(|&count| count <= cores.max(2));
    counts.sort_unstable();
    counts.dedup();
    let experiments = [
        Experiment::pass_through(6, context.every),
        Experiment::many_dolphins(100, 2, context.every),
        Experiment::dolphins(3, context.every),
    ];
    let mut text = String::from("\n| speed in wall time, relative to one thread | wanted | ");
    for count in &counts {
        write!(text, "{count} thread{} | ", if *count == 1 { "" } else { "s" })?;
    }
    text += "that many copies at once, of one's throughput |\n|---|---|";
    text += &"--:|".repeat(counts.len() + 1);
    text += "\n";
    for experiment in &experiments {
        for wanted in [Wanted::All, Wanted::First] {
            eprintln!("threads: {}", experiment.title);
            let row = measure(experiment, wanted, &counts, context.rounds)?;
            let mode = if wanted == Wanted::All { "all" } else { "first" };
            write!(text, "| {} | {mode} | {:.0} us | ", experiment.title, row.one * 1e6)?;
            for ratio in &row.ratios {
                write!(text, "{ratio:.2} | ")?;
            }
            writeln!(text, "{:.2} |", row.capacity)?;
        }
    }
    Ok(text)
}

struct Row {
    /// Seconds per frame on one thread.
    one: f64,
    /// For each further thread count, the speedup over one thread.
    ratios: Vec<f64>,
    /// The throughput of independent copies of the one-threaded run, as many as the largest thread count at the same time,
    /// relative to a single run.
    capacity: f64,
}

fn measure(experiment: &Experiment, wanted: Wanted, counts: &[usize], rounds: usize) -> Result<Row, Box<dyn Error>> {
    let mut runs = Vec::new();
    for _ in counts {
        runs.push(Run::new(experiment)?);
    }
    let most = counts.last().copied().unwrap_or(1);
    let mut copies = Vec::new();
    for _ in 0..most {
        copies.push(Run::new(experiment)?);
    }
    let mut times = vec![Vec::new(); counts.len()];
    let mut capacities = Vec::new();
    // Round 0 fills caches and grows memory.
    for round in 0..=rounds {
        let mut found = None;
        let mut seconds = Vec::new();
        for (run, &count) in runs.iter_mut().zip(counts) {
            let start = Instant::now();
            let pairs = run.pass(experiment, wanted, count);
            seconds.push(start.elapsed().as_secs_f64());
            if *found.get_or_insert(pairs) != pairs {
                return Err(format!("{}: {count} threads found {pairs} pairs", experiment.title).into());
            }
        }
        let start = Instant::now();
        thread::scope(|scope| {
            for run in &mut copies {
                scope.spawn(|| run.pass(experiment, wanted, 1));
            }
        });
        let together = start.elapsed().as_secs_f64();
        if round > 0 {
            capacities.push(most as f64 * seconds[0] / together);
            for (times, seconds) in times.iter_mut().zip(seconds) {
                times.push(seconds);
            }
        }
    }
    let base = times[0].clone();
    let ratio = |own: &Vec<f64>| median(base.iter().zip(own).map(|(base, own)| base / own));
    Ok(Row {
        one: median(base.iter().copied()) / experiment.frames.len().max(1) as f64,
        ratios: times[1..].iter().map(ratio).collect(),
        capacity: median(capacities.into_iter()),
    })
}

/// The bodies of an experiment, queried in batches.
pub(super) struct Run {
    poses: Vec<Pose>,
    query: BatchQuery,
}

impl Run {
    pub(super) fn new(experiment: &Experiment) -> Result<Self, Box<dyn Error>> {
        Self::with_kernel(experiment, Kernel::default())
    }

    pub(super) fn with_kernel(experiment: &Experiment, kernel: Kernel) -> Result<Self, Box<dyn Error>> {
        let model = Arc::new(experiment.mesh.to_model()?);
        let bvh = Arc::new(MorphBvh::build(model, &BuildOptions::default()).with_kernel(kernel));
        Ok(Self {
            poses: (0..experiment.bodies).map(|_| Pose::new(bvh.clone())).collect(),
            query: BatchQuery::new(),
        })
    }

    /// Runs all frames; returns the number of pairs.
    pub(super) fn pass(&mut self, experiment: &Experiment, wanted: Wanted, threads: usize) -> usize {
        experiment
            .frames
            .iter()
            .map(|frame| self.frame(frame, wanted, threads))
            .sum()
    }

    fn frame(&mut self, frame: &Frame, wanted: Wanted, threads: usize) -> usize {
        let mut places = Vec::with_capacity(frame.len());
        let mut bounds = Vec::with_capacity(frame.len());
        for (pose, (weights, place)) in self.poses.iter_mut().zip(frame) {
            // The scripts' weights and placements are valid.
            let _ = pose.set_weights(weights);
            let place = WorldFromModel::new(*place).unwrap_or(WorldFromModel::IDENTITY);
            bounds.push(Some(pose.world_bounds(&place)));
            places.push(place);
        }
        let mut overlaps = Vec::new();
        overlapping_pairs(&bounds, &mut overlaps);
        let wanted = match wanted {
            Wanted::All => morph_collision::batch::Wanted::All,
            Wanted::First => morph_collision::batch::Wanted::First,
            Wanted::UpTo(limit) => morph_collision::batch::Wanted::UpTo(limit),
        };
        let task = |&(a, b): &(u32, u32)| PairTask::new(a as usize, b as usize, wanted);
        let mut tasks: Vec<_> = overlaps.iter().map(task).collect();
        let mut bodies: Vec<_> = self
            .poses
            .iter_mut()
            .zip(&places)
            .map(|(pose, place)| Body::new(pose, place))
            .collect();
        let workers = ThreadWorkers::new(threads);
        let answers = self.query.run(&mut bodies, &mut tasks, &workers);
        answers.iter().map(<[_]>::len).sum()
    }
}
