//! Hill climbing with restarts over lists of numbers, to find the worst case of a rounding error.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The length of a search, and its seed.
#[derive(Clone, Copy, Debug)]
pub struct Climb {
    /// Random seed; the same seed gives the same result.
    pub seed: u64,
    /// Number of starts.
    pub starts: usize,
    /// Number of changes tried from each start.
    pub steps: usize,
}

impl Climb {
    /// The highest value found, and the list that gives it.
    ///
    /// `start` makes the `i`-th initial list. `value` rates a list and returns `None` for one that is not allowed.
    pub fn highest(
        &self,
        mut start: impl FnMut(usize, &mut Pcg64Mcg) -> Vec<f32>,
        mut value: impl FnMut(&[f32]) -> Option<f64>,
    ) -> (f64, Vec<f32>) {
        let mut rng = Pcg64Mcg::seed_from_u64(self.seed);
        let mut best = (f64::NEG_INFINITY, Vec::new());
        for i in 0..self.starts {
            let mut numbers = start(i, &mut rng);
            let mut height = value(&numbers).unwrap_or(f64::NEG_INFINITY);
            for _ in 0..self.steps {
                let mut changed = numbers.clone();
                for _ in 0..rng.random_range(1..=2) {
                    change(&mut changed, &mut rng);
                }
                if let Some(found) = value(&changed).filter(|found| *found >= height) {
                    (numbers, height) = (changed, found);
                }
            }
            if height > best.0 {
                best = (height, numbers);
            }
        }
        best
    }
}

/// Whether a search found the known share of an error bound, to within a sixth.
///
/// A smaller share means a looser bound or a weaker search. A larger one means that a bound was tightened without a new
/// derivation. Climbs from the same seed find the same share.
pub fn is_as_known(found: f64, known: f64) -> bool {
    (known / 1.17..=known * 1.17).contains(&found)
}

/// Changes one number: usually its last bits, sometimes its sign or size, or all of it.
fn change(numbers: &mut [f32], rng: &mut Pcg64Mcg) {
    let (i, j) = (rng.random_range(0..numbers.len()), rng.random_range(0..numbers.len()));
    let x = numbers[i];
    numbers[i] = match rng.random_range(0..12) {
        0..5 => nudged(x, rng.random_range(-4..=4)),
        5 | 6 => nudged(x, 1 << rng.random_range(0..22)),
        7 => nudged(x, -(1 << rng.random_range(0..22))),
        8 => x * 2_f32.powi(rng.random_range(-3..=3)),
        9 => -x,
        10 => numbers[j],
        _ => x * rng.random_range(0.5..2.0),
    };
}

/// A number moved some units in the last place away from zero or towards it; zero stays.
fn nudged(x: f32, by: i32) -> f32 {
    if x == 0.0 {
        return x;
    }
    f32::from_bits(x.to_bits().wrapping_add_signed(by))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_climb_reaches_the_top() {
        let climb = Climb {
            seed: 1,
            starts: 2,
            steps: 3000,
        };
        let hill = |at: &[f32]| Some(-(f64::from(at[0]) - 0.3).powi(2) - (f64::from(at[1]) + 7.0).powi(2));
        let (height, at) = climb.highest(|_, _| vec![1.0, 1.0], hill);
        assert!(height > -1e-6, "{height} at {at:?}");
    }

    #[test]
    fn a_bound_a_fifth_looser_or_tighter_is_noticed() {
        assert!(is_as_known(0.17, 0.17) && is_as_known(0.19, 0.17) && is_as_known(0.15, 0.17));
        assert!(!is_as_known(0.17 / 1.2, 0.17) && !is_as_known(0.17 * 1.2, 0.17));
        assert!(!is_as_known(f64::NAN, 0.17) && !is_as_known(f64::NEG_INFINITY, 0.17));
    }

    #[test]
    fn what_is_not_allowed_is_never_the_answer() {
        let climb = Climb {
            seed: 2,
            starts: 1,
            steps: 300,
        };
        let (height, at) = climb.highest(|_, _| vec![1.0], |at| (at[0] <= 2.0).then_some(f64::from(at[0])));
        assert!(at[0] <= 2.0 && height == f64::from(at[0]));
    }
}
