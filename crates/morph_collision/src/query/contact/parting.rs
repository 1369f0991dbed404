use glam::{DVec2, DVec3};

use crate::exact::{Triangle, edges};

/// What counts as on an edge, as a share of the triangles' sizes: a farther parting is then found rather than missed.
const TOLERANCE: f64 = 1e-12;

/// How far `a` can be moved along the unit vector `direction` and still share a point with `b`, for triangles that
/// intersect; `f64`.
///
/// Seen along the direction, `b` lies above `a` by a height that is linear over what both have in common; so it is largest
/// over a corner of one inside the other, or where edges cross. Exchanging the triangles and turning the direction round
/// gives the same number, bit for bit.
pub(super) fn parting_distance(a: &Triangle, b: &Triangle, direction: DVec3) -> f64 {
    let key = |t: &Triangle| t.map(|corner| corner.to_array());
    if key(b) < key(a) {
        return parting_distance(b, a, -direction);
    }
    let (x, y) = direction.any_orthonormal_pair();
    let origin = a[0];
    let see = |p: DVec3| {
        let p = p - origin;
        Seen {
            place: DVec2::new(p.dot(x), p.dot(y)),
            height: p.dot(direction),
        }
    };
    let (seen_a, seen_b) = (a.map(see), b.map(see));
    let size = seen_a
        .iter()
        .chain(&seen_b)
        .map(|seen| seen.place.length())
        .fold(0.0, f64::max);
    let mut farthest = 0.0_f64;
    for corner in seen_a {
        if let Some(height) = height_of_triangle(&seen_b, corner.place) {
            farthest = farthest.max(height - corner.height);
        }
    }
    for corner in seen_b {
        if let Some(height) = height_of_triangle(&seen_a, corner.place) {
            farthest = farthest.max(corner.height - height);
        }
    }
    for edge_a in edges(a) {
        for edge_b in edges(b) {
            let (edge_a, edge_b) = (edge_a.map(see), edge_b.map(see));
            for (of_a, of_b) in common_places(edge_a, edge_b, TOLERANCE * size) {
                farthest = farthest.max(of_b - of_a);
            }
        }
    }
    farthest
}

/// A point as seen along a direction.
#[derive(Clone, Copy)]
struct Seen {
    place: DVec2,
    height: f64,
}

/// The height of a triangle over a place; `None` beside it, or where it is seen from its edge, whose sides then count.
fn height_of_triangle(triangle: &[Seen; 3], place: DVec2) -> Option<f64> {
    let [a, b, c] = triangle.map(|corner| corner.place - place);
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

/// The heights of two segments over the places where they cross, or where one's end lies on the other.
fn common_places(a: [Seen; 2], b: [Seen; 2], tolerance: f64) -> impl Iterator<Item = (f64, f64)> {
    let (along_a, along_b) = (a[1].place - a[0].place, b[1].place - b[0].place);
    let turn = along_a.perp_dot(along_b);
    let between = b[0].place - a[0].place;
    let (s, t) = (between.perp_dot(along_b) / turn, between.perp_dot(along_a) / turn);
    let crosses = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    let crossing = crosses.then(|| (height_at(a, s), height_at(b, t)));
    let ends_of_a = a.map(|end| height_over_end(b, end.place, tolerance).map(|height| (end.height, height)));
    let ends_of_b = b.map(|end| height_over_end(a, end.place, tolerance).map(|height| (height, end.height)));
    crossing
        .into_iter()
        .chain(ends_of_a.into_iter().flatten())
        .chain(ends_of_b.into_iter().flatten())
}

fn height_over_end(segment: [Seen; 2], place: DVec2, tolerance: f64) -> Option<f64> {
    let along = segment[1].place - segment[0].place;
    let t = ((place - segment[0].place).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let t = if t.is_nan() { 0.0 } else { t };
    let on = (segment[0].place + along * t).distance(place) <= tolerance;
    on.then(|| height_at(segment, t))
}

fn height_at(segment: [Seen; 2], t: f64) -> f64 {
    segment[0].height + (segment[1].height - segment[0].height) * t
}
