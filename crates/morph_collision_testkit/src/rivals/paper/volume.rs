//! The operations that a bounding volume needs for morphing.

use std::fmt::Debug;

use glam::DVec3;

use crate::rivals::relative::RoundedBody;

/// A bounding volume in model space.
pub(super) trait Volume: Copy + Debug + Send + Sync + 'static {
    /// Compares the volumes of two placed bodies.
    type Culling;

    /// The volume of only the origin, from which a blend starts.
    const ZERO: Self;

    /// The volume around some points, at least one.
    fn around(points: &[DVec3]) -> Self;

    /// Adds a term of a blend: `weight` times `other`.
    ///
    /// If `other` contains points `p` and `self` contains points `q`, then `self` contains all `q + weight * p`
    /// afterwards.
    fn add(&mut self, weight: f64, other: &Self);

    /// Enlarges it to contain all points whose coordinates are off by at most `error`.
    fn widen(&mut self, error: f64);

    /// Lower and upper corner of the box around it.
    fn aabb(&self) -> [DVec3; 2];

    /// Made once per pair of bodies.
    fn culling(a: &RoundedBody, b: &RoundedBody) -> Self::Culling;

    /// Whether a volume of body A and one of body B may share a point.
    fn overlap(culling: &Self::Culling, a: &Self, b: &Self) -> bool;

    #[cfg(test)]
    fn contains(&self, point: DVec3) -> bool;
}
