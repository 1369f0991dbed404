//! Cylinders, cones, and cones without their tips.

use glam::{DVec2, DVec3};

use super::convex::Convex;
use super::frame::Frame;
use crate::exact::{Segment, closest_on_segment};

/// A solid of revolution around the y axis of its frame, between two discs.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Frustum {
    half_height: f64,
    bottom_radius: f64,
    top_radius: f64,
    /// The unit normal of the side: outwards, and up.
    side: DVec2,
    pub(super) frame: Frame,
}

impl Frustum {
    /// If the height is 0, it is the larger disc.
    pub(in super::super) fn new(half_height: f64, [bottom, top]: [f64; 2], frame: Frame) -> Self {
        let is_flat = half_height == 0.0;
        let [bottom_radius, top_radius] = if is_flat { [bottom.max(top); 2] } else { [bottom, top] };
        let side = if is_flat {
            DVec2::X
        } else {
            // Scaled first, to avoid underflow.
            let slope = DVec2::new(2.0 * half_height, bottom - top);
            (slope / slope.abs().max_element()).normalize()
        };
        Self {
            half_height,
            bottom_radius,
            top_radius,
            side,
            frame,
        }
    }

    fn largest_radius(&self) -> f64 {
        self.bottom_radius.max(self.top_radius)
    }

    fn half_extents(&self) -> DVec3 {
        let radius = self.largest_radius();
        DVec3::new(radius, self.half_height, radius)
    }

    pub(super) fn around(&self) -> (DVec3, f64) {
        (
            self.frame.center,
            DVec2::new(self.half_height, self.largest_radius()).length(),
        )
    }

    pub(super) fn reach(&self) -> f64 {
        self.frame.center.abs().max_element() + self.half_extents().element_sum()
    }

    pub(super) fn displacement_from(&self, before: &Self) -> f64 {
        let half = self.half_extents();
        let is_same_size = half == before.half_extents() && self.side == before.side;
        if is_same_size {
            self.frame.displacement_from(&before.frame, -half, half)
        } else {
            f64::INFINITY
        }
    }

    /// The larger of the distances from the planes of the discs and from the side's cone: the signed distance inside, and not more than
    /// it outside. With its gradient in the plane of the radius and the axis.
    fn local_depth(&self, radius: f64, y: f64) -> (f64, DVec2) {
        let above = (y - self.half_height, DVec2::Y);
        let below = (-self.half_height - y, DVec2::NEG_Y);
        let from_rim = DVec2::new(radius - self.top_radius, y - self.half_height);
        let beside = (self.side.dot(from_rim), self.side);
        let disc = if above.0 >= below.0 { above } else { below };
        if beside.0 >= disc.0 { beside } else { disc }
    }

    /// The signed distance of a point and its gradient, in the plane of the radius and the axis.
    fn local_distance(&self, radius: f64, y: f64) -> (f64, DVec2) {
        let inside = self.local_depth(radius, y);
        if inside.0 <= 0.0 {
            return inside;
        }
        let point = DVec3::new(radius, y, 0.0);
        let [bottom, top] = [
            DVec3::new(self.bottom_radius, -self.half_height, 0.0),
            DVec3::new(self.top_radius, self.half_height, 0.0),
        ];
        let on_axis = |rim: DVec3| DVec3::new(0.0, rim.y, 0.0);
        let border: [Segment; 3] = [[on_axis(bottom), bottom], [bottom, top], [top, on_axis(top)]];
        let mut best = (f64::INFINITY, DVec3::ZERO);
        for line in border {
            let from = point - closest_on_segment(point, line);
            let distance = from.length();
            if distance < best.0 {
                best = (distance, from);
            }
        }
        (best.0, best.1.try_normalize().map_or(inside.1, DVec3::truncate))
    }

    fn in_profile(&self, point: DVec3, of_profile: impl Fn(f64, f64) -> (f64, DVec2)) -> (f64, DVec3) {
        let local = self.frame.local(point);
        let around = DVec2::new(local.x, local.z);
        let (distance, gradient) = of_profile(around.length(), local.y);
        let around = around.normalize_or(DVec2::X) * gradient.x;
        let gradient = DVec3::new(around.x, gradient.y, around.y);
        (distance, self.frame.rotation * gradient)
    }

    pub(super) fn signed_distance(&self, point: DVec3) -> f64 {
        self.in_profile(point, |radius, y| self.local_distance(radius, y)).0
    }

    pub(super) fn outward(&self, point: DVec3) -> DVec3 {
        self.in_profile(point, |radius, y| self.local_distance(radius, y)).1
    }
}

impl Convex for Frustum {
    fn support_point(&self, direction: DVec3) -> DVec3 {
        let along = self.frame.local_direction(direction);
        let around = DVec2::new(along.x, along.z);
        let radius = around.length();
        let rims = [
            (self.bottom_radius, -self.half_height),
            (self.top_radius, self.half_height),
        ];
        let [bottom, top] = rims.map(|(r, y)| r * radius + y * along.y);
        let (r, y) = rims[usize::from(top > bottom)];
        let around = around.normalize_or_zero() * r;
        self.frame.world(DVec3::new(around.x, y, around.y))
    }

    fn depth(&self, point: DVec3) -> (f64, DVec3) {
        self.in_profile(point, |radius, y| self.local_depth(radius, y))
    }
}
