//! Reference implementations for queries about one body.

use glam::DVec3;
use morph_collision_testkit::oracle;

pub(crate) use oracle::{point_distance as point_triangle, triangle_distance as triangles};

pub(crate) type Corners = [DVec3; 3];

pub(crate) fn at(barycentrics: [f64; 3], [a, b, c]: &Corners) -> DVec3 {
    *a * barycentrics[0] + *b * barycentrics[1] + *c * barycentrics[2]
}

/// Whether two triangles share a point, by the oracle. Pairs whose boxes are apart are skipped.
pub(crate) fn touch(a: &Corners, b: &Corners) -> bool {
    let span = |t: &Corners| (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
    let ((min_a, max_a), (min_b, max_b)) = (span(a), span(b));
    min_a.cmple(max_b).all() && min_b.cmple(max_a).all() && oracle::triangles_intersect(a, b)
}
