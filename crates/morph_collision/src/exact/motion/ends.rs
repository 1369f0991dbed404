//! What features are exactly at the start and at the end of their motion: the attempt before exact polynomials.
//!
//! In games, motion is degenerate at its ends more often than in between: bodies rest on each other, shrink to a point, or become flat. Then
//! the height is zero at an end, and no rounded sign is certain near it. But the corners at that end are known exactly.

use std::cmp::Ordering::Equal;

use glam::DVec3;

use super::features::{FeaturePair, Kind};
use super::filter::{Answer, Relative, vectors};
use super::moving::{MovingPoint, TimeOfImpact};
use crate::exact::predicates::{Projection, plane_side};
use crate::exact::segment::segments_intersect;
use crate::exact::triangles_intersect;

/// Decides features that touch at the start, and those that can only touch at the end. With `any`, a contact at the end is enough, even if
/// there may be an earlier one.
///
/// Features touch only at roots of the height. A height with a root of multiplicity `k` at the start and of `m` at the end has Bernstein
/// coefficients of zero, `k` at the beginning and `m` at the end of the list. If all others have the same sign, it has no root in between.
#[cold]
pub(super) fn decide_at_ends(features: &FeaturePair, any: bool) -> Answer {
    let [start, end] =
        [|c: &MovingPoint| c.start, |c: &MovingPoint| c.end].map(|at| features.corners.each_ref().map(at));
    if !start.iter().chain(&end).all(|corner| corner.is_finite()) {
        return Answer::Open;
    }
    if touch(features.kind, &start) {
        return contact_at(0.0);
    }
    if start == end {
        return Answer::Apart;
    }
    let ends_in_point = end.iter().all(|corner| *corner == end[0]);
    // They shrink to a point without changing their shape.
    if ends_in_point || any && touch(features.kind, &end) {
        return contact_at(1.0);
    }
    let zeros = [&start, &end].map(multiplicity);
    let Some(relative) = (zeros != [0, 0] && zeros[0] + zeros[1] <= 3)
        .then(|| Relative::new(features.kind, vectors(features)))
        .flatten()
    else {
        return Answer::Open;
    };
    let limit = relative.errors.height(0);
    let others = &relative.height[zeros[0]..4 - zeros[1]];
    if !(others.iter().all(|c| *c > limit) || others.iter().all(|c| *c < -limit)) {
        return Answer::Open;
    }
    if zeros[1] > 0 && touch(features.kind, &end) {
        contact_at(1.0)
    } else {
        Answer::Apart
    }
}

fn contact_at(time: f64) -> Answer {
    Answer::Contact(TimeOfImpact {
        earliest: time,
        latest: time,
    })
}

/// Whether features at rest touch.
fn touch(kind: Kind, &[a, b, c, d]: &[DVec3; 4]) -> bool {
    match kind {
        Kind::VertexFace => triangles_intersect(&[a; 3], &[b, c, d]),
        Kind::EdgeEdge => segments_intersect([a, b], [c, d]),
    }
}

/// The least multiplicity of the height's root at a time at which the corners are here: the number of dimensions that they do not span.
///
/// The height is the determinant of three vectors that change linearly. If they span only `r` dimensions at a time, every derivative up
/// to the one of order `2 - r` is a sum of determinants that have two parallel columns, or three in a plane.
fn multiplicity(corners: &[DVec3; 4]) -> usize {
    let &[a, b, c, d] = corners;
    if plane_side(a, b, c, d) != Equal {
        return 0;
    }
    let triples = [[a, b, c], [a, b, d], [a, c, d], [b, c, d]];
    if triples.into_iter().any(|triple| Projection::of_plane(triple).is_some()) {
        1
    } else if corners.iter().any(|corner| *corner != a) {
        2
    } else {
        3
    }
}
