//! Batches of pairs on several threads, and the most that the machine's cores can give.

use std::error::Error;
use std::thread;
use std::time::Instant;

use morph_collision_testkit::bench::{Experiment, median};
use morph_collision_testkit::report::{Axis, Figure, NOTHING, Panel, Series, Store, Table, ratio, short};
use morph_collision_testkit::rivals::Wanted;

use super::batches::Run;
use super::{Measure, Topic};
use crate::report::context::Context;
use crate::report::losses::Loss;
use crate::report::page::Page;
use crate::report::record::{ALL, FIRST, Record};

const NAME: &str = "threads";

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::AllCores(measure),
    page,
    losses: |store| Ok(losses(&store.rows::<Record>(NAME)?)),
};

/// A batch on several threads.
const THREADS: &str = "threads";
/// As many independent runs on one thread each, at the same time.
pub(super) const COPIES: &str = "copies";

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
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
    let mut rows = Vec::new();
    for experiment in &experiments {
        eprintln!("{NAME}: {}", experiment.title);
        for (wanted, name) in [(Wanted::All, ALL), (Wanted::First, FIRST)] {
            for row in race(experiment, wanted, &counts, context.rounds)? {
                rows.push(Record {
                    scene: experiment.name.clone(),
                    title: experiment.title.clone(),
                    wanted: name.to_owned(),
                    frames: experiment.frames.len(),
                    measured: context.timed(context.every, context.rounds),
                    ..row
                });
            }
        }
    }
    context.store.write(NAME, &rows)
}

/// Seconds of a frame in each round, for each number of threads: of a batch, and of as many copies together.
fn race(
    experiment: &Experiment,
    wanted: Wanted,
    counts: &[usize],
    rounds: usize,
) -> Result<Vec<Record>, Box<dyn Error>> {
    let most = counts.last().copied().unwrap_or(1);
    let runs = |count: usize| (0..count).map(|_| Run::new(experiment)).collect::<Result<Vec<_>, _>>();
    let (mut batches, mut copies) = (runs(counts.len())?, runs(most)?);
    let mut times = vec![[Vec::new(), Vec::new()]; counts.len()];
    // Round 0 fills caches and grows memory.
    for round in 0..=rounds {
        let mut found = None;
        for ((run, &count), times) in batches.iter_mut().zip(counts).zip(&mut times) {
            let start = Instant::now();
            let pairs = run.pass(experiment, wanted, count);
            let of_batch = start.elapsed().as_secs_f64();
            if *found.get_or_insert(pairs) != pairs {
                return Err(format!("{}: {count} threads found {pairs} pairs", experiment.title).into());
            }
            let start = Instant::now();
            thread::scope(|scope| {
                for run in &mut copies[..count] {
                    scope.spawn(|| run.pass(experiment, wanted, 1));
                }
            });
            let of_copies = start.elapsed().as_secs_f64() / count as f64;
            if round > 0 {
                times[0].push(of_batch);
                times[1].push(of_copies);
            }
        }
    }
    let base = times[0][0].clone();
    let frames = experiment.frames.len().max(1) as f64;
    let record = |(&count, times): (&usize, &[Vec<f64>; 2])| {
        [THREADS, COPIES]
            .into_iter()
            .zip(times)
            .map(|(method, own)| Record {
                size: Some(count),
                method: method.to_owned(),
                microseconds: short(1e6 * median(own.iter().copied()) / frames),
                ratio: short(median(own.iter().zip(&base).map(|(own, base)| own / base))),
                ..Record::default()
            })
            .collect::<Vec<_>>()
    };
    Ok(counts.iter().zip(&times).flat_map(record).collect())
}

/// The throughput of a run relative to one thread, for each number of threads.
#[derive(Debug, PartialEq)]
struct Speeds {
    title: String,
    wanted: String,
    /// Numbers of threads, with the speeds of a batch and of as many copies.
    speeds: Vec<(usize, [f64; 2])>,
}

/// The speeds of all runs.
fn speeds(rows: &[Record]) -> Vec<Speeds> {
    let mut all: Vec<Speeds> = Vec::new();
    for row in rows {
        let is_same = |run: &&mut Speeds| run.title == row.title && run.wanted == row.wanted;
        let count = row.size.unwrap_or(1);
        let speed = 1.0 / row.ratio;
        match all.iter_mut().find(is_same) {
            None => all.push(Speeds {
                title: row.title.clone(),
                wanted: row.wanted.clone(),
                speeds: vec![(count, [speed; 2])],
            }),
            Some(run) => match run.speeds.iter_mut().find(|(of, _)| *of == count) {
                None => run.speeds.push((count, [speed; 2])),
                Some((_, speeds)) => speeds[usize::from(row.method == COPIES)] = speed,
            },
        }
    }
    all
}

/// Runs that are slower on several threads than on one.
fn losses(rows: &[Record]) -> Vec<Loss> {
    let of_run = |run: Speeds| {
        let slower = run.speeds.into_iter().filter(|(_, [batch, _])| *batch < 1.0);
        let loss = |(count, [batch, _]): (usize, [f64; 2])| {
            Loss::new(
                &run.title,
                &run.wanted,
                format!("one thread instead of {count}"),
                ratio(batch),
            )
        };
        slower.map(loss).collect::<Vec<_>>()
    };
    speeds(rows).into_iter().flat_map(of_run).collect()
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Record> = store.rows(NAME)?;
    let speeds = speeds(&rows);
    let counts: Vec<usize> = speeds
        .first()
        .map_or(Vec::new(), |run| run.speeds.iter().map(|(count, _)| *count).collect());
    let head = ["throughput / that of as many copies", "wanted", "1 thread"].map(str::to_owned);
    let more = counts.iter().skip(1).map(|count| format!("{count} threads"));
    let mut table = Table::new(head.into_iter().chain(more));
    for run in &speeds {
        let one = rows
            .iter()
            .find(|row| row.title == run.title && row.wanted == run.wanted);
        let time = one.map_or(NOTHING.to_owned(), |row| format!("{:.0} us", row.microseconds));
        let more = run
            .speeds
            .iter()
            .skip(1)
            .map(|(_, [batch, copies])| format!("{batch:.2} / {copies:.2}"));
        table.row([run.title.clone(), run.wanted.clone(), time].into_iter().chain(more));
    }
    let figure = Figure {
        name: NAME.to_owned(),
        panels: [ALL, FIRST].map(|wanted| panel(wanted, &speeds)).into(),
    };
    let plot = store.plot(&figure, "Throughput against threads, beside that of independent copies")?;
    let page = Page {
        name: NAME,
        title: "Threads",
        intro: "`BatchQuery` on its own threads (`ThreadWorkers`): frames of all bodies, setting weights, broad phase and queries, in wall time. One large pair is\n\
            cut into parts; with many bodies, pairs that share no body run at the same time. *Copies* are as many independent runs on one thread each, at\n\
            the same time: the most that sharing the work can reach on this machine.\n\
            \n\
            `ThreadWorkers` starts its threads anew in each batch, so small batches run on one thread. Use the engine's threads (`Workers`) instead. Weights,\n\
            bounds, the broad phase and collecting answers run on one thread.\n",
        body: format!("{plot}\n{table}"),
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(Record::origin)))
}

fn panel(wanted: &str, speeds: &[Speeds]) -> Panel {
    let lines = |run: &Speeds| {
        ["", ", copies"]
            .into_iter()
            .enumerate()
            .map(|(index, suffix)| Series {
                name: format!("{}{suffix}", run.title.trim_end_matches(" triangles")),
                points: run
                    .speeds
                    .iter()
                    .map(|(count, speeds)| (*count as f64, speeds[index]))
                    .collect(),
                marked: true,
            })
            .collect::<Vec<_>>()
    };
    Panel {
        title: if wanted == ALL { "All pairs" } else { "First pairs" }.to_owned(),
        x: Axis {
            label: "threads",
            log: false,
        },
        y: Axis {
            label: "throughput, relative to one thread",
            log: false,
        },
        series: speeds
            .iter()
            .filter(|run| run.wanted == wanted)
            .flat_map(lines)
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_those_of_batches_and_copies_for_each_count() {
        let row = |size, method: &str, ratio| Record {
            title: "Dolphins".to_owned(),
            wanted: ALL.to_owned(),
            size: Some(size),
            method: method.to_owned(),
            ratio,
            ..Record::default()
        };
        let rows = [
            row(1, THREADS, 1.0),
            row(1, COPIES, 1.0),
            row(2, THREADS, 1.25),
            row(2, COPIES, 0.625),
        ];
        let speeds = speeds(&rows);
        assert_eq!(speeds.len(), 1);
        assert_eq!(speeds[0].speeds, [(1, [1.0, 1.0]), (2, [0.8, 1.6])]);
        assert_eq!(
            losses(&rows),
            [Loss::new("Dolphins", ALL, "one thread instead of 2", "0.80")]
        );
    }
}
