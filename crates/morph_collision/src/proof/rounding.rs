//! How far rounding can bring triangles together (docs/numerics.md, "Proofs for all weights").

use crate::exact::power_of_two;

/// Half a unit in the last place of 1 in `f32`.
const U: f64 = 1.0 / (1_u64 << 24) as f64;

/// A bound on the error of each coordinate of a posed vertex, and of its share in the bounds of this module, that at most `targets` targets move.
/// `reach` is at least the base coordinate plus the sum of `|w_k| |d_k|`.
pub(super) fn vertex_error(targets: usize, reach: f64) -> f64 {
    let targets = targets as f64;
    (targets + 4.0) * U * 1.03 * reach + (targets + 1.0) * power_of_two(-149)
}

/// The smallest value of `w g(w)` for a weight in an interval, where the slope is `above` for positive weights and `below` for negative ones.
/// `above` is at most `below`, so the function is concave and smallest at an end.
pub(super) fn least([low, high]: [f32; 2], above: f64, below: f64) -> f64 {
    let at = |weight: f32| f64::from(weight) * if weight >= 0.0 { above } else { below };
    at(low).min(at(high))
}
