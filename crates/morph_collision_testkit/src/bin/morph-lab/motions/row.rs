//! The results of a family or a file.

use std::time::{Duration, Instant};

use morph_collision_testkit::motion::{ElementaryMotion, first_contact};

use super::core;

const THREADS: u64 = 2;

/// Tolerances of the times of impact; motions take turns.
const TOLERANCES: [f64; 5] = [0.1, 1e-3, 1e-6, 1e-9, 0.0];

/// Counts, and the first motion that is wrong.
#[derive(Debug, Default)]
pub(super) struct Row {
    motions: u64,
    touching: u64,
    /// Recorded answers that differ from the truth.
    wrong_records: u64,
    /// The library's answers that differ from the truth, with a time or without.
    differences: u64,
    /// Intervals that do not hold the first contact, or are no intervals within `[0, 1]`.
    wrong_intervals: u64,
    /// Intervals that are wider than the tolerance although their ends are not neighbours, or longer than 0 at a contact at the start.
    too_wide: u64,
    truth: Times,
    ours: Times,
    first_wrong: Option<(u64, String)>,
}

/// How long answers took.
#[derive(Clone, Copy, Debug, Default)]
struct Times {
    total: Duration,
    slowest: Duration,
}

impl Times {
    fn measure<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        let time = start.elapsed();
        self.add(Self {
            total: time,
            slowest: time,
        });
        result
    }

    fn add(&mut self, other: Self) {
        self.total += other.total;
        self.slowest = self.slowest.max(other.slowest);
    }

    /// Mean and longest, in microseconds.
    fn columns(&self, count: u64) -> String {
        let mean = self.total.as_secs_f64() * 1e6 / count.max(1) as f64;
        format!("{mean:.1} | {}", self.slowest.as_micros())
    }
}

impl Row {
    pub(super) const HEADER: &str = "| motions | count | touching | differences | wrong intervals | too wide | wrong records \
         | truth, µs | slowest | library, µs | slowest |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|";

    /// Prints it and returns whether everything agrees.
    pub(super) fn print(&self, name: &str) -> bool {
        println!(
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} |",
            self.motions,
            self.touching,
            self.differences,
            self.wrong_intervals,
            self.too_wide,
            self.wrong_records,
            self.truth.columns(self.motions),
            self.ours.columns(self.motions),
        );
        if let Some((index, text)) = &self.first_wrong {
            println!("\nfirst that is wrong: {index}: {text}\n");
        }
        self.first_wrong.is_none()
    }

    fn judge(&mut self, index: u64, motion: &ElementaryMotion, recorded: Option<bool>) {
        let first = self.truth.measure(|| first_contact(motion));
        self.motions += 1;
        self.touching += u64::from(first.is_some());

        let tolerance = TOLERANCES[index as usize % TOLERANCES.len()];
        let (touches, impact) = self
            .ours
            .measure(|| (core::touches(motion), core::impact(motion, tolerance)));
        let wrong_record = recorded.is_some_and(|recorded| recorded != first.is_some());
        let differs = touches != first.is_some() || impact.is_some() != first.is_some();
        let (mut wrong_interval, mut too_wide) = (false, false);
        if let (Some([earliest, latest]), Some(first)) = (impact, &first) {
            let sound = 0.0 <= earliest && earliest <= latest && latest <= 1.0;
            wrong_interval = !sound || !first.is_within(earliest, latest);
            let at_start = first.cmp_f64(0.0).is_eq() && latest > 0.0;
            too_wide = at_start || (latest - earliest > tolerance && latest > earliest.next_up());
        }
        self.wrong_records += u64::from(wrong_record);
        self.differences += u64::from(differs);
        self.wrong_intervals += u64::from(wrong_interval);
        self.too_wide += u64::from(too_wide);
        if (differs || wrong_interval || too_wide || wrong_record) && self.first_wrong.is_none() {
            let truth = first.map(|first| first.to_f64());
            let answer = format!("truth {truth:?}, recorded {recorded:?}, touches {touches}, impact {impact:?}");
            self.first_wrong = Some((index, format!("{answer}, tolerance {tolerance:e}\n{motion:?}")));
        }
    }

    fn add(&mut self, other: Self) {
        self.motions += other.motions;
        self.touching += other.touching;
        self.wrong_records += other.wrong_records;
        self.differences += other.differences;
        self.wrong_intervals += other.wrong_intervals;
        self.too_wide += other.too_wide;
        self.truth.add(other.truth);
        self.ours.add(other.ours);
        let wrong = [self.first_wrong.take(), other.first_wrong];
        self.first_wrong = wrong.into_iter().flatten().min();
    }
}

/// Compares the answers to all motions, which `motion` gives by index with the recorded answer.
pub(super) fn judge_all(count: u64, motion: impl Fn(u64) -> (ElementaryMotion, Option<bool>) + Sync) -> Row {
    let judge = |thread| {
        let mut row = Row::default();
        for index in (thread..count).step_by(THREADS as usize) {
            let (motion, recorded) = motion(index);
            row.judge(index, &motion, recorded);
        }
        row
    };
    let mut all = Row::default();
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS).map(|thread| scope.spawn(move || judge(thread))).collect();
        for thread in threads {
            match thread.join() {
                Ok(row) => all.add(row),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
    });
    all
}
