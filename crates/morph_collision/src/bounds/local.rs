//! From world space to the space of a body's boxes, for points and rays.

use glam::{DMat3, DVec3};

use super::PlacedBounds;
use super::box_map::BoxMap;
use super::frame::to_world;
use super::inverse::Inverse;
use super::rounding::U64;

/// The space of a body's boxes; or the world relative to the body's translation, to which boxes are mapped then.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalSpace<'a> {
    body: &'a PlacedBounds,
    inverse: &'a Inverse,
    /// The largest absolute coordinates of the body's points.
    pub(super) magnitude: DVec3,
    /// By how much vectors grow on the way to the world, at most.
    norm: f64,
    pub(super) is_in_model: bool,
}

impl<'a> LocalSpace<'a> {
    /// The space of the body's boxes; `None` if the body's map has no inverse.
    pub(super) fn model(body: &'a PlacedBounds) -> Option<Self> {
        let world_from_model = body.world_from_model();
        Some(Self {
            body,
            inverse: world_from_model.inverse()?,
            magnitude: body.magnitude(),
            norm: (world_from_model.linear().abs() * DVec3::ONE).max_element(),
            is_in_model: true,
        })
    }

    pub(super) fn world(body: &'a PlacedBounds) -> Self {
        Self {
            body,
            inverse: &Inverse::IDENTITY,
            magnitude: body.spread(),
            norm: 1.0,
            is_in_model: false,
        }
    }

    /// Takes vectors of the world to this space.
    pub(super) fn linear(&self) -> DMat3 {
        self.inverse.linear
    }

    /// A bound on the distance, along each axis, between points that coincide in the world: one of the body, and one that is computed in the
    /// world, relative to the body, with a few roundings of numbers up to `rounded`. `reach` is how far they are from each other and from the
    /// space's origin before they coincide.
    pub(super) fn error(&self, rounded: f64, reach: f64) -> DVec3 {
        let world_error = self.body.error() + 4.0 * U64 * rounded;
        let world_reach = rounded + 2.0 * self.norm * reach;
        self.inverse.rows * (2.0 * (world_error + 16.0 * U64 * world_reach))
            + DVec3::splat(self.inverse.error * (world_error + world_reach))
    }
}

/// The map of boxes to the world, relative to the body's translation.
#[cold]
pub(super) fn map_to_world(body: &PlacedBounds) -> Option<BoxMap> {
    let (place, error) = (body.world_from_model(), DVec3::splat(body.error()));
    BoxMap::new(&to_world(place, place.translation(), body.magnitude(), error))
}
