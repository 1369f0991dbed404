//! Do two closed triangles share a point? Decided in integers, from the definition of a convex hull.
//!
//! The hulls of `a_0 a_1 a_2` and `b_0 b_1 b_2` share a point iff the origin lies in the hull of the nine differences
//! `a_i - b_j` (their Minkowski difference). By Caratheodory's theorem, this holds iff it lies in the hull of an affinely
//! independent subset of one to four of them: a point, a segment, a triangle or a tetrahedron. Degenerate triangles and
//! coplanar pairs are not special cases.
//!
//! Searching 255 subsets is slow, so pairs that some plane separates are rejected first. A strictly separating direction
//! proves that the hulls are apart, however it was found, so the choice of directions to try affects only the speed.

use std::array::from_fn;
use std::cmp::Ordering;

use glam::DVec3;
use num_bigint::{BigInt, Sign};

use super::dyadic::mantissa_and_exponent;

/// A vector of integers.
type Vector = [BigInt; 3];

/// Whether two closed triangles, given by their `f64` vertices, share at least one point; exact.
///
/// Touching counts. A triangle may be degenerate: a segment or a point. A triangle with a coordinate that is not finite is
/// not a set of points and intersects nothing.
pub fn triangles_intersect(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    if a.iter().chain(b).any(|vertex| !vertex.is_finite()) {
        return false;
    }
    let (a, b) = to_integers(a, b);
    !separated(&a, &b) && hulls_meet(&a, &b)
}

/// The side of a triangle's plane on which a point lies; `Greater` if the triangle is anticlockwise seen from the point. Exact.
///
/// # Panics
/// If a coordinate is not finite.
pub fn plane_side(triangle: &[DVec3; 3], point: DVec3) -> Ordering {
    assert!(triangle.iter().chain([&point]).all(|vertex| vertex.is_finite()));
    let ([a, b, c], [p, ..]) = to_integers(triangle, &[point; 3]);
    let normal = cross(&subtract(&b, &a), &subtract(&c, &a));
    dot(&normal, &subtract(&p, &a)).cmp(&BigInt::ZERO)
}

/// The vertices of both triangles as whole multiples of the same power of two.
fn to_integers(a: &[DVec3; 3], b: &[DVec3; 3]) -> ([Vector; 3], [Vector; 3]) {
    let unit = a
        .iter()
        .chain(b)
        .flat_map(DVec3::to_array)
        .filter(|coordinate| *coordinate != 0.0)
        .map(|coordinate| mantissa_and_exponent(coordinate).1)
        .min()
        .unwrap_or(0);
    let integer = |coordinate: f64| {
        let (mantissa, exponent) = mantissa_and_exponent(coordinate);
        BigInt::from(mantissa) << (exponent - unit).max(0) // a negative difference belongs to a zero
    };
    let convert = |vertices: &[DVec3; 3]| vertices.map(|vertex| vertex.to_array().map(integer));
    (convert(a), convert(b))
}

/// Whether one of the directions tried strictly separates the triangles. `false` proves nothing.
///
/// It tries both normals, all cross products of an edge of `a` and one of `b`, and the in-plane normals of all edges.
fn separated(a: &[Vector; 3], b: &[Vector; 3]) -> bool {
    let (edges_a, edges_b) = (edges(a), edges(b));
    let normals = [cross(&edges_a[0], &edges_a[1]), cross(&edges_b[0], &edges_b[1])];
    if normals.iter().any(|normal| separates(normal, a, b)) {
        return true;
    }
    let between_edges = edges_a
        .iter()
        .flat_map(|edge_a| edges_b.iter().map(move |edge_b| cross(edge_a, edge_b)));
    let in_plane = [(&edges_a, &normals[0]), (&edges_b, &normals[1])]
        .into_iter()
        .flat_map(|(edges, normal)| edges.iter().map(move |edge| cross(edge, normal)));
    between_edges
        .chain(in_plane)
        .any(|direction| separates(&direction, a, b))
}

/// Whether all of one triangle lies strictly farther along `direction` than all of the other.
fn separates(direction: &Vector, a: &[Vector; 3], b: &[Vector; 3]) -> bool {
    let along_a: [BigInt; 3] = from_fn(|i| dot(direction, &a[i]));
    let along_b: [BigInt; 3] = from_fn(|i| dot(direction, &b[i]));
    along_a.iter().max() < along_b.iter().min() || along_b.iter().max() < along_a.iter().min()
}

/// Whether the origin lies in the hull of one to four affinely independent differences `a_i - b_j`.
fn hulls_meet(a: &[Vector; 3], b: &[Vector; 3]) -> bool {
    let differences: [Vector; 9] = from_fn(|k| subtract(&a[k / 3], &b[k % 3]));
    let d = &differences;
    (0..9).any(|i| {
        is_zero(&d[i])
            || (0..i).any(|j| {
                in_segment(&d[i], &d[j])
                    || (0..j).any(|k| {
                        in_triangle(&d[i], &d[j], &d[k]) || (0..k).any(|l| in_tetrahedron(&d[i], &d[j], &d[k], &d[l]))
                    })
            })
    })
}

/// Whether the origin lies on the closed segment `p q`: on its line, with the ends not on the same side.
fn in_segment(p: &Vector, q: &Vector) -> bool {
    dot(p, q).sign() != Sign::Plus && is_zero(&cross(p, q))
}

/// Whether the origin lies in the closed triangle `p q r`; `false` for a degenerate one, which its segments cover.
fn in_triangle(p: &Vector, q: &Vector, r: &Vector) -> bool {
    let normal = cross(&subtract(q, p), &subtract(r, p));
    if is_zero(&normal) || dot(&normal, p).sign() != Sign::NoSign {
        return false;
    }
    // Barycentric coordinates of the origin, times the squared length of the normal.
    [(q, r), (r, p), (p, q)]
        .into_iter()
        .all(|(from, to)| dot(&normal, &cross(from, to)).sign() != Sign::Minus)
}

/// Whether the origin lies in the closed tetrahedron `p q r s`; `false` for a flat one, which its triangles cover.
fn in_tetrahedron(p: &Vector, q: &Vector, r: &Vector, s: &Vector) -> bool {
    let (qr, ps) = (cross(q, r), cross(p, s));
    // Barycentric coordinates of the origin times the volume, which is their sum.
    let parts = [dot(&qr, s), dot(&ps, r), -dot(&ps, q), -dot(&qr, p)];
    let volume: BigInt = parts.iter().sum();
    match volume.cmp(&BigInt::ZERO) {
        Ordering::Equal => false,
        Ordering::Less => parts.iter().all(|part| part.sign() != Sign::Plus),
        Ordering::Greater => parts.iter().all(|part| part.sign() != Sign::Minus),
    }
}

fn edges(triangle: &[Vector; 3]) -> [Vector; 3] {
    from_fn(|i| subtract(&triangle[(i + 1) % 3], &triangle[i]))
}

fn is_zero(v: &Vector) -> bool {
    v.iter().all(|component| component.sign() == Sign::NoSign)
}

fn subtract(p: &Vector, q: &Vector) -> Vector {
    from_fn(|i| &p[i] - &q[i])
}

fn dot(p: &Vector, q: &Vector) -> BigInt {
    &p[0] * &q[0] + &p[1] * &q[1] + &p[2] * &q[2]
}

fn cross(p: &Vector, q: &Vector) -> Vector {
    from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &p[j] * &q[k] - &p[k] * &q[j]
    })
}

#[cfg(test)]
#[path = "triangles_tests.rs"]
mod tests;
