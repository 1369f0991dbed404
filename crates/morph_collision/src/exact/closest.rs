//! Closest points of a point and a triangle, in `f64`: a length is rounded, and says so.

use std::cmp::Ordering;

use glam::DVec3;

use super::Triangle;
use super::dyadic::Dyadic;
use super::number::{Number, difference, dot};

/// The point of a triangle that is closest to some point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnTriangle {
    /// Not negative, and 1 in sum up to rounding.
    pub(crate) barycentrics: [f64; 3],
    pub(crate) point: DVec3,
    /// The squared distance.
    pub(crate) squared: f64,
}

/// The closest point of a closed triangle, degenerate or not.
///
/// The distance is off by a few roundings of the largest distance between the four points; also for slivers, whose inside
/// is found exactly.
pub(crate) fn closest_on_triangle(point: DVec3, triangle: &Triangle) -> OnTriangle {
    let [a, b, c] = *triangle;
    let mut best = on_edge(point, a, b, 0);
    for (start, end, first) in [(b, c, 1), (c, a, 2)] {
        let other = on_edge(point, start, end, first);
        if other.squared < best.squared {
            best = other;
        }
    }
    if let Some([y, z]) = plane_coordinates((a, point), (a, b), (a, c), best.squared)
        && y >= 0.0
        && z >= 0.0
        && y + z <= 1.0
    {
        let (ab, ac) = (b - a, c - a);
        best = OnTriangle {
            barycentrics: [(1.0 - y - z).max(0.0), y, z],
            point: a + (ab * y + ac * z),
            squared: (point - a - ab * y - ac * z).length_squared(),
        };
    }
    best
}

/// The closest point of the edge from corner `first` to the next one.
fn on_edge(point: DVec3, start: DVec3, end: DVec3, first: usize) -> OnTriangle {
    let s = along_segment(point, start, end);
    let mut barycentrics = [0.0; 3];
    barycentrics[first] = 1.0 - s;
    barycentrics[(first + 1) % 3] = s;
    let on_edge = if s == 1.0 { end } else { start + (end - start) * s };
    let residual = if s == 1.0 {
        point - end
    } else {
        point - start - (end - start) * s
    };
    OnTriangle {
        barycentrics,
        point: on_edge,
        squared: residual.length_squared(),
    }
}

/// How far along a closed segment its point closest to `point` is, from 0 to 1.
pub(super) fn along_segment(point: DVec3, start: DVec3, end: DVec3) -> f64 {
    let edge = end - start;
    let length_squared = edge.length_squared();
    if length_squared > 0.0 {
        ((point - start).dot(edge) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// `[y, z]` such that `y u + z v` is the point closest to `r` in the plane of `u` and `v`, each given by where it starts and ends.
///
/// Vectors that span a small angle get exact arithmetic; `None` where they span none, or so small a one that the plane's
/// points within them are as far off as its edges are: `edges` is the squared distance of those.
pub(super) fn plane_coordinates(
    r: (DVec3, DVec3),
    u: (DVec3, DVec3),
    v: (DVec3, DVec3),
    edges: f64,
) -> Option<[f64; 2]> {
    let [from_r, along_u, along_v] = [r, u, v].map(|(from, to)| to - from);
    let normal = along_u.cross(along_v);
    let area = normal.length_squared();
    let (uu, vv) = (along_u.length_squared(), along_v.length_squared());
    // The squared sine of the angle decides how much rounding is magnified.
    if area > 1e-4 * (uu * vv) {
        let y = from_r.cross(along_v).dot(normal) / area;
        let z = along_u.cross(from_r).dot(normal) / area;
        return Some([y, z]);
    }
    // Edges and what lies between them are closer together than `sqrt(area / uu)`. The area may be nothing but rounding.
    let area_at_most = area + 1e-30 * (uu * vv);
    if area_at_most <= 1e-14 * (uu.min(vv) * edges) {
        return None;
    }
    exact_plane_coordinates(r, u, v)
}

/// Solves the two normal equations without rounding.
#[cold]
fn exact_plane_coordinates(r: (DVec3, DVec3), u: (DVec3, DVec3), v: (DVec3, DVec3)) -> Option<[f64; 2]> {
    let [r, u, v] = [r, u, v].map(|(from, to)| difference::<Dyadic>(to, from));
    let (uu, uv, vv) = (dot(&u, &u), dot(&u, &v), dot(&v, &v));
    let (ru, rv) = (dot(&r, &u), dot(&r, &v));
    let determinant = uu.times(&vv).minus(&uv.times(&uv));
    if determinant.order() != Ordering::Greater {
        return None;
    }
    let y = ru.times(&vv).minus(&rv.times(&uv)).over(&determinant);
    let z = rv.times(&uu).minus(&ru.times(&uv)).over(&determinant);
    (y.is_finite() && z.is_finite()).then_some([y, z])
}
