//! What features are exactly at the start and at the end of their motion: the attempt before exact polynomials.
//!
//! In games, motion is degenerate at its ends more often than in between: bodies rest on each other, shrink to a point, or become flat. Then
//! the height is zero at an end, and no rounded sign is certain near it. But the corners at that end are known exactly.

use std::cmp::Ordering::Equal;

use glam::DVec3;

use super::answer::Answer;
use super::features::{FeaturePair, Kind};
use super::filter::{Relative, decide_at_roots, vectors};
use super::moving::{MovingPoint, TimeOfImpact};
use crate::exact::predicates::{Projection, plane_side};
use crate::exact::segment::segments_intersect;
use crate::exact::triangles_intersect;

/// Decides features that touch at the start, and those that are degenerate at an end. With a tolerance, searches for the first contact;
/// otherwise any contact will do.
#[cold]
pub(super) fn decide_at_ends(features: &FeaturePair, tolerance: Option<f64>) -> Answer {
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
    if ends_in_point || tolerance.is_none() && touch(features.kind, &end) {
        return contact_at(1.0);
    }
    let zeros = [&start, &end].map(multiplicity);
    let relative = Relative::new(features.kind, vectors(features)).filter(|_| zeros != [0, 0]);
    let in_between = relative
        .and_then(|relative| relative.without_roots_at_ends(zeros))
        .and_then(|relative| decide_at_roots(&relative, tolerance));
    match in_between {
        Some(Answer::Apart) if zeros[1] > 0 && touch(features.kind, &end) => contact_at(1.0),
        Some(answer) => answer,
        None => Answer::Open,
    }
}

impl Relative {
    /// Divides the height by `t^k (1 - t)^m`, if it has roots of these multiplicities at the start and at the end. What is left has its other
    /// roots. `None` if the height is zero at all times.
    ///
    /// The height's first `k` and last `m` Bernstein coefficients are zero. A product of the others and ratios of binomial coefficients, at
    /// most 3, are those of the quotient. Raising its degree to 3 again takes means, so no coefficient's error becomes more than 3 times
    /// as large, and a few roundings.
    fn without_roots_at_ends(mut self, [k, m]: [usize; 2]) -> Option<Self> {
        const BINOMIAL: [[f64; 4]; 4] = [
            [1.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0],
            [1.0, 2.0, 1.0, 0.0],
            [1.0, 3.0, 3.0, 1.0],
        ];
        let degree = 3_usize.checked_sub(k + m)?;
        let mut quotient = [0.0; 4];
        for i in 0..=degree {
            quotient[i] = self.height[k + i] * (BINOMIAL[3][k + i] / BINOMIAL[degree][i]);
        }
        for degree in degree..3 {
            let lower = quotient;
            for i in 0..=degree + 1 {
                let share = i as f64 / (degree + 1) as f64;
                let before = if i > 0 { share * lower[i - 1] } else { 0.0 };
                quotient[i] = before + (1.0 - share) * lower[i];
            }
        }
        self.height = quotient;
        self.errors.height *= 4.0;
        Some(self)
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
