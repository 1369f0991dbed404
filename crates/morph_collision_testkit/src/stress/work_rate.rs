//! The time that an answer takes, compared with an ordinary one.

use std::time::Instant;

use morph_collision::BuildOptions;

use super::{Case, Family};
use crate::verify::{AnswerSource, Situation, Trees};

/// Repetitions; the shortest counts, because what else the machine does only adds to a time.
const REPEATS: usize = 5;

/// Number of ordinary cases; the median counts.
const ORDINARY: u64 = 15;

/// Seconds and intersecting pairs of triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorkRate {
    seconds: f64,
    pairs: f64,
}

impl WorkRate {
    /// The pace of a first answer, before anything is blended. `None` if the situation is refused.
    pub(super) fn of(trees: &Trees, situation: &Situation) -> Option<Self> {
        let (mut seconds, mut pairs) = (f64::INFINITY, 0.0);
        for _ in 0..REPEATS {
            let mut fresh = trees.at_rest();
            let start = Instant::now();
            fresh.set(situation).ok()?;
            pairs = fresh.answer().pairs.len() as f64;
            seconds = start.elapsed().as_secs_f64().min(seconds);
        }
        Some(Self { seconds, pairs })
    }

    /// The pace of the ordinary family, with trees of a leaf size.
    pub(super) fn ordinary(leaf_size: usize, seed: u64) -> Option<Self> {
        let options = BuildOptions::default().with_leaf_size(leaf_size).ok()?;
        let (mut seconds, mut pairs) = (Vec::new(), Vec::new());
        for index in 0..ORDINARY {
            let case = Case::new(Family::Ordinary, index, seed);
            let trees = Trees::build([&case.meshes[0], &case.meshes[1]], &options).ok()?;
            let pace = Self::of(&trees, &case.situation)?;
            seconds.push(pace.seconds);
            pairs.push(pace.pairs);
        }
        Some(Self {
            seconds: median(seconds),
            pairs: median(pairs),
        })
    }

    /// How many times slower it is than an ordinary answer with as many pairs. With fewer pairs than the ordinary case, it
    /// is compared with the ordinary case itself.
    pub(super) fn slowdown(&self, ordinary: &Self) -> f64 {
        let share = (self.pairs / ordinary.pairs.max(1.0)).max(1.0);
        self.seconds / (ordinary.seconds * share).max(f64::MIN_POSITIVE)
    }
}

/// 0 for an empty list.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
