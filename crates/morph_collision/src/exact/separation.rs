//! Directions along which two triangles are certainly apart, in `f64` with an error bound.
//!
//! For what the filter leaves open, mostly because the plane of a triangle is uncertain: slivers, segments and points, of which
//! collapsed meshes consist, and triangles in one plane.

use glam::DVec3;

use super::number::UNIT_ROUNDOFF;
use super::segment::edges;
use super::triangle::Triangle;

/// The error bound of a scalar product of a direction and a rounded difference, relative to the sum of its terms' absolute
/// values. Each term is rounded at most four times: in the difference, the product and two sums. Adding the bound rounds once
/// more. The rest covers the roundings of the bound itself and second-order terms.
const RELATIVE: f64 = 8.0 * UNIT_ROUNDOFF;

/// Whether two triangles are certainly apart. `false` proves nothing.
///
/// A direction counts as the vector of its rounded coordinates, so which ones are tried affects only how many pairs are decided:
/// the common perpendicular of the longest edges; the perpendicular from the longer one, moved to a corner of `a`, to a corner of
/// `b`; and the perpendiculars of all edges in the planes of their triangles, for triangles in one plane. Cost: at most eight
/// directions, six scalar products each.
pub(super) fn certainly_apart(a: &Triangle, b: &Triangle) -> bool {
    let [edges_a, edges_b] = [a, b].map(|triangle| edges(triangle).map(|[from, to]| to - from));
    let [along_a, along_b] = [edges_a, edges_b].map(longest);
    let (along, to_b) = (longer(along_a, along_b), b[0] - a[0]);
    let aside = if along == DVec3::ZERO {
        to_b
    } else {
        to_b - along * (to_b.dot(along) / along.length_squared())
    };
    let differences = [a, b].map(|triangle| triangle.map(|corner| corner - a[0]));
    let separates = |direction| separates(direction, &differences);
    let in_plane = |edges: [DVec3; 3]| {
        let normal = edges[0].cross(edges[1]);
        edges.into_iter().any(|edge| separates(edge.cross(normal)))
    };
    separates(along_a.cross(along_b)) || separates(aside) || in_plane(edges_a) || in_plane(edges_b)
}

fn longest([a, b, c]: [DVec3; 3]) -> DVec3 {
    longer(longer(a, b), c)
}

fn longer(p: DVec3, q: DVec3) -> DVec3 {
    if p.length_squared() < q.length_squared() { q } else { p }
}

/// Whether one triangle is certainly farther along a direction than the other. Corners are differences from a common point.
fn separates(direction: DVec3, [a, b]: &[Triangle; 2]) -> bool {
    let ([low_a, high_a], [low_b, high_b]) = (extent(direction, a), extent(direction, b));
    high_a < low_b || high_b < low_a
}

/// The least and the largest place along a direction, with their errors. Unlimited if one of them is not finite.
fn extent(direction: DVec3, corners: &Triangle) -> [f64; 2] {
    let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
    for corner in corners {
        let terms = direction * corner;
        let place = terms.x + terms.y + terms.z;
        // The smallest normal number exceeds all underflow.
        let error = (terms.x.abs() + terms.y.abs() + terms.z.abs()) * RELATIVE + f64::MIN_POSITIVE;
        let [low, high] = [place - error, place + error];
        if !(low.is_finite() && high.is_finite()) {
            return [f64::NEG_INFINITY, f64::INFINITY];
        }
        extent = [extent[0].min(low), extent[1].max(high)];
    }
    extent
}
