//! What the boxes of a skinned mesh are computed from.

use fearless_simd::Level;

use crate::model::{MorphModel, Weights};
use crate::tree::SkinTables;

/// Sums of larger coordinates could overflow, so their boxes are infinite.
pub(super) const MAX_REACH: f32 = 1e37;

/// The parts of the tree and the pose that [`Skinning`](super::skinning::Skinning) needs.
#[derive(Clone, Copy)]
pub(super) struct SkinTree<'a> {
    pub(super) model: &'a MorphModel,
    pub(super) skin: &'a SkinTables,
    pub(super) weights: &'a Weights,
    pub(super) level: Level,
}
