//! What a bounding volume must be able to do to be morphed.

use std::fmt::Debug;

use glam::DVec3;

use crate::rivals::relative::Placed;

/// A bounding volume in model space.
pub(super) trait Volume: Copy + Debug + Send + Sync + 'static {
    /// What compares the volumes of two placed bodies.
    type Culling;

    /// The volume of the origin alone: a blend starts from it.
    const ZERO: Self;

    /// The volume around some points, at least one.
    fn around(points: &[DVec3]) -> Self;

    /// Adds a term of a blend: `weight` times `other`.
    ///
    /// With `other` around points `p`, and `self` around points `q`, it is around all `q + weight * p` afterwards.
    fn add(&mut self, weight: f64, other: &Self);

    /// Makes it hold all points whose coordinates are off by at most `error`.
    fn widen(&mut self, error: f64);

    /// Lower and upper corner of the box around it.
    fn aabb(&self) -> [DVec3; 2];

    /// Made once for two bodies.
    fn culling(a: &Placed, b: &Placed) -> Self::Culling;

    /// Whether a volume of body A and one of body B may share a point.
    fn overlap(culling: &Self::Culling, a: &Self, b: &Self) -> bool;

    #[cfg(test)]
    fn contains(&self, point: DVec3) -> bool;
}
