use std::mem;
use std::sync::Arc;

use super::body::Body;
use crate::bounds::{Aabb, Frame, a_from_b, frobenius};
use crate::pose::Place;
use crate::traverse::Trace;
use crate::tree::{Leaf, MorphBvh};

/// What a [`PairMemory`] keeps from one frame to the next; by default the witness, which wins wherever it was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Remember {
    /// The distance by which a pair was proved apart. The pair is not looked at again until the bodies could have moved
    /// as far, by their weights and by their placements relative to each other. Needs a first body that can be inverted.
    pub separation: bool,
    /// Where the last walk ended (its front), so that the next one starts there instead of at the roots.
    pub front: bool,
    /// The two leaves whose triangles intersected when one pair was asked for: they are tried before anything else. For
    /// [`PairQuery::first_with`](crate::PairQuery::first_with).
    pub witness: bool,
}

impl Remember {
    /// Nothing at all.
    pub const NOTHING: Self = Self {
        separation: false,
        front: false,
        witness: false,
    };
}

impl Default for Remember {
    fn default() -> Self {
        Self {
            witness: true,
            ..Self::NOTHING
        }
    }
}

/// Walks in a row that may start from a front before one starts from the roots again: a front only ever grows.
const FRONT_WALKS: u32 = 16;

/// What is remembered of one pair of bodies between frames; give it to [`PairQuery::visit_with`](crate::PairQuery::visit_with).
///
/// Answers are the same as without. Keep one per pair, always with the bodies in the same order; a body whose tree is
/// another one than before is noticed. `docs/performance.md` says where each kind of memory wins and loses.
///
/// ```
/// # use std::ops::ControlFlow;
/// # use std::sync::Arc;
/// # use glam::{Affine3A, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())?);
/// let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
/// let above = WorldFromModel::new(Affine3A::from_translation(Vec3::Z * 2.0))?;
/// let mut memory = PairMemory::new(Remember { separation: true, ..Remember::default() });
/// let mut query = PairQuery::new();
/// for frame in 0..20 {
///     a.set_weights(&[0.1 * frame as f32])?; // rises from 0 to 1.9
///     let bodies = (Body::new(&mut a, &WorldFromModel::IDENTITY), Body::new(&mut b, &above));
///     query.visit_with(&mut memory, bodies.0, bodies.1, |_| unreachable!("they never meet"));
/// }
/// assert!(memory.skipped() > 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct PairMemory {
    pub(super) remember: Remember,
    trees: Option<[Arc<MorphBvh>; 2]>,
    pub(super) front: Vec<(Place, Place)>,
    pub(super) trace: Trace,
    front_walks: u32,
    proof: Option<Proof>,
    /// The leaves whose triangles intersected last.
    pub(super) witness: Option<(Leaf, Leaf)>,
    skipped: u64,
}

/// A distance between two bodies in A's space, and how they stood when it was measured.
#[derive(Debug)]
struct Proof {
    distance: f64,
    weights: [Vec<f32>; 2],
    a_from_b: Frame,
    bounds: [Aabb; 2],
}

impl PairMemory {
    /// Nothing remembered yet.
    #[must_use]
    pub fn new(remember: Remember) -> Self {
        Self {
            remember,
            trees: None,
            front: Vec::new(),
            trace: Trace::default(),
            front_walks: 0,
            proof: None,
            witness: None,
            skipped: 0,
        }
    }

    /// How many queries were answered from a separation alone.
    #[must_use]
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// How many node pairs the next walk starts from; 0 is the roots.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.front.len()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.trees = None;
        self.front.clear();
        self.front_walks = 0;
        self.proof = None;
        self.witness = None;
    }

    /// The leaves to try first, if it is about these trees and they are wanted.
    pub(super) fn witness_of(&mut self, a: &Body<'_>, b: &Body<'_>) -> Option<(Leaf, Leaf)> {
        self.meet(a, b);
        self.witness.filter(|_| self.remember.witness)
    }

    /// Whether the bodies cannot have met since they were proved apart.
    pub(super) fn proves_apart(&mut self, a: &Body<'_>, b: &Body<'_>) -> bool {
        self.meet(a, b);
        let apart = self.proof.as_ref().is_some_and(|proof| proof.holds(a, b));
        self.skipped += u64::from(apart);
        apart
    }

    /// Forgets what was about other trees.
    fn meet(&mut self, a: &Body<'_>, b: &Body<'_>) {
        let trees = [a.pose.bvh(), b.pose.bvh()];
        let same = self
            .trees
            .as_ref()
            .is_some_and(|known| known.iter().zip(trees).all(|(known, tree)| Arc::ptr_eq(known, tree)));
        if !same {
            self.clear();
            self.trees = Some(trees.map(Arc::clone));
        }
    }

    /// Before a walk.
    pub(super) fn begin(&mut self) {
        self.proof = None;
        if self.front_walks >= FRONT_WALKS {
            self.front.clear();
            self.front_walks = 0;
        }
        self.trace.front.clear();
        self.trace.gap = if self.remember.separation { f64::INFINITY } else { 0.0 };
    }

    /// Nothing is known from a query that walked over no tree.
    pub(super) fn forget_walk(&mut self) {
        self.trace.gap = 0.0;
        self.witness = None;
    }

    /// After a walk.
    pub(super) fn finish(&mut self, touched: bool, a: Body<'_>, b: Body<'_>) {
        if self.remember.front {
            mem::swap(&mut self.front, &mut self.trace.front);
            self.front_walks += 1;
        }
        if !touched && self.remember.separation {
            self.proof = Proof::new(self.trace.gap, a, b);
        }
    }
}

impl Proof {
    /// `None` if the gap is none, or A cannot be inverted.
    fn new(gap: f64, a: Body<'_>, b: Body<'_>) -> Option<Self> {
        let bounds = [a.pose.bounds(), b.pose.bounds()];
        let a_from_b = a_from_b(a.world_from_model, &bounds[0], b.world_from_model, &bounds[1])?;
        (gap > 0.0 && gap.is_finite()).then(|| Self {
            distance: gap,
            weights: [a.pose.weights().to_vec(), b.pose.weights().to_vec()],
            a_from_b,
            bounds,
        })
    }

    /// Whether the bodies cannot have moved as far as they were apart.
    fn holds(&self, a: &Body<'_>, b: &Body<'_>) -> bool {
        let [bounds_a, bounds_b] = &self.bounds;
        let before = &self.a_from_b;
        let Some(now) = a_from_b(a.world_from_model, bounds_a, b.world_from_model, bounds_b) else {
            return false;
        };
        let linear = now.linear - before.linear;
        let (min, max) = (bounds_b.min.as_dvec3(), bounds_b.max.as_dvec3());
        let (center, half) = (0.5 * (min + max), 0.5 * (max - min));
        let rigid =
            (linear * center + (now.translation - before.translation)).length() + frobenius(linear) * half.length();
        let morphed_a = a.pose.displacement_from(&self.weights[0]);
        let morphed_b = frobenius(now.linear) * b.pose.displacement_from(&self.weights[1]);
        // Vertices that left the bounds by morphing may be placed less exactly; by far less than this.
        let error = 2.0 * (before.error.length() + now.error.length());
        // The margin covers the roundings of these few sums.
        (rigid + morphed_a + morphed_b + error) * (1.0 + 1e-9) < self.distance
    }
}
