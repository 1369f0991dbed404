//! Checks of weights that a pose is given.

use thiserror::Error;

use crate::model::{LARGEST, MorphModel};

/// Why a pose refuses weights. The pose keeps its previous weights.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WeightsError {
    /// The number of weights differs from the number of targets.
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
        /// The target's index.
        index: usize,
        /// Its weight.
        value: f32,
    },
    /// The weights could move a vertex out of the range of `f32`.
    #[error("weight {index} is {value}: posed vertices could be beyond 1e37")]
    TooLarge {
        /// The index of the target at which the sum of possible displacements went out of range.
        index: usize,
        /// Its weight.
        value: f32,
    },
}

impl MorphModel {
    /// Checks weights without a pose: whether [`Pose::set_weights`](crate::Pose::set_weights) accepts them.
    ///
    /// Cost: one pass over the weights.
    ///
    /// # Errors
    /// [`WeightsError`] if the number of weights is wrong, if a weight is not finite, or if the weights could move a vertex out of the
    /// range of `f32`.
    pub fn check_weights(&self, weights: &[f32]) -> Result<(), WeightsError> {
        if weights.len() != self.target_count() {
            return Err(WeightsError::WrongCount {
                given: weights.len(),
                expected: self.target_count(),
            });
        }
        let limit = f64::from(2.0 * LARGEST);
        let of_target = |(value, reach): (&f32, &f32)| f64::from(value.abs()) * f64::from(*reach);
        let of_targets = weights.iter().zip(self.target_reach()).map(of_target);
        // False if a weight is not finite: infinity times zero is NaN.
        if of_targets.fold(f64::from(self.base_reach()), |sum, reach| sum + reach) <= limit {
            return Ok(());
        }
        explain(self, weights)
    }
}

/// Finds the weight that is refused.
#[cold]
fn explain(model: &MorphModel, weights: &[f32]) -> Result<(), WeightsError> {
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
