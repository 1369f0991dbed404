//! The decision in `f64` with error bounds, from the cheapest test to the dearest. `docs/numerics.md` (Motion) derives the bounds.
//!
//! `relative` holds what all tests need of two features. `height_roots` decides nearly all pairs; `subdivision` takes the rest.

mod height_roots;
mod relative;
mod subdivision;

use glam::DVec3;

use super::answer::Answer;
use super::bernstein::Linear;
use super::directions::separated_by_direction;
use super::features::FeaturePair;
pub(super) use height_roots::decide_at_roots;
pub(super) use relative::{COARSEST, DEEPEST, Relative, level, vectors};
use subdivision::search;

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

#[cfg(test)]
mod rounding_tests;
