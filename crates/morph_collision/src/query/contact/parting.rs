//! How far a triangle must move to leave another.

use glam::{DVec2, DVec3};

use crate::exact::{Triangle, edges, largest};

/// The tolerance for a point on an edge, relative to the triangles' sizes. It can only increase the distance.
const TOLERANCE: f64 = 1e-12;

/// How far `a` can move along the unit vector `direction` before it leaves `b`, for triangles that intersect.
///
/// Projected along the direction, the height of `b` above `a` is linear over their common area. So its maximum is at a corner of one
/// triangle inside the other, or where edges cross. Swapping the triangles and negating the direction gives the same result bit for bit.
pub(super) fn parting_distance(a: &Triangle, b: &Triangle, direction: DVec3) -> f64 {
    let key = |t: &Triangle| t.map(|corner| corner.to_array());
    if key(b) < key(a) {
        return parting_distance(b, a, -direction);
    }
    let (x, y) = direction.any_orthonormal_pair();
    let origin = a[0];
    let project = |p: DVec3| {
        let p = p - origin;
        Projected {
            at: DVec2::new(p.dot(x), p.dot(y)),
            height: p.dot(direction),
        }
    };
    let (projected_a, projected_b) = (a.map(project), b.map(project));
    let projected = projected_a.iter().chain(&projected_b);
    let size = largest(projected.map(|projected| projected.at.length()));
    let mut farthest = 0.0_f64;
    for (corners, other, sign) in [(&projected_a, &projected_b, 1.0), (&projected_b, &projected_a, -1.0)] {
        for corner in corners {
            if let Some(height) = height_of_triangle(other, corner.at) {
                farthest = farthest.max(sign * (height - corner.height));
            }
        }
    }
    for edge_a in edges(&projected_a) {
        for edge_b in edges(&projected_b) {
            for (of_a, of_b) in common_heights(edge_a, edge_b, TOLERANCE * size) {
                farthest = farthest.max(of_b - of_a);
            }
        }
    }
    farthest
}

/// A point projected along a direction.
#[derive(Clone, Copy)]
struct Projected {
    at: DVec2,
    height: f64,
}

/// The height of a triangle over a projected point. `None` outside the triangle, or if the triangle is edge-on; its edges are tested
/// separately.
fn height_of_triangle(triangle: &[Projected; 3], at: DVec2) -> Option<f64> {
    let [a, b, c] = triangle.map(|corner| corner.at - at);
    let weights = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
    let area: f64 = weights.iter().sum();
    let size = (b - a).abs().max((c - a).abs()).max_element();
    if area.abs() <= TOLERANCE * size * size {
        return None;
    }
    let inside = weights.iter().all(|weight| weight / area >= -TOLERANCE);
    let height = |i: usize| weights[i] / area * triangle[i].height;
    inside.then(|| height(0) + height(1) + height(2))
}

/// The heights of two segments over the points where their projections cross, or where an end of one lies on the other.
fn common_heights(a: [Projected; 2], b: [Projected; 2], tolerance: f64) -> impl Iterator<Item = (f64, f64)> {
    let (along_a, along_b) = (a[1].at - a[0].at, b[1].at - b[0].at);
    let turn = along_a.perp_dot(along_b);
    let between = b[0].at - a[0].at;
    let (s, t) = (between.perp_dot(along_b) / turn, between.perp_dot(along_a) / turn);
    let crosses = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    let crossing = crosses.then(|| (height_at(a, s), height_at(b, t)));
    let ends_of_a = a.map(|end| height_over_end(b, end.at, tolerance).map(|height| (end.height, height)));
    let ends_of_b = b.map(|end| height_over_end(a, end.at, tolerance).map(|height| (height, end.height)));
    crossing
        .into_iter()
        .chain(ends_of_a.into_iter().flatten())
        .chain(ends_of_b.into_iter().flatten())
}

fn height_over_end(segment: [Projected; 2], at: DVec2, tolerance: f64) -> Option<f64> {
    let along = segment[1].at - segment[0].at;
    let t = ((at - segment[0].at).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let t = if t.is_nan() { 0.0 } else { t };
    let on = (segment[0].at + along * t).distance(at) <= tolerance;
    on.then(|| height_at(segment, t))
}

fn height_at(segment: [Projected; 2], t: f64) -> f64 {
    segment[0].height + (segment[1].height - segment[0].height) * t
}
