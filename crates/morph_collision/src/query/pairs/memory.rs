//! What a query for one pair remembers from frame to frame.

use std::sync::Arc;

use crate::query::body::Body;
use crate::tree::{Leaf, MorphBvh};

/// What a query remembers about a pair of bodies from frame to frame: the two leaves that intersected when
/// [`PairQuery::first_with`](crate::PairQuery::first_with) last found a pair. The next call tries them first.
///
/// Keep one memory per pair of bodies, and always pass the bodies in the same order. If a body's tree changes, the memory is cleared.
/// Weights and placements may change freely.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
/// let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
/// let mut memory = PairMemory::new();
/// let mut query = PairQuery::new();
/// for frame in 0..20 {
///     a.set_weights(&[0.1 * frame as f32])?; // rises from 0 to 1.9
///     let bodies = (Body::new(&mut a, &WorldFromModel::IDENTITY), Body::new(&mut b, &WorldFromModel::IDENTITY));
///     let pair = query.first_with(&mut memory, bodies.0, bodies.1);
///     assert_eq!(pair.is_some(), frame == 0);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct PairMemory {
    trees: Option<[Arc<MorphBvh>; 2]>,
    witness: Option<(Leaf, Leaf)>,
}

impl PairMemory {
    /// Creates an empty memory.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The leaves to try first. Clears them if a tree has changed.
    pub(super) fn witness_of(&mut self, a: &Body<'_>, b: &Body<'_>) -> Option<(Leaf, Leaf)> {
        let trees = [a.pose.bvh(), b.pose.bvh()];
        let is_known =
            |known: &[Arc<MorphBvh>; 2]| known.iter().zip(trees).all(|(known, tree)| Arc::ptr_eq(known, tree));
        if !self.trees.as_ref().is_some_and(is_known) {
            self.trees = Some(trees.map(Arc::clone));
            self.witness = None;
        }
        self.witness
    }

    /// Stores the leaves that intersect, for the trees of the last [`PairMemory::witness_of`].
    pub(super) fn remember(&mut self, witness: Option<(Leaf, Leaf)>) {
        self.witness = witness;
    }
}
