//! Exact arithmetic on sums of `f64` (Shewchuk 1997, Sect. 2), for what the `robust` crate's predicates do not cover.

use std::cmp::Ordering;

use super::number::Number;

/// A real number as the exact sum of `f64` terms that do not overlap, smallest first; none of them is zero.
///
/// Exact unless a product over- or underflows. Every operation allocates: this is where the few cases end up that
/// [`Approx`](super::number::Approx) cannot decide.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion(Vec<f64>);

impl Expansion {
    /// Adds one term to a sum that does not overlap (Shewchuk's GROW-EXPANSION).
    fn grow(&mut self, term: f64) {
        let mut carry = term;
        for own in &mut self.0 {
            (carry, *own) = two_sum(carry, *own);
        }
        self.0.push(carry);
    }

    /// Few terms, the largest of them close to the value (Shewchuk's COMPRESS).
    fn compressed(mut self) -> Self {
        let mut rest = std::mem::take(&mut self.0);
        rest.retain(|term| *term != 0.0);
        let Some(mut sum) = rest.pop() else { return self };
        let mut downward = Vec::with_capacity(rest.len() + 1);
        for term in rest.into_iter().rev() {
            let (high, low) = fast_two_sum(sum, term);
            sum = high;
            if low != 0.0 {
                downward.push(high);
                sum = low;
            }
        }
        for term in downward.into_iter().rev() {
            let (high, low) = fast_two_sum(term, sum);
            sum = high;
            if low != 0.0 {
                self.0.push(low);
            }
        }
        if sum != 0.0 {
            self.0.push(sum);
        }
        self
    }

    /// The nearest `f64`, or one next to it.
    pub(crate) fn estimate(&self) -> f64 {
        self.0.iter().sum()
    }

    pub(crate) fn order(&self) -> Ordering {
        self.0
            .last()
            .and_then(|largest| largest.partial_cmp(&0.0))
            .unwrap_or(Ordering::Equal)
    }
}

impl Number for Expansion {
    fn new(value: f64) -> Self {
        Self(vec![value]).compressed()
    }

    fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self(vec![low, high]).compressed()
    }

    fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        for &term in &other.0 {
            sum.grow(term);
        }
        sum.compressed()
    }

    fn minus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        for &term in &other.0 {
            sum.grow(-term);
        }
        sum.compressed()
    }

    fn times(&self, other: &Self) -> Self {
        let mut product = Self::default();
        for &a in &self.0 {
            for &b in &other.0 {
                let high = a * b;
                product.grow(a.mul_add(b, -high));
                product.grow(high);
            }
            product = product.compressed();
        }
        product
    }

    fn sign(&self) -> Option<Ordering> {
        Some(self.order())
    }

    fn value(&self) -> Option<f64> {
        Some(self.estimate())
    }
}

/// `a + b` as its rounded value and what rounding lost.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// As [`two_sum`] for `|a| >= |b|`.
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Whole numbers up to 2^40 and their products of three fit `i128`.
    fn whole() -> impl Strategy<Value = i64> {
        prop_oneof![-4_i64..5, -(1_i64 << 40)..(1_i64 << 40)]
    }

    proptest! {
        #[test]
        fn polynomials_of_whole_numbers_are_exact(a in whole(), b in whole(), c in whole(), d in whole()) {
            let [x, y, z, w] = [a, b, c, d].map(|n| Expansion::new(n as f64));
            let sum = x.times(&y).times(&z).minus(&w.times(&x).times(&y)).plus(&z);
            let [a, b, c, d] = [a, b, c, d].map(i128::from);
            let truth = a * b * c - d * a * b + c;
            prop_assert_eq!(sum.order(), truth.cmp(&0));
            prop_assert!((sum.estimate() - truth as f64).abs() <= (truth as f64).abs() * f64::EPSILON);
        }

        #[test]
        fn differences_keep_what_rounding_would_lose(a in -1e10..1e10, b in -1e-10..1e-10) {
            let difference = Expansion::difference(a, b).plus(&Expansion::new(b));
            prop_assert_eq!(difference.minus(&Expansion::new(a)).order(), Ordering::Equal);
        }
    }
}
