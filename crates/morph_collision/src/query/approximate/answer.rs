use std::ops::Range;
use std::sync::Arc;

use crate::query::{QueryStats, TrianglePair};
use crate::tree::MorphBvh;

/// All that is known of the intersecting triangles of two bodies.
///
/// A pair of triangles that is in none of the three lists does not intersect.
#[derive(Clone, Debug, Default)]
pub struct ApproximatePairs {
    /// Pairs that intersect, exactly.
    pub touching: Vec<TrianglePair>,
    /// Parts that lie within the tolerance of each other; whether their triangles intersect was not looked at.
    pub near: Vec<PartPair>,
    /// Parts that the budget did not suffice for.
    pub undecided: Vec<PartPair>,
    /// The work it took.
    pub stats: QueryStats,
}

impl ApproximatePairs {
    /// Whether nothing was left open, so that the touching pairs are all there are.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.near.is_empty() && self.undecided.is_empty()
    }
}

/// What is known of whether two bodies touch.
#[derive(Clone, Debug)]
pub enum ApproximateTouch {
    /// They do, exactly; one pair of triangles that intersect.
    Touching(TrianglePair),
    /// They come within the tolerance of each other, here.
    Near(PartPair),
    /// They do not, exactly.
    Apart,
    /// The budget did not suffice to say; they can touch in these parts only.
    Undecided(Vec<PartPair>),
}

/// A part of each of two bodies.
#[derive(Clone, Debug)]
pub struct PartPair {
    /// Triangles of the first body.
    pub a: MeshPart,
    /// Triangles of the second body.
    pub b: MeshPart,
    /// No triangle of the one part is farther from any triangle of the other, in world units.
    pub distance: f64,
}

impl PartPair {
    /// All pairs of a triangle of one part and a triangle of the other.
    pub fn pairs(&self) -> impl Iterator<Item = TrianglePair> {
        let of_b = self.b.triangles();
        self.a.triangles().iter().flat_map(move |&triangle_a| {
            of_b.iter()
                .map(move |&triangle_b| TrianglePair { triangle_a, triangle_b })
        })
    }

    /// How many pairs of triangles that are.
    #[must_use]
    pub fn pair_count(&self) -> u64 {
        self.a.triangles().len() as u64 * self.b.triangles().len() as u64
    }
}

/// The triangles below a node of a tree.
#[derive(Clone, Debug)]
pub struct MeshPart {
    pub(super) bvh: Arc<MorphBvh>,
    pub(super) range: Range<usize>,
}

impl MeshPart {
    /// Their numbers, as the user gave the mesh.
    #[must_use]
    pub fn triangles(&self) -> &[u32] {
        self.bvh.topology().triangles_at(self.range.clone())
    }
}
