use thiserror::Error;

use crate::model::{LARGEST, MorphModel};

/// Why a pose refuses weights. It keeps the weights that it has.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WeightsError {
    /// There must be one weight per target.
    #[error("{given} weights were given, the mesh has {expected} targets")]
    WrongCount {
        /// The number of weights.
        given: usize,
        /// The number of targets.
        expected: usize,
    },
    /// A weight is NaN or infinite.
    #[error("weight {index} is {value}, not a finite number")]
    NotFinite {
        /// The target.
        index: usize,
        /// Its weight.
        value: f32,
    },
    /// The weights could move a vertex out of the range of `f32`.
    #[error("weight {index} is {value}: posed vertices could be beyond 1e37")]
    TooLarge {
        /// The target at which the sum of the possible displacements went out of range.
        index: usize,
        /// Its weight.
        value: f32,
    },
}

/// Checks weights before a pose takes them.
pub(super) fn check(model: &MorphModel, weights: &[f32]) -> Result<(), WeightsError> {
    if weights.len() != model.target_count() {
        return Err(WeightsError::WrongCount {
            given: weights.len(),
            expected: model.target_count(),
        });
    }
    let mut reach = f64::from(model.base_reach());
    for (index, (&value, &target_reach)) in weights.iter().zip(model.target_reach()).enumerate() {
        if !value.is_finite() {
            return Err(WeightsError::NotFinite { index, value });
        }
        reach += f64::from(value.abs()) * f64::from(target_reach);
        if reach > f64::from(2.0 * LARGEST) {
            return Err(WeightsError::TooLarge { index, value });
        }
    }
    Ok(())
}

/// A bound on how far any posed vertex moves between two weight vectors, in model space: `sum |dw_k| D_k` plus the roundings
/// of both blends (docs/numerics.md, "Vertices").
pub(super) fn displacement(model: &MorphModel, before: &[f32], after: &[f32]) -> f64 {
    let mut moved = 0.0;
    let mut reach = f64::from(model.base_reach());
    let mut active = 2.0;
    for ((before, after), target) in before.iter().zip(after).zip(model.target_reach()) {
        let (before, after, target) = (f64::from(*before), f64::from(*after), f64::from(*target));
        moved += (after - before).abs() * target;
        reach += before.abs().max(after.abs()) * target;
        active += f64::from(u8::from(before != 0.0 || after != 0.0));
    }
    // Without any move both blends round alike.
    let rounded = if moved == 0.0 {
        0.0
    } else {
        2.0 * active * f64::from(f32::EPSILON) * reach
    };
    // Reaches are per coordinate.
    3_f64.sqrt() * (moved + rounded)
}
