//! Many rays and points at one moment: one by one, and in batches.

use std::error::Error;
use std::thread;
use std::time::Instant;

use morph_collision_testkit::bench::{Asked, Many, ManyQuestions, Stopwatch, median};
use morph_collision_testkit::report::{NOTHING, Store, Table, short};
use serde::{Deserialize, Serialize};

use super::{Measure, Topic, no_losses};
use crate::report::context::Context;
use crate::report::page::Page;

const NAME: &str = "many_questions";

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::AllCores(measure),
    page,
    losses: no_losses,
};

/// What one question takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Row {
    questions: String,
    /// The threads of a batch; 0 if questions are asked one by one.
    threads: usize,
    /// The bodies' new pose included.
    microseconds: f64,
    measured: String,
}

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let mut counts = vec![1, 2, cores];
    counts.dedup();
    let mut ways = vec![Asked::OneByOne];
    ways.extend(counts.into_iter().map(Asked::Batch));
    let mut rows = Vec::new();
    for many in Many::ALL {
        eprintln!("{NAME}: {}", many.title());
        for (asked, microseconds) in ways.iter().zip(race(many, &ways, context.rounds)?) {
            rows.push(Row {
                questions: many.title().to_owned(),
                threads: match asked {
                    Asked::OneByOne => 0,
                    Asked::Batch(threads) => *threads,
                },
                microseconds: short(microseconds),
                measured: context.timed(1, context.rounds),
            });
        }
    }
    context.store.write(NAME, &rows)
}

/// Microseconds of a question, for each way to ask it: medians of rounds, in turns.
fn race(many: Many, ways: &[Asked], rounds: usize) -> Result<Vec<f64>, Box<dyn Error>> {
    let mut contenders = ways
        .iter()
        .map(|_| ManyQuestions::new(many))
        .collect::<Result<Vec<_>, _>>()?;
    let mut times = vec![Vec::new(); ways.len()];
    // Round 0 grows memory.
    for round in 0..=rounds {
        let mut answers = None;
        for ((contender, way), times) in contenders.iter_mut().zip(ways).zip(&mut times) {
            let (start, watch) = (Instant::now(), Stopwatch::start());
            let own = contender.ask(round, *way)?;
            let taken = match way {
                // The time of other threads counts.
                Asked::Batch(2..) => start.elapsed(),
                Asked::Batch(_) | Asked::OneByOne => watch.elapsed(),
            };
            if *answers.get_or_insert(own) != own {
                return Err(format!("{}: {way:?} answers {own:?}, not {answers:?}", many.title()).into());
            }
            if round > 0 {
                times.push(1e6 * taken.as_secs_f64() / contender.count() as f64);
            }
        }
    }
    Ok(times.into_iter().map(|times| median(times.into_iter())).collect())
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Row> = store.rows(NAME)?;
    let page = Page {
        name: NAME,
        title: "Many rays and points at one moment",
        intro: "What one of ten thousand questions takes, in microseconds: processor time on one thread, wall time on several. All walkers have new joints and weights, so their new pose is\n\
            included. *One by one* calls `RayQuery::closest` or `ShapeQuery::closest_point` for each question, *batch* calls\n\
            `RayQuery::closest_batch` or `ShapeQuery::closest_point_batch` once for each body. The answers are the same, bit for bit.\n\
            \n\
            Rays come from all sides, a hundred at each walker. Points fill one walker's bounding box, grown by a quarter. A batch wakes other\n\
            threads only if that pays; a hundred rays are too few.\n\
            \n\
            `just instructions many-rays many-points` counts instructions of one moment, in batches (*all*) and one by one (*first*).\n",
        body: table(&rows).to_string(),
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(|row| (row.measured.as_str(), row.questions.as_str()))))
}

/// A row for each kind of question, a column for each way to ask it.
fn table(rows: &[Row]) -> Table {
    let mut threads: Vec<usize> = rows.iter().map(|row| row.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    let head = |threads: &usize| match threads {
        0 => "one by one".to_owned(),
        1 => "batch, 1 thread".to_owned(),
        more => format!("batch, {more} threads"),
    };
    let mut table = Table::new(
        ["us per question".to_owned()]
            .into_iter()
            .chain(threads.iter().map(head)),
    );
    for own in rows.chunk_by(|a, b| a.questions == b.questions) {
        let cell = |threads: &usize| {
            let row = own.iter().find(|row| row.threads == *threads);
            row.map_or(NOTHING.to_owned(), |row| format!("{:.2}", row.microseconds))
        };
        table.row([own[0].questions.clone()].into_iter().chain(threads.iter().map(cell)));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_a_cell_for_each_way_to_ask() {
        let row = |questions: &str, threads, microseconds| Row {
            questions: questions.to_owned(),
            threads,
            microseconds,
            measured: String::new(),
        };
        let rows = [row("rays", 0, 3.0), row("rays", 1, 2.5), row("points", 0, 4.0)];
        assert_eq!(
            table(&rows).to_string(),
            "| us per question | one by one | batch, 1 thread |\n|---|--:|--:|\n| rays | 3.00 | 2.50 |\n| points | 4.00 | - |\n"
        );
    }
}
