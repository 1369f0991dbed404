//! Runs interleaved rounds and summarises them.

use std::time::Duration;

use morph_collision::QueryStats;
use thiserror::Error;

use super::Answer;
use super::runner::{Pass, Runner, SplitPass};
use super::{Contender, Experiment};
use crate::rivals::PoseError;
use morph_collision::batch::Wanted;

/// How much to measure.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The question asked about two bodies.
    pub wanted: Wanted,
    /// Number of measured rounds, after one warm-up round.
    pub rounds: usize,
    /// Number of additional rounds in which times are split; 0 for no [`Parts`].
    pub split_rounds: usize,
}

impl Plan {
    /// How often each contender runs all frames.
    #[must_use]
    pub fn passes(&self) -> usize {
        1 + self.rounds + self.split_rounds
    }
}

/// A contender's work and times.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// The work of one pass over all frames.
    pub work: QueryStats,
    /// The findings per frame.
    pub found: Vec<Answer>,
    /// Seconds per frame on average; the median over the rounds.
    pub time: f64,
    /// Seconds of each frame, medians over the rounds.
    pub frame_times: Vec<f64>,
    /// The median over the rounds of its time divided by the first contender's.
    pub ratio: f64,
    /// The time split into parts, if that was requested.
    pub parts: Option<Parts>,
}

impl Row {
    /// Pairs of triangles in all frames of a pass.
    #[must_use]
    pub fn pairs(&self) -> u64 {
        self.found.iter().map(|found| found.pairs).sum()
    }
}

/// Seconds per frame by phase; see [how times are split](super).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parts {
    /// Setting weights and placements, and updating vertices if that happens at once.
    pub blend: f64,
    /// Updating volumes (for lazy methods also vertices).
    pub refit: f64,
    /// Broad phase and queries.
    pub query: f64,
}

impl Parts {
    /// Medians over passes, scaled so that they sum to `total`.
    fn of(passes: &[SplitPass], total: f64) -> Option<Self> {
        let part = |of: fn(&SplitPass) -> Duration| median(passes.iter().map(|pass| of(pass).as_secs_f64()));
        let (blend, refit, query) = (part(|p| p.blend), part(|p| p.refit), part(|p| p.query));
        let sum = blend + refit + query;
        let scale = total / sum;
        (sum > 0.0).then_some(Self {
            blend: blend * scale,
            refit: refit * scale,
            query: query * scale,
        })
    }
}

/// Measures contenders against the first of them. Calls `progress` after every pass.
///
/// # Errors
/// A method refuses weights or placements.
pub fn measure(
    experiment: &Experiment,
    contenders: Vec<Contender>,
    plan: Plan,
    mut progress: impl FnMut(),
) -> Result<Vec<Row>, PoseError> {
    let mut runners: Vec<Runner> = contenders.into_iter().map(Runner::new).collect();
    let mut passes = vec![Vec::with_capacity(plan.rounds); runners.len()];
    for round in 0..=plan.rounds {
        let mut turns: Vec<_> = runners.iter_mut().zip(&mut passes).collect();
        // Bodies of a mesh share one model, so a contender finds it in the processor's cache if the one before has used it. With both orders in
        // turn, none is always the one that loads it.
        if round % 2 == 1 {
            turns.reverse();
        }
        for (runner, own) in turns {
            let pass = runner.pass(experiment, plan.wanted)?;
            if round > 0 {
                own.push(pass);
            }
            progress();
        }
    }
    let mut splits = vec![Vec::with_capacity(plan.split_rounds); runners.len()];
    for _ in 0..plan.split_rounds {
        for (runner, own) in runners.iter_mut().zip(&mut splits) {
            own.push(runner.split_pass(experiment, plan.wanted)?);
            progress();
        }
    }
    let totals: Vec<Vec<f64>> = passes.iter().map(|own| own.iter().map(seconds).collect()).collect();
    let rows = runners.into_iter().zip(passes).zip(&splits).zip(&totals);
    Ok(rows
        .map(|(((runner, mut own), split), times)| {
            let frames = experiment.frames.len();
            let time = median(times.iter().copied());
            let of_frame = |frame: usize| median(own.iter().map(|pass| pass.times[frame].as_secs_f64()));
            let frame_times = (0..frames).map(of_frame).collect();
            let last = own.pop().unwrap_or_default();
            Row {
                name: runner.name,
                work: last.work,
                found: last.found,
                time,
                frame_times,
                ratio: median(times.iter().zip(&totals[0]).map(|(own, first)| own / first)),
                parts: Parts::of(split, time),
            }
        })
        .collect())
}

/// A pass's average seconds per frame.
fn seconds(pass: &Pass) -> f64 {
    pass.times.iter().sum::<Duration>().as_secs_f64() / pass.times.len().max(1) as f64
}

/// The median, or 0 if there are no values.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

/// Two methods with different findings, one of which is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{scene}, step {step}: {other} finds {found} {what}, {first} finds {expected}")]
pub struct Disagreement {
    scene: String,
    step: usize,
    first: String,
    other: String,
    what: &'static str,
    expected: u64,
    found: u64,
}

/// The first frame in which a row disagrees with the first row: on the number of pairs of triangles, or on the number
/// of touching pairs of bodies if only first pairs were wanted.
#[must_use]
pub fn disagreement(experiment: &Experiment, rows: &[Row], wanted: Wanted) -> Option<Disagreement> {
    let (first, others) = rows.split_first()?;
    let (what, count): (_, fn(&Answer) -> u64) = match wanted {
        Wanted::All => ("pairs of triangles", |found| found.pairs),
        Wanted::First | Wanted::UpTo(_) => ("touching pairs of bodies", |found| found.touching),
    };
    others.iter().find_map(|other| {
        let counts = first.found.iter().map(count).zip(other.found.iter().map(count));
        let (frame, (expected, found)) = counts.enumerate().find(|(_, (expected, found))| expected != found)?;
        Some(Disagreement {
            scene: experiment.name.clone(),
            step: experiment.steps[frame],
            first: first.name.clone(),
            other: other.name.clone(),
            what,
            expected,
            found,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::Entrant;
    use super::*;
    use crate::rivals::MethodOptions;

    fn rows(wanted: Wanted) -> Result<(Experiment, Vec<Row>), Box<dyn std::error::Error>> {
        let experiment = Experiment::dolphins(0, 200);
        let contenders = Entrant::ALL
            .iter()
            .map(|entrant| entrant.set_up(&experiment, &MethodOptions::default()));
        let plan = Plan {
            wanted,
            rounds: 1,
            split_rounds: 1,
        };
        let rows = measure(&experiment, contenders.collect::<Result<_, _>>()?, plan, || ())?;
        Ok((experiment, rows))
    }

    #[test]
    fn entrants_agree_and_parts_come_to_the_total() -> Result<(), Box<dyn std::error::Error>> {
        for wanted in [Wanted::All, Wanted::First] {
            let (experiment, rows) = rows(wanted)?;
            assert_eq!(disagreement(&experiment, &rows, wanted), None);
            for row in &rows {
                assert_eq!(row.frame_times.len(), 2);
                let parts = row.parts.ok_or("no parts")?;
                let sum = parts.blend + parts.refit + parts.query;
                assert!((sum - row.time).abs() <= 1e-9 * row.time, "{row:?}");
            }
        }
        Ok(())
    }

    #[test]
    fn a_wrong_count_is_told_with_its_step() -> Result<(), Box<dyn std::error::Error>> {
        let (experiment, mut rows) = rows(Wanted::All)?;
        let wrong = rows.iter_mut().find(|row| row.name == "hybrid-binary");
        wrong.ok_or("no such row")?.found[1].pairs += 1;
        let told = disagreement(&experiment, &rows, Wanted::All).map(|found| found.to_string());
        let told = told.ok_or("nothing found")?;
        assert!(
            told.starts_with("dolphins-564, step 200: hybrid-binary finds"),
            "{told}"
        );
        Ok(())
    }

    #[test]
    fn a_frame_is_new_in_every_round_even_if_there_is_only_one() -> Result<(), Box<dyn std::error::Error>> {
        let experiment = Experiment::dolphins(0, 400);
        let morph = Entrant::ALL[0].set_up(&experiment, &MethodOptions::default())?;
        let plan = Plan {
            wanted: Wanted::All,
            rounds: 2,
            split_rounds: 0,
        };
        let rows = measure(&experiment, vec![morph], plan, || ())?;
        assert!(rows[0].work.nodes_blended > 0, "{:?}", rows[0]);
        Ok(())
    }
}
