//! Closest points of convex cores for which there is no formula.
//!
//! Apart, they are found from support points. If they intersect, the deepest point is the minimum of a convex function.

use glam::{DMat3, DVec3};

use super::super::closest::Closest;
use super::deepest::{Deepest, deepest};
use super::separation::separation;
use crate::exact::{Triangle, edges, largest, unit_normal};

/// A convex set in world space.
pub(super) trait Convex {
    /// The point farthest along a direction.
    fn support_point(&self, direction: DVec3) -> DVec3;

    /// A convex function that is the signed distance inside, and outside positive and not more than the distance; with its gradient, a unit
    /// vector.
    fn depth(&self, point: DVec3) -> (f64, DVec3);
}

/// Depths are too small by at most this, relative to the size of the triangle.
const TRIANGLE_DEPTH_ERROR: f64 = 1e-11;
/// The same for two cores.
const CORE_DEPTH_ERROR: f64 = 1e-10;
/// At least this, relative to the coordinates: more than the rounding errors of a depth.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The point of a triangle with the smallest signed distance from a core.
pub(super) fn closest_of_triangle(core: &impl Convex, core_reach: f64, triangle: &Triangle) -> Closest {
    let depths = triangle.map(|corner| core.depth(corner));
    let lowest = (0..3).min_by(|&i, &j| depths[i].0.total_cmp(&depths[j].0)).unwrap_or(0);
    let (depth, normal) = depths[lowest];
    let corner = triangle[lowest];
    let size = largest(triangle.iter().map(|other| other.distance(corner)));
    let reach = largest(triangle.iter().map(|corner| corner.abs().max_element()));
    if depth <= 0.0 {
        // Where no other corner lies against the gradient of a convex function, it is smallest.
        let is_lowest = triangle
            .iter()
            .all(|other| normal.dot(other - corner) >= -f64::EPSILON * size);
        if is_lowest {
            return Closest {
                point: corner,
                normal,
                distance: depth,
            };
        }
    } else if let Some(apart) = separation(
        |direction| core.support_point(direction),
        |direction| support_point(triangle, direction),
        normal,
    ) {
        return Closest {
            point: apart.on_b,
            normal: apart.normal,
            distance: apart.distance,
        };
    }
    // An ellipse through the corners, around their mean.
    let mean = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
    let (u, v) = (triangle[0] - mean, (triangle[1] - triangle[2]) / 3.0_f64.sqrt());
    let beyond_edges = outside_of_triangle(triangle);
    let found = Deepest {
        center: mean,
        axes: DMat3::from_cols(u, v, DVec3::ZERO),
        tolerance: (TRIANGLE_DEPTH_ERROR * size).max(ROUNDING * (reach + core_reach)),
    };
    let found = deepest(&found, beyond_edges, |point| core.depth(point));
    // A corner may be the only point that is inside, by rounding.
    let (point, normal, distance) = if found.distance < depth {
        (found.point, found.normal, found.distance)
    } else {
        (corner, normal, depth)
    };
    Closest {
        point,
        normal,
        distance: distance.min(0.0),
    }
}

/// The point of another core with the smallest signed distance from a core. They come with balls around them, and the largest coordinate.
pub(super) fn closest_of_convex(
    core: &impl Convex,
    other: &impl Convex,
    [(core_center, _), (center, radius)]: [(DVec3, f64); 2],
    reach: f64,
) -> Closest {
    let toward = center - core_center;
    let apart = separation(
        |direction| core.support_point(direction),
        |direction| other.support_point(direction),
        toward,
    );
    if let Some(apart) = apart {
        return Closest {
            point: apart.on_b,
            normal: apart.normal,
            distance: apart.distance,
        };
    }
    let start = Deepest {
        center,
        axes: DMat3::from_diagonal(DVec3::splat(radius)),
        tolerance: (CORE_DEPTH_ERROR * radius).max(ROUNDING * reach),
    };
    let beyond_other = |point: DVec3| other.depth(point);
    let found = deepest(&start, beyond_other, |point| core.depth(point));
    let (point, normal, distance) = if found.distance.is_finite() {
        (found.point, found.normal, found.distance)
    } else {
        // By rounding, no point was inside.
        let (depth, normal) = core.depth(center);
        (center, normal, depth)
    };
    Closest {
        point,
        normal,
        distance: distance.min(0.0),
    }
}

fn support_point(triangle: &Triangle, direction: DVec3) -> DVec3 {
    let [a, b, c] = triangle.map(|corner| direction.dot(corner));
    if a >= b && a >= c {
        triangle[0]
    } else if b >= c {
        triangle[1]
    } else {
        triangle[2]
    }
}

/// How far a point in a triangle's plane is beyond one of its edges, or an end of the longest, and the direction out. At most 0 inside.
///
/// The ends follow from the edges, but not to many digits if the triangle is thin.
fn outside_of_triangle(triangle: &Triangle) -> impl Fn(DVec3) -> (f64, DVec3) {
    let all = edges(triangle);
    let squared = |[p, q]: &[DVec3; 2]| p.distance_squared(*q);
    let longest = all.into_iter().max_by(|s, t| squared(s).total_cmp(&squared(t)));
    let [p, q] = longest.unwrap_or(all[0]);
    let along = (q - p).normalize_or_zero();
    let normal = unit_normal(triangle);
    let [a, b, c] = all.map(|[p, q]| (p, (q - p).normalize_or_zero().cross(normal).normalize_or_zero()));
    let limits = [a, b, c, (q, along), (p, -along)];
    move |point| {
        let mut farthest = (0.0, along);
        for (on_border, out) in limits {
            let beyond = out.dot(point - on_border);
            if beyond > farthest.0 {
                farthest = (beyond, out);
            }
        }
        farthest
    }
}
