//! The first contact of a vertex with a face, and of two edges.

use num_bigint::BigInt;

use super::elementary::{ElementaryMotion, MotionKind, PointMotion};
use super::polynomial::{Polynomial, Vector, minus};
use super::root::Root;
use super::triangle::first_time;
use crate::oracle::mantissa_and_exponent;

/// The first time of contact, or `None` if there is none. Coordinates must be finite.
#[must_use]
pub fn first_contact(motion: &ElementaryMotion) -> Option<Root> {
    let triangles = triangles(motion.kind, &moving_points(&motion.points));
    triangles.iter().filter_map(first_time).min()
}

/// The first time at which a vertex is in a closed face. The points are the vertex and the corners of the face.
#[must_use]
pub fn vertex_face(points: [PointMotion; 4]) -> Option<Root> {
    let kind = MotionKind::VertexFace;
    first_contact(&ElementaryMotion { kind, points })
}

/// The first time at which two closed edges share a point. The points are the ends of one edge and those of the other.
#[must_use]
pub fn edge_edge(points: [PointMotion; 4]) -> Option<Root> {
    let kind = MotionKind::EdgeEdge;
    first_contact(&ElementaryMotion { kind, points })
}

/// Triangles such that the features touch exactly while the origin is in one of them.
///
/// The vertex is in the face if the origin is in the face as seen from the vertex. The differences of a point of one edge and a
/// point of the other fill a parallelogram, and the edges share a point if it holds the origin. It is the union of the two
/// triangles on either side of a diagonal, degenerate or not.
pub(super) fn triangles(kind: MotionKind, [a, b, c, d]: &[Vector; 4]) -> Vec<[Vector; 3]> {
    match kind {
        MotionKind::VertexFace => vec![[b, c, d].map(|corner| minus(corner, a))],
        MotionKind::EdgeEdge => {
            let [ac, ad, bc, bd] = [minus(a, c), minus(a, d), minus(b, c), minus(b, d)];
            vec![[ac.clone(), ad, bd.clone()], [ac, bc, bd]]
        }
    }
}

/// Positions as polynomials in time with integer coefficients. All coordinates along an axis are multiplied by the same power of
/// two, which changes no contact.
pub(super) fn moving_points(points: &[PointMotion; 4]) -> [Vector; 4] {
    let parts = points.map(|motion| motion.map(|position| position.map(mantissa_and_exponent)));
    let least: [i32; 3] = std::array::from_fn(|axis| {
        let along = parts.as_flattened().iter().map(|position| position[axis]);
        along
            .filter(|(mantissa, _)| *mantissa != 0)
            .map(|(_, exponent)| exponent)
            .min()
            .unwrap_or(0)
    });
    let whole = |(mantissa, exponent): (i64, i32), axis: usize| match mantissa {
        0 => BigInt::ZERO,
        _ => BigInt::from(mantissa) << (exponent - least[axis]),
    };
    parts.map(|[start, end]| {
        std::array::from_fn(|axis| {
            let (start, end) = (whole(start[axis], axis), whole(end[axis], axis));
            let velocity = end - &start;
            Polynomial::new(vec![start, velocity])
        })
    })
}
