//! Closest points of points, segments and triangles, in `f64`.
//!
//! Returned points lie on their segment or triangle. A distance is too large by at most a few roundings of the coordinates, for
//! segments and triangles of any shape.

use glam::DVec3;

use super::dyadic::Dyadic;
use super::intersection::triangles_intersect;
use super::number::{Number, difference, dot};
use super::segment::{Segment, edges};
use super::triangle::Triangle;

/// The point of a triangle that is closest to a given point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrianglePoint {
    /// Not negative; their sum is 1 up to rounding.
    pub(crate) barycentrics: [f64; 3],
    pub(crate) point: DVec3,
    /// The squared distance.
    pub(crate) squared: f64,
}

/// A pair of points on two sets, `a` and `b`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosestPoints {
    pub(crate) on_a: DVec3,
    pub(crate) on_b: DVec3,
    /// The squared distance.
    pub(crate) squared: f64,
}

impl ClosestPoints {
    /// A placeholder that is farther apart than any two points.
    pub(crate) const NONE: Self = Self {
        on_a: DVec3::ZERO,
        on_b: DVec3::ZERO,
        squared: f64::INFINITY,
    };

    pub(crate) fn new(on_a: DVec3, on_b: DVec3) -> Self {
        let squared = on_a.distance_squared(on_b);
        Self { on_a, on_b, squared }
    }

    /// Replaces this pair with another if that is closer.
    pub(crate) fn keep(&mut self, other: Self) {
        if other.squared < self.squared {
            *self = other;
        }
    }
}

/// Like [`closest_on_triangle`], but the distance is 0 if and only if the point is on the triangle.
pub(crate) fn closest_on_triangle_exactly(point: DVec3, triangle: &Triangle) -> TrianglePoint {
    // The error of a distance is far below a trillionth of the distance to the farthest corner.
    const NEAR: f64 = 1e-24;
    let foot = closest_on_triangle(point, triangle);
    let size = triangle
        .iter()
        .fold(0.0, |size, corner| corner.distance_squared(point).max(size));
    let is_on_triangle = foot.squared <= NEAR * size && triangles_intersect(triangle, &[point; 3]);
    let (point, squared) = if is_on_triangle {
        (point, 0.0)
    } else {
        (foot.point, foot.squared.max(f64::MIN_POSITIVE))
    };
    TrianglePoint { point, squared, ..foot }
}

/// The closest point of a closed triangle, which may be degenerate.
///
/// The error of the distance is a few roundings of the largest distance between the four points. This holds for slivers too,
/// because the foot on their plane is computed in exact arithmetic.
pub(crate) fn closest_on_triangle(point: DVec3, triangle: &Triangle) -> TrianglePoint {
    let [a, b, c] = *triangle;
    let edges_squared = || closest_on_edges(point, triangle).squared;
    // First, because then nothing else is needed for points over the triangle, like those that a ray hits.
    if let Some([y, z]) = plane_coordinates([a, point], [a, b], [a, c], edges_squared)
        && y >= 0.0
        && z >= 0.0
        && y + z <= 1.0
    {
        let (ab, ac) = (b - a, c - a);
        return TrianglePoint {
            barycentrics: [(1.0 - y - z).max(0.0), y, z],
            point: a + (ab * y + ac * z),
            squared: (point - a - ab * y - ac * z).length_squared(),
        };
    }
    closest_on_edges(point, triangle)
}

/// The closest point of a triangle's edges.
#[inline(never)]
fn closest_on_edges(point: DVec3, &[a, b, c]: &Triangle) -> TrianglePoint {
    let mut best = closest_on_edge(point, [a, b], 0);
    for (edge, first) in [([b, c], 1), ([c, a], 2)] {
        let other = closest_on_edge(point, edge, first);
        if other.squared < best.squared {
            best = other;
        }
    }
    best
}

/// The closest point of a triangle's edge; `first` is the number of the corner where the edge starts.
fn closest_on_edge(point: DVec3, [start, end]: Segment, first: usize) -> TrianglePoint {
    let t = closest_parameter(point, [start, end]);
    let mut barycentrics = [0.0; 3];
    barycentrics[first] = 1.0 - t;
    barycentrics[(first + 1) % 3] = t;
    // The residual is not computed from the rounded point, which would lose accuracy near the edge.
    let (on_edge, residual) = if t == 1.0 {
        (end, point - end)
    } else {
        let along = (end - start) * t;
        (start + along, point - start - along)
    };
    TrianglePoint {
        barycentrics,
        point: on_edge,
        squared: residual.length_squared(),
    }
}

/// The parameter, from 0 to 1, of the point of a closed segment that is closest to `point`.
fn closest_parameter(point: DVec3, [start, end]: Segment) -> f64 {
    let edge = end - start;
    let length_squared = edge.length_squared();
    if length_squared > 0.0 {
        ((point - start).dot(edge) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// The point of a closed segment closest to `point`.
pub(crate) fn closest_on_segment(point: DVec3, segment: Segment) -> DVec3 {
    lerp(segment, closest_parameter(point, segment))
}

/// The point of a segment at `t` in 0..=1, computed from the nearer end.
pub(super) fn lerp([p, q]: Segment, t: f64) -> DVec3 {
    if t <= 0.5 {
        p + (q - p) * t
    } else {
        q + (p - q) * (1.0 - t)
    }
}

/// `[y, z]` such that `y u + z v` is the point closest to `r` in the plane of `u` and `v`. Each vector is given by its ends.
///
/// Uses exact arithmetic if the angle between `u` and `v` is small. `None` if they span no plane, or if the angle is so small that
/// no point between the edges can be closer than the nearer edge, whose squared distance is `edges_squared`.
fn plane_coordinates(r: Segment, u: Segment, v: Segment, edges_squared: impl FnOnce() -> f64) -> Option<[f64; 2]> {
    // The squared sine of the angle, which determines how much rounding errors are magnified. Above this bound, they cost at most
    // four digits. Not measured; exact arithmetic is rare with it.
    const SMALL_ANGLE: f64 = 1e-4;
    // Improvements below `1e-14` of a squared distance are rounding error.
    const NO_CLOSER: f64 = 1e-14;
    let [from_r, along_u, along_v] = [r, u, v].map(|[from, to]| to - from);
    let normal = along_u.cross(along_v);
    let area = normal.length_squared();
    let (uu, vv) = (along_u.length_squared(), along_v.length_squared());
    if area > SMALL_ANGLE * (uu * vv) {
        let y = from_r.cross(along_v).dot(normal) / area;
        let z = along_u.cross(from_r).dot(normal) / area;
        return Some([y, z]);
    }
    // Points between the edges are within `sqrt(area / uu)` of them. The second term is there because the area may be pure
    // rounding error.
    let max_area = area + 1e-30 * (uu * vv);
    if max_area <= NO_CLOSER * (uu.min(vv) * edges_squared()) {
        return None;
    }
    exact_plane_coordinates(r, u, v)
}

/// Solves the two normal equations without rounding.
#[cold]
fn exact_plane_coordinates(r: Segment, u: Segment, v: Segment) -> Option<[f64; 2]> {
    let [r, u, v] = [r, u, v].map(|[from, to]| difference::<Dyadic>(to, from));
    let (uu, uv, vv) = (dot(&u, &u), dot(&u, &v), dot(&v, &v));
    let (ru, rv) = (dot(&r, &u), dot(&r, &v));
    let determinant = uu.times(&vv).minus(&uv.times(&uv));
    if !determinant.order().is_gt() {
        return None;
    }
    let y = ru.times(&vv).minus(&rv.times(&uv)).over(&determinant);
    let z = rv.times(&uu).minus(&ru.times(&uv)).over(&determinant);
    (y.is_finite() && z.is_finite()).then_some([y, z])
}

/// The closest points of two segments.
pub(crate) fn closest_of_segments(s: Segment, t: Segment) -> ClosestPoints {
    let mut best = ClosestPoints::NONE;
    for p in s {
        best.keep(ClosestPoints::new(p, closest_on_segment(p, t)));
    }
    for q in t {
        best.keep(ClosestPoints::new(closest_on_segment(q, s), q));
    }
    // The points where the lines are closest, by Cramer's rule, if the first one is inside its segment.
    let (d, e, r) = (s[1] - s[0], t[1] - t[0], t[0] - s[0]);
    let (dd, de, ee) = (d.length_squared(), d.dot(e), e.length_squared());
    let along = (r.dot(d) * ee - r.dot(e) * de) / (dd * ee - de * de);
    if along > 0.0 && along < 1.0 {
        let q = closest_on_segment(lerp(s, along), t);
        best.keep(ClosestPoints::new(closest_on_segment(q, s), q));
    }
    best
}

/// The closest points of a segment and a triangle that does not cross it.
pub(crate) fn closest_of_segment_and_triangle(segment: Segment, triangle: &Triangle) -> ClosestPoints {
    let at_end = |p| ClosestPoints::new(p, closest_on_triangle(p, triangle).point);
    let mut best = at_end(segment[0]);
    if segment[0] != segment[1] {
        best.keep(at_end(segment[1]));
        for edge in edges(triangle) {
            best.keep(closest_of_segments(segment, edge));
        }
    }
    best
}

/// The closest points of two closed triangles, which may be degenerate.
///
/// The squared distance is 0 if and only if the triangles share a point. The error of the points, and of a distance other than
/// 0, is a few roundings of the largest distance between the six corners. Disjoint triangles are closest at a corner of one or at
/// an edge of each.
pub(crate) fn closest_of_triangles(a: &Triangle, b: &Triangle) -> ClosestPoints {
    let intersect = triangles_intersect(a, b);
    let mut best = ClosestPoints::NONE;
    let from_a = |on_a| {
        let foot = closest_on_triangle(on_a, b);
        let (on_b, squared) = (foot.point, foot.squared);
        ClosestPoints { on_a, on_b, squared }
    };
    let from_b = |on_b| {
        let foot = closest_on_triangle(on_b, a);
        let (on_a, squared) = (foot.point, foot.squared);
        ClosestPoints { on_a, on_b, squared }
    };
    a.iter().for_each(|&corner| best.keep(from_a(corner)));
    b.iter().for_each(|&corner| best.keep(from_b(corner)));
    let (edges_a, edges_b) = (edges(a), edges(b));
    if intersect {
        for (&edge_a, &edge_b) in edges_a.iter().zip(&edges_b) {
            best.keep(plane_crossing(edge_a, b).map_or(ClosestPoints::NONE, from_a));
            best.keep(plane_crossing(edge_b, a).map_or(ClosestPoints::NONE, from_b));
        }
    }
    for &edge_a in &edges_a {
        for &edge_b in &edges_b {
            if let Some(inside) = closest_inside_segments(edge_a, edge_b, best.squared) {
                best.keep(inside);
            }
        }
    }
    best.squared = if intersect {
        0.0
    } else {
        best.squared.max(f64::MIN_POSITIVE)
    };
    best
}

/// The distance of two closed triangles, which may be degenerate.
///
/// It is 0 if and only if they share a point. Otherwise its error is a few roundings of the largest distance between the six corners.
#[must_use]
pub fn triangle_distance(a: &Triangle, b: &Triangle) -> f64 {
    closest_of_triangles(a, b).squared.sqrt()
}

/// The point of a segment closest to where its line crosses a triangle's plane; `None` if the line and the plane are parallel.
fn plane_crossing([p, q]: Segment, &[a, b, c]: &Triangle) -> Option<DVec3> {
    let normal = (b - a).cross(c - a);
    let t = normal.dot(a - p) / normal.dot(q - p);
    t.is_finite().then(|| p + (q - p) * t.clamp(0.0, 1.0))
}

/// The closest points of two segments if neither is an end. Callers check the corners first; `corners_squared` is the smallest
/// squared distance found so far.
fn closest_inside_segments([p, q]: Segment, [r, s]: Segment, corners_squared: f64) -> Option<ClosestPoints> {
    let [x, y] = parameters_inside([p, q], [r, s], corners_squared)?;
    Some(ClosestPoints {
        on_a: p + (q - p) * x,
        on_b: r + (s - r) * y,
        squared: ((r - p) - (q - p) * x + (s - r) * y).length_squared(),
    })
}

/// The parameters of the closest points of two segments if neither is an end.
fn parameters_inside([p, q]: Segment, [r, s]: Segment, corners_squared: f64) -> Option<[f64; 2]> {
    let inside = plane_coordinates([p, r], [p, q], [s, r], || corners_squared)?;
    inside.iter().all(|at| (0.0..=1.0).contains(at)).then_some(inside)
}

/// The parameters, from 0 to 1, of the closest points of two segments, which may be points. As accurate as [`closest_of_triangles`].
pub(super) fn closest_parameters([p, q]: Segment, [r, s]: Segment) -> [f64; 2] {
    let squared = |[x, y]: [f64; 2]| ((r - p) - (q - p) * x + (s - r) * y).length_squared();
    let of_a = [(0.0, p), (1.0, q)].map(|(x, end)| [x, closest_parameter(end, [r, s])]);
    let of_b = [(0.0, r), (1.0, s)].map(|(y, end)| [closest_parameter(end, [p, q]), y]);
    let nearer = |x: [f64; 2], y: [f64; 2]| if squared(y) < squared(x) { y } else { x };
    let ends = nearer(nearer(of_a[0], of_a[1]), nearer(of_b[0], of_b[1]));
    parameters_inside([p, q], [r, s], squared(ends)).map_or(ends, |inside| nearer(ends, inside))
}
