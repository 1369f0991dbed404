//! The moving vectors between two features, and the error bounds of all tests of the filter.

use crate::exact::motion::bernstein::{Linear, Quadratic, cross, dot_linear};
use crate::exact::motion::features::{FeaturePair, Kind};
use crate::exact::number::{UNIT_ROUNDOFF, power_of_two};

/// Times are at least this accurate. The filter gets them like this at no cost, and few contacts are that close to the boundary of a
/// feature.
pub(in crate::exact::motion) const COARSEST: f64 = power_of_two(-30);
/// The filter does not halve the time more often.
pub(in crate::exact::motion) const DEEPEST: u32 = 40;

/// The number of halvings after which an interval of time is short enough for a tolerance. `None` if that is beyond the accuracy of the
/// filter.
#[inline]
pub(in crate::exact::motion) fn level(tolerance: f64) -> Option<u32> {
    (30..=DEEPEST).find(|level| power_of_two(-i64::from(*level)) <= tolerance)
}

/// The moving vectors between the features, rounded, and what all tests of the filter need of them.
pub(in crate::exact::motion) struct Relative {
    pub(in crate::exact::motion) kind: Kind,
    pub(in crate::exact::motion) u: Linear,
    pub(in crate::exact::motion) v: Linear,
    pub(in crate::exact::motion) w: Linear,
    /// `u x v`.
    pub(in crate::exact::motion) n: Quadratic,
    /// The Bernstein coefficients of `n . w`.
    pub(in crate::exact::motion) height: [f64; 4],
    pub(in crate::exact::motion) errors: Errors,
}

impl Relative {
    /// `None` if products of the vectors may overflow or underflow.
    #[inline]
    pub(in crate::exact::motion) fn new(kind: Kind, [u, v, w]: [Linear; 3]) -> Option<Self> {
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
pub(in crate::exact::motion) fn vectors(features: &FeaturePair) -> [Linear; 3] {
    features.kind.spans().map(|[from, to]| {
        let (from, to) = (&features.corners[from], &features.corners[to]);
        [to.start - from.start, to.end - from.end]
    })
}

/// The errors of the coefficients, in units that depend on the size of the features.
pub(in crate::exact::motion) struct Errors {
    /// In units of the height: `2^-53` times the largest coordinates of `u`, `v` and `w`.
    pub(in crate::exact::motion) height: f64,
    /// Likewise for a side, which is a product of four such vectors.
    pub(in crate::exact::motion) side: f64,
}

impl Errors {
    /// The error bound of the coefficients of the height after so many halvings.
    #[inline(always)]
    pub(in crate::exact::motion) fn height(&self, depth: u32) -> f64 {
        self.height * f64::from(80 + 20 * depth)
    }

    #[inline(always)]
    pub(in crate::exact::motion) fn side(&self, depth: u32) -> f64 {
        self.side * f64::from(700 + 150 * depth)
    }
}
