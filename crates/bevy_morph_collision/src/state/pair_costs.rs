//! Which pairs take the most work.

use std::cmp::Reverse;

use bevy::prelude::*;
use morph_collision::QueryStats;

/// The pairs of colliders that took the most work in the last run. A pair that keeps its answer takes none.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn print_costliest(costs: Res<MorphPairCosts>) {
///     for pair in costs.pairs() {
///         println!("{} and {}: {} tests", pair.collider1, pair.collider2, pair.tests);
///     }
/// }
/// # let mut app = App::new();
/// app.insert_resource(MorphPairCosts::new(5)).add_systems(Last, print_costliest);
/// ```
#[derive(Resource, Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphPairCosts {
    /// How many pairs are listed. With 0, the default, nothing is counted.
    pub limit: usize,
    pairs: Vec<MorphPairCost>,
}

/// What a pair of colliders cost in a run.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphPairCost {
    /// The first collider.
    pub collider1: Entity,
    /// The second collider.
    pub collider2: Entity,
    /// The number of boxes, triangles and moving features that were compared. For a large pair of meshes, which is divided among threads, it
    /// depends a little on their number.
    pub tests: u64,
}

/// What is counted in a run: a pair may be there several times.
pub(crate) type PairWork = Vec<((Entity, Entity), u64)>;

/// The number of tests in some work.
pub(crate) fn tests(stats: &QueryStats) -> u64 {
    stats.node_tests + stats.triangle_tests + stats.feature_tests
}

impl MorphPairCosts {
    /// Counts, and lists so many pairs.
    #[must_use]
    pub fn new(limit: usize) -> Self {
        Self {
            limit,
            pairs: Vec::new(),
        }
    }

    /// The pairs, the costliest first.
    #[must_use]
    pub fn pairs(&self) -> &[MorphPairCost] {
        &self.pairs
    }

    /// Replaces the pairs by those of another run.
    pub(crate) fn replace(&mut self, mut work: PairWork) {
        work.sort_unstable();
        self.pairs.clear();
        for same in work.chunk_by(|(one, _), (other, _)| one == other) {
            let ((collider1, collider2), _) = same[0];
            let tests = same.iter().map(|(_, tests)| tests).sum();
            self.pairs.push(MorphPairCost {
                collider1,
                collider2,
                tests,
            });
        }
        self.pairs
            .sort_by_key(|pair| (Reverse(pair.tests), pair.collider1, pair.collider2));
        self.pairs.truncate(self.limit);
    }
}
