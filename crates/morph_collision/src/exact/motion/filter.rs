//! The decision in `f64` with error bounds, from the cheapest test to the dearest. `docs/numerics.md` (Motion) derives the bounds.

use glam::DVec3;

use super::bernstein::{Linear, Quadratic, cross, dot_linear};
use super::directions::separated_by_direction;
use super::features::{FeaturePair, Kind};
use super::height_roots::decide_at_roots;
use super::moving::TimeOfImpact;
use super::subdivision::search;
use crate::exact::number::{UNIT_ROUNDOFF, power_of_two};

/// What the filter found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Answer {
    /// No contact at any time.
    Apart,
    /// Contact. The interval contains the first time, if that was asked for, otherwise any time of contact.
    Contact(TimeOfImpact),
    /// A sign is not certain.
    Open,
}

/// Whether a plane across a coordinate axis separates the features at all times: the differences between their corners, and so
/// between any of their points, all have the same sign along that axis. The sign of a rounded difference is exact.
#[inline]
pub(super) fn separated(features: &FeaturePair) -> bool {
    let mut least = DVec3::INFINITY;
    let mut most = DVec3::NEG_INFINITY;
    for &[a, b] in features.kind.opposite() {
        let (a, b) = (&features.corners[a], &features.corners[b]);
        for difference in [b.start - a.start, b.end - a.end] {
            least = least.min(difference);
            most = most.max(difference);
        }
    }
    least.cmpgt(DVec3::ZERO).any() || most.cmplt(DVec3::ZERO).any()
}

/// Times are at least this accurate. The filter gets them like this at no cost, and few contacts are that close to the boundary of a
/// feature.
pub(super) const COARSEST: f64 = power_of_two(-30);
/// The filter does not halve the time more often.
pub(super) const DEEPEST: u32 = 40;

/// The number of halvings after which an interval of time is short enough for a tolerance. `None` if that is beyond the accuracy of the
/// filter.
#[inline]
pub(super) fn level(tolerance: f64) -> Option<u32> {
    (30..=DEEPEST).find(|level| power_of_two(-i64::from(*level)) <= tolerance)
}

/// The moving vectors between the features, rounded, and what all tests of the filter need of them.
pub(super) struct Relative {
    pub(super) kind: Kind,
    pub(super) u: Linear,
    pub(super) v: Linear,
    pub(super) w: Linear,
    /// `u x v`.
    pub(super) n: Quadratic,
    /// The Bernstein coefficients of `n . w`.
    pub(super) height: [f64; 4],
    pub(super) errors: Errors,
}

impl Relative {
    /// `None` if products of the vectors may overflow or underflow.
    #[inline]
    pub(super) fn new(kind: Kind, [u, v, w]: [Linear; 3]) -> Option<Self> {
        let [mu, mv, mw] = [&u, &v, &w].map(|linear| linear[0].abs().max(linear[1].abs()).max_element());
        // Within these limits nothing overflows, and underflow is far below the error.
        const IN_RANGE: std::ops::Range<f64> = power_of_two(-100)..power_of_two(100);
        if ![mu, mv, mw].iter().all(|size| IN_RANGE.contains(size)) {
            return None;
        }
        let n = cross(&u, &v);
        let scale = UNIT_ROUNDOFF * mu * mv;
        Some(Self {
            height: dot_linear(&n, &w),
            errors: Errors {
                height: scale * mw,
                side: scale * (mu * mv).max(mv * mw).max(mu * mw),
            },
            kind,
            u,
            v,
            w,
            n,
        })
    }
}

/// `u`, `v` and `w`, rounded.
#[inline]
pub(super) fn vectors(features: &FeaturePair) -> [Linear; 3] {
    features.kind.spans().map(|[from, to]| {
        let (from, to) = (&features.corners[from], &features.corners[to]);
        [to.start - from.start, to.end - from.end]
    })
}

/// Decides what `f64` can. With a tolerance, searches for the first contact and narrows its time; otherwise any contact will do.
#[inline]
pub(super) fn filtered(features: &FeaturePair, tolerance: Option<f64>) -> Answer {
    let vectors = vectors(features);
    let Some(relative) = Relative::new(features.kind, vectors) else {
        return direction_or_open(features, &vectors);
    };
    let limit = relative.errors.height(0);
    if relative.height.iter().all(|c| *c > limit) || relative.height.iter().all(|c| *c < -limit) {
        return Answer::Apart;
    }
    if let Some(answer) = decide_at_roots(&relative, tolerance) {
        return answer;
    }
    match search(&relative, tolerance) {
        Answer::Open => direction_or_open(features, &vectors),
        answer => answer,
    }
}

fn direction_or_open(features: &FeaturePair, vectors: &[Linear; 3]) -> Answer {
    if separated_by_direction(features, vectors) {
        Answer::Apart
    } else {
        Answer::Open
    }
}

/// The errors of the coefficients, in units that depend on the size of the features.
pub(super) struct Errors {
    /// In units of the height: `2^-53` times the largest coordinates of `u`, `v` and `w`.
    pub(super) height: f64,
    /// Likewise for a side, which is a product of four such vectors.
    pub(super) side: f64,
}

impl Errors {
    /// The error bound of the coefficients of the height after so many halvings.
    #[inline(always)]
    pub(super) fn height(&self, depth: u32) -> f64 {
        self.height * f64::from(80 + 20 * depth)
    }

    #[inline(always)]
    pub(super) fn side(&self, depth: u32) -> f64 {
        self.side * f64::from(700 + 150 * depth)
    }
}

#[cfg(test)]
mod rounding_tests;
