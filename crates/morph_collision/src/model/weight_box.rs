//! Intervals of weights.

use crate::input_error::InputError;

/// An interval for the weight of each target.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightBox {
    low: Vec<f32>,
    high: Vec<f32>,
}

impl WeightBox {
    /// All weights from 0 to 1.
    #[must_use]
    pub fn unit(targets: usize) -> Self {
        Self {
            low: vec![0.0; targets],
            high: vec![1.0; targets],
        }
    }

    /// The weights from `low` to `high`, one entry per target, ends included.
    ///
    /// # Errors
    /// The lists have different lengths, or an end is not finite, or above the other end.
    pub fn new(low: &[f32], high: &[f32]) -> Result<Self, InputError> {
        if low.len() != high.len() {
            return Err(InputError::WrongCount {
                what: "upper ends of weights".to_owned(),
                given: high.len(),
                expected: low.len(),
            });
        }
        for (target, (&low, &high)) in low.iter().zip(high).enumerate() {
            let bad = |end: &str, value: f32, expected| InputError::BadNumber {
                what: format!("{end} end of weight {target}"),
                value: f64::from(value),
                expected,
            };
            if !low.is_finite() {
                return Err(bad("lower", low, "finite"));
            }
            if !high.is_finite() {
                return Err(bad("upper", high, "finite"));
            }
            if low > high {
                return Err(bad("lower", low, "at most the upper end"));
            }
        }
        Ok(Self {
            low: low.to_vec(),
            high: high.to_vec(),
        })
    }

    /// The number of targets.
    #[must_use]
    pub fn len(&self) -> usize {
        self.low.len()
    }

    /// Whether there are no targets.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.low.is_empty()
    }

    /// The smallest and the largest weight of a target; `None` if there is no such target.
    #[must_use]
    pub fn interval(&self, target: usize) -> Option<[f32; 2]> {
        Some([*self.low.get(target)?, *self.high.get(target)?])
    }

    /// Whether all weights are in their intervals.
    #[must_use]
    pub fn contains(&self, weights: &[f32]) -> bool {
        let ends = self.low.iter().zip(&self.high);
        weights.len() == self.len()
            && ends
                .zip(weights)
                .all(|((low, high), weight)| (low..=high).contains(&weight))
    }

    /// The weights of the box that are closest to zero.
    pub(crate) fn closest_to_zero(&self) -> Vec<f32> {
        let ends = self.low.iter().zip(&self.high);
        ends.map(|(&low, &high)| 0.0_f32.clamp(low, high)).collect()
    }

    /// The interval of a target that exists.
    pub(crate) fn of(&self, target: u16) -> [f32; 2] {
        [self.low[usize::from(target)], self.high[usize::from(target)]]
    }

    /// The largest absolute weight of a target that exists.
    pub(crate) fn reach(&self, target: u16) -> f64 {
        let [low, high] = self.of(target);
        f64::from(low.abs().max(high.abs()))
    }
}
