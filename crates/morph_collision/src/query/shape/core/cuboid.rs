//! Boxes in world space, exactly.

use std::cmp::Ordering::Equal;

use glam::DVec3;

use super::super::closest::Closest;
use super::frame::Frame;
use crate::exact::{
    ClosestPoints, Segment, Triangle, closest_of_segments, closest_on_triangle, edges, largest, plane_side,
    triangles_intersect,
};

/// A box in world space, given by its frame. Exact answers refer to its eight corners as rounded by [`Cuboid::corners`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Cuboid {
    half: DVec3,
    pub(super) frame: Frame,
}

/// The corners of each face, in order. The diagonal from the first corner splits the face into two triangles; it is part of the
/// definition.
const FACES: [[usize; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

/// Bounds the error of a local coordinate, relative to the largest coordinate involved: 128 roundings, more than the operations here.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl Cuboid {
    pub(in super::super) fn new(half: DVec3, frame: Frame) -> Self {
        Self { half, frame }
    }

    pub(super) fn center(&self) -> DVec3 {
        self.frame.center
    }

    pub(super) fn around(&self) -> (DVec3, f64) {
        (self.frame.center, self.half.length())
    }

    pub(super) fn moved_by(mut self, offset: DVec3) -> Self {
        self.frame.center += offset;
        self
    }

    /// Corner `i` in the box's own frame. Bit `k` selects the upper end along axis `k`.
    fn local_corner(&self, i: usize) -> DVec3 {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        self.half * DVec3::new(sign(1), sign(2), sign(4))
    }

    fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| self.frame.world(self.local_corner(i)))
    }

    /// The largest distance that a corner has moved. It bounds how far any point has moved, up to rounding of the lengths.
    pub(super) fn displacement_from(&self, before: &Self) -> f64 {
        let corners = self.corners().into_iter().zip(before.corners());
        largest(corners.map(|(now, before)| now.distance(before)))
    }

    fn local(&self, point: DVec3) -> DVec3 {
        self.frame.local(point)
    }

    pub(super) fn support(&self, direction: DVec3) -> f64 {
        let along = self.frame.local_direction(direction);
        direction.dot(self.frame.center) + along.abs().dot(self.half)
    }

    pub(super) fn support_point(&self, direction: DVec3) -> DVec3 {
        let along = self.frame.local_direction(direction);
        let sign = |along: f64| if along < 0.0 { -1.0 } else { 1.0 };
        let [x, y, z] = along.to_array().map(sign);
        self.frame.world(self.half * DVec3::new(x, y, z))
    }

    pub(super) fn reach(&self) -> f64 {
        self.frame.center.abs().max_element() + self.half.element_sum()
    }

    /// The gradient of the signed distance at a point, a unit vector.
    pub(super) fn outward(&self, point: DVec3) -> DVec3 {
        let local = self.local(point);
        let outside = local - local.clamp(-self.half, self.half);
        let direction = outside.try_normalize().unwrap_or_else(|| self.nearest_face(local));
        self.frame.rotation * direction
    }

    /// The outward axis of the face nearest to a local point inside.
    fn nearest_face(&self, local: DVec3) -> DVec3 {
        let axis = (local.abs() - self.half).max_position();
        DVec3::AXES[axis] * local[axis].signum()
    }

    pub(super) fn signed_distance(&self, point: DVec3) -> f64 {
        self.local_distance(self.local(point))
    }

    fn local_distance(&self, local: DVec3) -> f64 {
        let beyond = local.abs() - self.half;
        beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
    }

    pub(super) fn faces(&self) -> impl Iterator<Item = Triangle> {
        let corners = self.corners();
        let halves = FACES.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        halves.map(move |half| half.map(|corner| corners[corner]))
    }

    /// Exact for the corners, the centre and the triangle. Rounded local coordinates decide clear cases.
    pub(in super::super) fn intersects(&self, triangle: &Triangle) -> bool {
        let local = triangle.map(|corner| self.local(corner));
        let sizes = triangle.map(|corner| corner.abs().max_element()).into_iter();
        let slack = ROUNDING * sizes.fold(self.reach(), f64::max);
        let (outer, inner) = (self.half + slack, self.half - slack);
        let low = local[0].min(local[1]).min(local[2]);
        let high = local[0].max(local[1]).max(local[2]);
        if low.cmpgt(outer).any() || high.cmplt(-outer).any() {
            return false;
        }
        if local.iter().any(|p| p.abs().cmplt(inner).all()) {
            return true;
        }
        self.faces().any(|face| triangles_intersect(triangle, &face)) || self.holds(triangle[0])
    }

    /// Whether a point is in one of the twelve tetrahedra between the centre and the faces' triangles. Exact.
    ///
    /// Skips tetrahedra without volume: their points are on a face, or the box is flat.
    fn holds(&self, point: DVec3) -> bool {
        self.faces().any(|[a, b, c]| {
            let apex = self.frame.center;
            let volume = plane_side(a, b, c, apex);
            volume != Equal
                && [
                    plane_side(a, b, c, point),
                    plane_side(a, b, point, apex),
                    plane_side(a, point, c, apex),
                    plane_side(point, b, c, apex),
                ]
                .into_iter()
                .all(|side| side == Equal || side == volume)
        })
    }

    pub(super) fn closest(&self, triangle: &Triangle) -> Closest {
        let local = triangle.map(|corner| self.local(corner));
        let closest = |local: DVec3, normal: DVec3, distance| Closest {
            point: self.frame.world(local),
            normal: self.frame.rotation * normal,
            distance,
        };
        let intersects = self.intersects(triangle);
        if !intersects {
            let ClosestPoints { on_a, on_b, .. } = self.closest_outside(&local);
            if let Some(normal) = (on_b - on_a).try_normalize() {
                return closest(on_b, normal, on_a.distance(on_b));
            }
        }
        let (deepest, distance) = self.deepest(&local);
        let distance = if intersects {
            distance.min(0.0)
        } else {
            f64::MIN_POSITIVE
        };
        closest(deepest, self.nearest_face(deepest), distance)
    }

    /// The closest points of the box and a triangle outside, in local coordinates. One of them is a corner, or both are on edges.
    fn closest_outside(&self, triangle: &Triangle) -> ClosestPoints {
        let mut nearest = ClosestPoints::NONE;
        for &corner in triangle {
            nearest.keep(ClosestPoints::new(corner.clamp(-self.half, self.half), corner));
        }
        for i in 0..8 {
            let corner = self.local_corner(i);
            nearest.keep(ClosestPoints::new(corner, closest_on_triangle(corner, triangle).point));
            for bit in [1, 2, 4].into_iter().filter(|bit| i & bit == 0) {
                let of_box: Segment = [corner, self.local_corner(i | bit)];
                for of_triangle in edges(triangle) {
                    nearest.keep(closest_of_segments(of_box, of_triangle));
                }
            }
        }
        nearest
    }

    /// The deepest point of a triangle, in local coordinates, and its signed distance.
    ///
    /// Inside, the signed distance is the maximum of six linear functions. Its minimum over the triangle lies at a corner, on an
    /// edge where two of them agree, or where three agree.
    fn deepest(&self, triangle: &Triangle) -> (DVec3, f64) {
        let [a, b, c] = *triangle;
        let mut best = (a, self.local_distance(a));
        let mut offer = |v: f64, w: f64| {
            if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
                let point = a + (b - a) * v + (c - a) * w;
                let distance = self.local_distance(point);
                if distance < best.1 {
                    best = (point, distance);
                }
            }
        };
        offer(1.0, 0.0);
        offer(0.0, 1.0);
        // Face function `i` over the barycentric coordinates of `b` and `c`: its value at `a`, and its slopes.
        let face = |i: usize| {
            let sign = if i < 3 { 1.0 } else { -1.0 };
            let along = |p: DVec3| sign * p[i % 3];
            [along(a) - self.half[i % 3], along(b - a), along(c - a)]
        };
        let minus = |f: [f64; 3], g: [f64; 3]| [f[0] - g[0], f[1] - g[1], f[2] - g[2]];
        for i in 0..6 {
            for j in 0..i {
                let [at_a, by_v, by_w] = minus(face(i), face(j));
                offer(-at_a / by_v, 0.0);
                offer(0.0, -at_a / by_w);
                let w = (at_a + by_v) / (by_v - by_w);
                offer(1.0 - w, w);
                for k in 0..j {
                    let [other_a, other_v, other_w] = minus(face(i), face(k));
                    let turn = by_v * other_w - by_w * other_v;
                    offer(
                        (by_w * other_a - at_a * other_w) / turn,
                        (at_a * other_v - by_v * other_a) / turn,
                    );
                }
            }
        }
        best
    }
}
