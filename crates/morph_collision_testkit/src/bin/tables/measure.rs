//! Times in interleaved rounds (A B C A B C), so that what disturbs the machine disturbs all alike.

use std::time::Duration;

use morph_collision::{BuildOptions, QueryStats};
use morph_collision_testkit::moments::AnswerError;
use morph_collision_testkit::rivals::{BroadPhase, Method, MethodKind, MorphTuning, Wanted};

use super::clock::Stopwatch;
use super::experiments::Experiment;

/// One row of a table to be; the first of them is what the others are compared with.
pub(crate) struct Contender {
    pub(crate) label: String,
    pub(crate) method: MethodKind,
    pub(crate) options: BuildOptions,
    pub(crate) tuning: MorphTuning,
}

/// What a contender did in one pass over all frames.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pass {
    pub(crate) work: QueryStats,
    pub(crate) pairs: u64,
    /// Of one frame; of a row, the median.
    pub(crate) time: Duration,
    /// Of a row: the median of its time over the first row's in the same round.
    pub(crate) ratio: f64,
}

/// A contender's passes: all pairs, and first pairs.
pub(crate) struct Row {
    pub(crate) label: String,
    pub(crate) all: Pass,
    pub(crate) first: Pass,
}

/// Measures every contender `rounds` times in both modes.
pub(crate) fn measure(
    experiment: &Experiment,
    contenders: &[Contender],
    rounds: usize,
) -> Result<Vec<Row>, AnswerError> {
    let mut runners = Vec::with_capacity(contenders.len());
    for contender in contenders {
        let of_bodies = vec![0; experiment.bodies];
        let method =
            contender
                .method
                .set_up_tuned(&experiment.meshes, &of_bodies, &contender.options, contender.tuning)?;
        runners.push(Runner {
            method,
            broad_phase: BroadPhase::default(),
            pairs: Vec::new(),
        });
    }
    let mut rows: Vec<Row> = contenders
        .iter()
        .map(|contender| Row {
            label: contender.label.clone(),
            all: Pass::default(),
            first: Pass::default(),
        })
        .collect();
    for wanted in [Wanted::All, Wanted::First] {
        let mut times = vec![Vec::with_capacity(rounds); contenders.len()];
        // Round 0 fills caches and grows memory; its time is thrown away.
        for round in 0..=rounds {
            for ((runner, row), times) in runners.iter_mut().zip(&mut rows).zip(&mut times) {
                let pass = runner.pass(experiment, wanted)?;
                match wanted {
                    Wanted::All => row.all = pass,
                    Wanted::First => row.first = pass,
                }
                if round > 0 {
                    times.push(pass.time);
                }
            }
        }
        for (row, own) in rows.iter_mut().zip(&times) {
            let pass = match wanted {
                Wanted::All => &mut row.all,
                Wanted::First => &mut row.first,
            };
            let ratios = own
                .iter()
                .zip(&times[0])
                .map(|(own, base)| own.as_secs_f64() / base.as_secs_f64());
            pass.ratio = median(ratios);
            pass.time = Duration::from_secs_f64(median(own.iter().map(Duration::as_secs_f64)));
        }
    }
    Ok(rows)
}

/// The middle one, or 0 of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

struct Runner {
    method: Box<dyn Method>,
    broad_phase: BroadPhase,
    pairs: Vec<morph_collision::TrianglePair>,
}

impl Runner {
    fn pass(&mut self, experiment: &Experiment, wanted: Wanted) -> Result<Pass, AnswerError> {
        let method = self.method.as_mut();
        let before = method.work();
        let mut pairs = 0;
        let start = Stopwatch::start();
        for frame in &experiment.frames {
            for (body, (weights, place)) in frame.iter().enumerate() {
                method.set_body(body, weights, place)?;
            }
            for &(a, b) in self.broad_phase.pairs(method, experiment.bodies) {
                self.pairs.clear();
                method.collide(a as usize, b as usize, wanted, &mut self.pairs);
                pairs += self.pairs.len() as u64;
            }
        }
        let frames = experiment.frames.len().max(1) as u32;
        let time = start.elapsed() / frames;
        Ok(Pass {
            work: method.work() - before,
            pairs,
            time,
            ratio: 1.0,
        })
    }
}
