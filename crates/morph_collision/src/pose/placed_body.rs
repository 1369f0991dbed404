//! What the world sees of a posed body.

use crate::bounds::{Aabb, PlacedBounds, WorldFromModel};
use crate::tree::Child;

/// What queries about two bodies need to know of each posed body in the world.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlacedBody {
    /// Whether it is valid for the pose's current weights and boxes.
    pub(super) is_current: bool,
    pub(crate) root: Child,
    /// In model space.
    pub(crate) bounds: Aabb,
    pub(crate) placed: PlacedBounds,
    /// Roughly the body's longest side in the world.
    pub(crate) size: f64,
    /// A bound, in the world, on how far rounding moves its points and widens its boxes.
    pub(crate) slack: f64,
}

impl PlacedBody {
    /// Discards everything, because the weights or the boxes have changed.
    pub(super) fn invalidate(&mut self) {
        self.is_current = false;
    }

    pub(super) fn is_at(&self, world_from_model: &WorldFromModel) -> bool {
        self.is_current && self.placed.world_from_model().is_same_map(world_from_model)
    }
}
