//! The weights of reference volumes (Eq. 1), for any weights of targets.
//!
//! With displacements `d_k` a vertex is `b + sum of w_k d_k`. With references `p_0 = b` and `p_k = b + d_k` that is the paper's
//! `sum of w_i p_i`, where `w_0` is 1 minus the sum of the others. It is convex if no `w_k` is negative and their sum is at
//! most 1. Other weights are split in two, `w_k = a_k + r_k`:
//!
//! - `a_k` is 0 for negative weights. Positive ones are scaled down to the sum 1 if their sum is greater. With
//!   `a_0 = 1 - sum of a_k` this part is convex, and Eq. 3 and 7 apply.
//! - `r_k d_k` remains to be added, a sum over displacements of any sign: interval arithmetic over the volumes around them.
//!
//! With convex weights all `r_k` are 0, and if rounding takes a sum just past 1 the rest is tiny.
//!
//! # In-betweens
//!
//! Half way between references `i` and `i + 1` lies another shape, with volumes of its own (Sect. 5). Let
//! `m = min(a_i, a_(i+1))`. Then `m` of each of the two references equals `2 m` of that shape; the blend stays convex. The paper has two
//! active references. If there are more, the two with the largest `m` are used.
//!
//! # Rounding
//!
//! Let `u = 2^-24` and `v = 2^-53`. Let `B` and `D_k` be the largest magnitudes of coordinates of `b` and `d_k`, `m` the number
//! of nonzero weights, `K` the number of all weights, and `R = B + sum of |w_k| D_k`. A posed vertex is rounded to `f32` in
//! each of `m` products and sums; a coordinate is off by at most
//! `(m + 1) u / (1 - (m + 1) u) R + m 2^-150 <= 1.004 (m + 1) u R + m 2^-150`, since `m < 2^16`.
//!
//! Volumes are computed from coordinates in `f64`. A reference's coordinates are off by at most `4 v (B + D_k)`, weights by a
//! few `v` each, and a blend of at most `2 K + 2` terms by `(2 K + 12) v R` in all, less than `u R`. So
//! `1.01 (m + 3) u R + m 2^-149` covers both.

use super::references::References;

/// Half a unit in the last place of 1 in `f32`.
const U: f64 = f32::EPSILON as f64 / 2.0;

/// The smallest positive `f32`.
const SMALLEST: f64 = f32::from_bits(1) as f64;

/// The coefficients for blending a body's volumes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Blend {
    /// `a_k`, less the part that the in-between takes.
    pub(super) convex: Vec<f64>,
    /// `r_k`.
    pub(super) rest: Vec<f64>,
    /// The reference that an in-between follows, and its weight.
    pub(super) in_between: Option<(u32, f64)>,
    /// How far coordinates of posed vertices may be outside the blended volumes.
    pub(super) error: f64,
}

impl Blend {
    /// Sets the coefficients for finite weights, one per target.
    pub(super) fn set(&mut self, weights: &[f32], references: &References, in_betweens: bool) {
        let positive: f64 = weights.iter().map(|&w| f64::from(w.max(0.0))).sum();
        let scale = if positive > 1.0 { 1.0 / positive } else { 1.0 };
        self.convex.clear();
        self.rest.clear();
        let (mut reach, mut active) = (references.base_reach, 0.0);
        for (&weight, target_reach) in weights.iter().zip(&references.target_reach) {
            let weight = f64::from(weight);
            let convex = weight.max(0.0) * scale;
            self.convex.push(convex);
            self.rest.push(weight - convex);
            reach += weight.abs() * target_reach;
            active += f64::from(u8::from(weight != 0.0));
        }
        self.error = 1.01 * (active + 3.0) * U * reach + active * SMALLEST;
        self.in_between = if in_betweens { self.take_shared() } else { None };
    }

    /// Moves the shared part of two references to the in-between.
    fn take_shared(&mut self) -> Option<(u32, f64)> {
        let of_base = (1.0 - self.convex.iter().sum::<f64>()).max(0.0);
        let of = |reference: usize| {
            if reference == 0 {
                of_base
            } else {
                self.convex[reference - 1]
            }
        };
        let shared = |reference: usize| of(reference).min(of(reference + 1));
        let most = (0..self.convex.len()).max_by(|&i, &j| shared(i).total_cmp(&shared(j)))?;
        let shared = shared(most);
        if shared == 0.0 {
            return None;
        }
        // Nothing is taken from the base, because its weight is 1 minus the sum of the others.
        if most > 0 {
            self.convex[most - 1] -= shared;
        }
        self.convex[most] -= shared;
        Some((most as u32, 2.0 * shared))
    }
}
