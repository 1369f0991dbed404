//! Closest points of two triangles, in `f64`.

use glam::DVec3;

use super::closest::{closest_on_triangle, plane_coordinates};
use super::{Triangle, triangles_intersect};

/// A closest pair of points of two triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Between {
    pub(crate) on_a: DVec3,
    pub(crate) on_b: DVec3,
    /// The squared distance: 0 if and only if the triangles share a point.
    pub(crate) squared: f64,
}

/// Closest points of two closed triangles, degenerate or not.
///
/// Whether they share a point is exact; the points, and a distance that is not 0, are off by a few roundings of the largest
/// distance between the six corners. Triangles apart are closest at a corner of one, or at two edges.
pub(crate) fn closest_between(a: &Triangle, b: &Triangle) -> Between {
    let meet = boxes_overlap(a, b) && triangles_intersect(a, b);
    let mut best = Between {
        on_a: a[0],
        on_b: b[0],
        squared: f64::INFINITY,
    };
    let mut offer = |on_a, on_b, squared| {
        if squared < best.squared {
            best = Between { on_a, on_b, squared };
        }
    };
    for &corner in a {
        let foot = closest_on_triangle(corner, b);
        offer(corner, foot.point, foot.squared);
    }
    for &corner in b {
        let foot = closest_on_triangle(corner, a);
        offer(foot.point, corner, foot.squared);
    }
    let edges = [(0, 1), (1, 2), (2, 0)];
    if meet {
        for (i, j) in edges {
            if let Some(point) = pierce(a[i], a[j], b) {
                let foot = closest_on_triangle(point, b);
                offer(point, foot.point, foot.squared);
            }
            if let Some(point) = pierce(b[i], b[j], a) {
                let foot = closest_on_triangle(point, a);
                offer(foot.point, point, foot.squared);
            }
        }
    }
    for (i, j) in edges {
        for (k, l) in edges {
            if let Some(inside) = inside_segments([a[i], a[j]], [b[k], b[l]], best.squared)
                && inside.squared < best.squared
            {
                best = inside;
            }
        }
    }
    best.squared = if meet { 0.0 } else { best.squared.max(f64::MIN_POSITIVE) };
    best
}

fn boxes_overlap(a: &Triangle, b: &Triangle) -> bool {
    let span = |t: &Triangle| (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
    let ((min_a, max_a), (min_b, max_b)) = (span(a), span(b));
    min_a.cmple(max_b).all() && min_b.cmple(max_a).all()
}

/// Where a segment comes closest to crossing a triangle's plane.
fn pierce(p: DVec3, q: DVec3, triangle: &Triangle) -> Option<DVec3> {
    let [a, b, c] = *triangle;
    let normal = (b - a).cross(c - a);
    let s = normal.dot(a - p) / normal.dot(q - p);
    s.is_finite().then(|| p + (q - p) * s.clamp(0.0, 1.0))
}

/// Closest points of two segments where neither is an end; what is closest at an end is left to the corners, which are
/// `corners` away, squared.
fn inside_segments([p, q]: [DVec3; 2], [r, s]: [DVec3; 2], corners: f64) -> Option<Between> {
    let [x, y] = plane_coordinates((p, r), (p, q), (s, r), corners)?;
    let inside = (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y);
    inside.then(|| Between {
        on_a: p + (q - p) * x,
        on_b: r + (s - r) * y,
        squared: ((r - p) - (q - p) * x + (s - r) * y).length_squared(),
    })
}
