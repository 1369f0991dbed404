use std::sync::Arc;

use super::body::Body;
use crate::tree::{Leaf, MorphBvh};

/// What is remembered of one pair of bodies between frames: the two leaves whose triangles intersected when one pair was asked
/// for. [`PairQuery::first_with`](crate::PairQuery::first_with) tries them before anything else.
///
/// Whether there is a pair does not depend on it; which pair is named may. Keep one per pair of bodies, always with the bodies
/// in the same order; a body whose tree is another one than before is noticed.
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
///     let (pair, _) = query.first_with(&mut memory, bodies.0, bodies.1);
///     assert_eq!(pair.is_some(), frame == 0);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct PairMemory {
    trees: Option<[Arc<MorphBvh>; 2]>,
    witness: Option<(Leaf, Leaf)>,
}

impl PairMemory {
    /// Nothing remembered yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The leaves to try first, if it is about these trees.
    pub(super) fn witness_of(&mut self, a: &Body<'_>, b: &Body<'_>) -> Option<(Leaf, Leaf)> {
        let trees = [a.pose.bvh(), b.pose.bvh()];
        let same = self
            .trees
            .as_ref()
            .is_some_and(|known| known.iter().zip(trees).all(|(known, tree)| Arc::ptr_eq(known, tree)));
        if !same {
            self.trees = Some(trees.map(Arc::clone));
            self.witness = None;
        }
        self.witness
    }

    /// The leaves whose triangles intersect now, of the trees that were asked about last.
    pub(super) fn remember(&mut self, witness: Option<(Leaf, Leaf)>) {
        self.witness = witness;
    }
}
