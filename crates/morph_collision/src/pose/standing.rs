use super::Posed;
use crate::bounds::{Aabb, PlacedBounds, WorldFromModel};
use crate::tree::Child;

/// What queries about two bodies need to know of each posed body in the world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Standing {
    /// Whether it is valid for the pose's current weights and boxes.
    is_current: bool,
    pub(crate) root: Child,
    pub(crate) is_skinned: bool,
    /// In model space.
    pub(crate) bounds: Aabb,
    pub(crate) placed: PlacedBounds,
    /// Roughly the body's longest side in the world.
    pub(crate) size: f64,
    /// A bound, in the world, on how far rounding moves its points and widens its boxes.
    pub(crate) slack: f64,
}

impl Standing {
    /// Discards everything, because the weights or the boxes have changed.
    pub(super) fn forget(&mut self) {
        self.is_current = false;
    }

    fn is_at(&self, world_from_model: &WorldFromModel) -> bool {
        self.is_current && self.placed.world_from_model().is_same_map(world_from_model)
    }
}

impl Posed<'_> {
    /// Places the body, or returns the cached result if it has not moved: several queries per frame ask for the same.
    pub(crate) fn stand(&mut self) -> &Standing {
        if !self.standing.is_at(self.place) {
            let world_from_model = self.place;
            let bounds = self.bounds();
            let magnitude = bounds.magnitude().as_dvec3();
            let placed = match &self.skin {
                None => PlacedBounds::new(world_from_model, magnitude),
                Some((_, skinning)) => PlacedBounds::with_error(world_from_model, magnitude, skinning.error()),
            };
            let (size, linear) = (bounds.size().as_dvec3(), world_from_model.linear());
            let sides = [linear.x_axis * size.x, linear.y_axis * size.y, linear.z_axis * size.z];
            let rounding = f64::from(self.rounding(bounds.size().max_element()));
            *self.standing = Standing {
                is_current: true,
                root: self.topology.group(0).child(0),
                is_skinned: self.is_skinned(),
                bounds,
                size: sides.iter().fold(0.0, |size, side| side.abs().max_element().max(size)),
                slack: placed.error() + rounding * world_from_model.scale(),
                placed,
            };
        }
        self.standing
    }
}
