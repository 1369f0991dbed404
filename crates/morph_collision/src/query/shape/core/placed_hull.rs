//! Convex hulls in world space.

use std::sync::Arc;

use glam::DVec3;

use super::super::ConvexHull;
use super::convex::Convex;
use super::frame::Frame;
use super::separation::separation;

/// A convex hull in world space.
#[derive(Clone, Debug)]
pub(in super::super) struct PlacedHull {
    hull: Arc<ConvexHull>,
    pub(super) frame: Frame,
}

impl PartialEq for PlacedHull {
    fn eq(&self, other: &Self) -> bool {
        self.frame == other.frame && self.is_same_hull(other)
    }
}

impl PlacedHull {
    pub(in super::super) fn new(hull: Arc<ConvexHull>, frame: Frame) -> Self {
        Self { hull, frame }
    }

    fn is_same_hull(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.hull, &other.hull) || self.hull == other.hull
    }

    pub(super) fn middle(&self) -> DVec3 {
        self.frame.world(self.hull.middle())
    }

    pub(super) fn around(&self) -> (DVec3, f64) {
        let center = self.frame.world(self.hull.low.midpoint(self.hull.high));
        (center, self.hull.low.distance(self.hull.high) * 0.5)
    }

    pub(super) fn reach(&self) -> f64 {
        let size = self.hull.low.abs().max(self.hull.high.abs());
        self.frame.center.abs().max_element() + size.element_sum()
    }

    pub(super) fn displacement_from(&self, before: &Self) -> f64 {
        if self.is_same_hull(before) {
            let (low, high) = (self.hull.low, self.hull.high);
            self.frame.displacement_from(&before.frame, low, high)
        } else {
            f64::INFINITY
        }
    }

    /// The distance and its gradient.
    fn distance(&self, point: DVec3) -> (f64, DVec3) {
        let (depth, normal) = self.depth(point);
        if depth > 0.0
            && let Some(apart) = separation(|direction| self.support_point(direction), |_| point, normal)
        {
            return (apart.distance, apart.normal);
        }
        (depth, normal)
    }

    pub(super) fn signed_distance(&self, point: DVec3) -> f64 {
        self.distance(point).0
    }

    pub(super) fn outward(&self, point: DVec3) -> DVec3 {
        self.distance(point).1
    }
}

impl Convex for PlacedHull {
    fn support_point(&self, direction: DVec3) -> DVec3 {
        self.frame
            .world(self.hull.farthest(self.frame.local_direction(direction)))
    }

    fn depth(&self, point: DVec3) -> (f64, DVec3) {
        let local = self.frame.local(point);
        let mut best = (f64::NEG_INFINITY, DVec3::X);
        for (normal, offset) in &self.hull.planes {
            let height = normal.dot(local) - offset;
            if height > best.0 {
                best = (height, *normal);
            }
        }
        (best.0, self.frame.rotation * best.1)
    }
}
