//! Whether the boxes of a pose are blended or fitted to its vertices.

use crate::model::{MorphModel, Weights};

/// Where the boxes come from that are not cached yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BoxSource {
    /// They are blended; with joints, fitted chunk by chunk.
    Blended,
    /// Blended boxes would be loose. As soon as a query looks below the root's children, all vertices are posed.
    Loose,
    /// The same, and all vertices are posed. Boxes below those of the root's children are fitted to them. Like blended boxes, they also
    /// hold the vertices of exact arithmetic: they are larger by this on all sides.
    FittedBelow(f32),
    /// [`Pose::refit`](super::Pose::refit) or [`Pose::refit_lazily`](super::Pose::refit_lazily): all vertices are posed, and boxes are fitted to
    /// them.
    Refitted,
}

/// Boxes that are looser than this are not blended. Chosen from counts of instructions with 32 to 256 dense or sparse targets (docs/tried.md).
const LOOSE: f32 = 12.0;

impl BoxSource {
    /// The source for these weights. Blended boxes must hold for any weights, so the more weights move a vertex, the looser they are.
    pub(super) fn of_weights(model: &MorphModel, weights: &Weights) -> Self {
        let is_loose = model.skin().is_none() && model.looseness(weights) > LOOSE;
        if is_loose { Self::Loose } else { Self::Blended }
    }
}
