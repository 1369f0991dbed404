//! Separation along directions other than the axes: the last attempt before exact arithmetic.

use glam::DVec3;

use super::bernstein::Linear;
use super::features::FeaturePair;
use crate::exact::number::{UNIT_ROUNDOFF, power_of_two};

/// Whether the features stay apart along one of a few directions that separate parallel edges, degenerate faces, and features that
/// stay in one plane. `u`, `v` and `w` are those of the features.
#[cold]
pub(super) fn separated_by_direction(features: &FeaturePair, vectors: &[Linear; 3]) -> bool {
    let [u, v, w] = vectors.map(|[start, end]| (start + end) * 0.5);
    let across = |edge: DVec3| w - edge * (w.dot(edge) / edge.dot(edge));
    [across(u), across(v), u, v, w, u - v, across(u - v)]
        .into_iter()
        .any(|direction| separates(features, direction))
}

/// Whether all differences between the corners of the features have a positive product with the direction, or all a negative one, at
/// the start and at the end. Then so have all differences between their points at all times.
fn separates(features: &FeaturePair, direction: DVec3) -> bool {
    let (mut least, mut most, mut largest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for &[a, b] in features.kind.opposite() {
        let (a, b) = (&features.corners[a], &features.corners[b]);
        for difference in [b.start - a.start, b.end - a.end] {
            let along = direction.dot(difference);
            (least, most) = (least.min(along), most.max(along));
            largest = largest.max(difference.abs().max_element());
        }
    }
    // Three products of a rounded difference, each rounded at most four times.
    let size = direction.abs().max_element() * largest;
    const IN_RANGE: std::ops::Range<f64> = power_of_two(-900)..power_of_two(900);
    let error = 16.0 * UNIT_ROUNDOFF * size;
    IN_RANGE.contains(&size) && direction.is_finite() && (least > error || most < -error)
}
