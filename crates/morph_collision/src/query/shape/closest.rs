//! Where a triangle is closest to a shape.

use glam::DVec3;

/// The point of a triangle with the smallest signed distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    pub(super) point: DVec3,
    /// The unit vector along which the signed distance grows.
    pub(super) normal: DVec3,
    pub(super) distance: f64,
}
