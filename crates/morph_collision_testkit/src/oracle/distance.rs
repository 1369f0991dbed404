//! Distances by the textbook formulas (Ericson 2005, Sect. 5.1) in plain `f64`.

use glam::DVec3;

/// The distance of a point and a segment.
fn point_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (ab, ap) = (b - a, p - a);
    let along = ap.dot(ab);
    let squared = ab.dot(ab);
    if along <= 0.0 || squared == 0.0 {
        ap.length()
    } else if along >= squared {
        (p - b).length()
    } else {
        (ap - ab * (along / squared)).length()
    }
}

/// The distance of a point and a triangle, in the unit of their coordinates. The error grows with the size of the coordinates and
/// with the thinness of the triangle.
#[must_use]
pub fn point_distance(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> f64 {
    let edges = point_segment(p, a, b)
        .min(point_segment(p, b, c))
        .min(point_segment(p, c, a));
    let (ab, ac, ap) = (b - a, c - a, p - a);
    // Areas along the normal, which are more robust for slivers than products of lengths.
    let normal = ab.cross(ac);
    let (vb, vc) = (ap.cross(ac).dot(normal), ab.cross(ap).dot(normal));
    let va = normal.dot(normal) - vb - vc;
    let sum = va + vb + vc;
    if va > 0.0 && vb > 0.0 && vc > 0.0 && sum > 0.0 {
        edges.min((ap - ab * (vb / sum) - ac * (vc / sum)).length())
    } else {
        edges
    }
}

/// The distance of two segments.
fn segments(p1: DVec3, q1: DVec3, p2: DVec3, q2: DVec3) -> f64 {
    let ends = point_segment(p1, p2, q2)
        .min(point_segment(q1, p2, q2))
        .min(point_segment(p2, p1, q1))
        .min(point_segment(q2, p1, q1));
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, b, c, f) = (d1.dot(d1), d2.dot(d2), d1.dot(d2), d1.dot(r), d2.dot(r));
    let determinant = a * e - b * b;
    let (s, t) = ((b * f - c * e) / determinant, (a * f - b * c) / determinant);
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        ends.min((r + d1 * s - d2 * t).length())
    } else {
        ends
    }
}

/// The distance of two triangles that share no point, with the same kind of error as [`point_distance`].
#[must_use]
pub fn triangle_distance(a: &[DVec3; 3], b: &[DVec3; 3]) -> f64 {
    let mut least = f64::INFINITY;
    for i in 0..3 {
        least = least.min(point_distance(a[i], b)).min(point_distance(b[i], a));
        for j in 0..3 {
            least = least.min(segments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
        }
    }
    least
}
