//! Numbers with twice the digits of an `f64`, one or several side by side.

use std::ops::{Add, Mul, Neg, Sub};

/// An `f64`, or several side by side.
pub(super) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Mul<f64, Output = Self> + Neg<Output = Self>
{
}

impl<T> Real for T where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Mul<f64, Output = T> + Neg<Output = T>
{
}

/// The unevaluated sum of two `f64`s (Dekker 1971, "A floating-point technique for extending the available precision"). The second is
/// at most half a unit in the last place of the first.
///
/// With `v = 2^-53` and without underflow, a sum or difference of `x` and `y` has an error of at most `3 v^2 (|x| + |y|)`, a product one
/// of at most `8 v^2 |x y|` (docs/numerics.md). Each product that underflows adds less than [`UNDERFLOW`].
#[derive(Clone, Copy, Debug)]
pub(super) struct DoubleDouble<T> {
    pub(super) high: T,
    pub(super) low: T,
}

/// More than the absolute error of a product by underflow: each of its parts loses at most half the smallest subnormal.
pub(super) const UNDERFLOW: f64 = f64::from_bits(16);

impl<T: Real> DoubleDouble<T> {
    /// `a - b`, without any error.
    #[inline(always)]
    pub(super) fn difference(a: T, b: T) -> Self {
        two_sum(a, -b)
    }

    /// `a b`, without any error but underflow.
    #[inline(always)]
    pub(super) fn product(a: T, b: T) -> Self {
        two_product(a, b)
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        let sum = two_sum(self.high, other.high);
        normalised(sum.high, sum.low + (self.low + other.low))
    }

    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        let sum = two_sum(self.high, -other.high);
        normalised(sum.high, sum.low + (self.low - other.low))
    }

    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        let mixed = self.high * other.low + self.low * other.high;
        normalised(product.high, product.low + mixed)
    }
}

/// The sum of a number and a smaller one.
#[inline(always)]
fn normalised<T: Real>(high: T, low: T) -> DoubleDouble<T> {
    let sum = high + low;
    DoubleDouble {
        high: sum,
        low: low - (sum - high),
    }
}

/// The rounded sum of two numbers and what rounding left out (Knuth).
#[inline(always)]
fn two_sum<T: Real>(a: T, b: T) -> DoubleDouble<T> {
    let high = a + b;
    let of_b = high - a;
    let low = (a - (high - of_b)) + (b - of_b);
    DoubleDouble { high, low }
}

/// The rounded product of two numbers and what rounding left out (Dekker). Not by a fused multiplication, which is slow on processors
/// without one.
#[inline(always)]
fn two_product<T: Real>(a: T, b: T) -> DoubleDouble<T> {
    let high = a * b;
    let ([a, a_low], [b, b_low]) = (halves(a), halves(b));
    let low = a_low * b_low - (((high - a * b) - a_low * b) - a * b_low);
    DoubleDouble { high, low }
}

/// A number as the sum of two with at most 26 bits each (Veltkamp).
#[inline(always)]
fn halves<T: Real>(value: T) -> [T; 2] {
    const SPLIT: f64 = (1_u64 << 27) as f64 + 1.0;
    let shifted = value * SPLIT;
    let high = shifted - (shifted - value);
    [high, value - high]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::exact::dyadic::Dyadic;
    use crate::exact::number::{Number, UNIT_ROUNDOFF};

    impl DoubleDouble<f64> {
        fn exact(self) -> Dyadic {
            Dyadic::new(self.high).plus(&Dyadic::new(self.low))
        }
    }

    fn number() -> impl Strategy<Value = f64> {
        let whole = (-9_i64..10).prop_map(|value| value as f64);
        prop_oneof![whole, -1.0..1.0, -1e3..1e3, -1e-30..1e-30, -1e25..1e25]
    }

    /// How much of an allowed error is reached.
    fn share(found: DoubleDouble<f64>, exact: &Dyadic, allowed: &Dyadic) -> f64 {
        let error = found.exact().minus(exact);
        let zero = Dyadic::new(0.0);
        match error.order() {
            std::cmp::Ordering::Equal => 0.0,
            std::cmp::Ordering::Less => zero.minus(&error).over(allowed),
            std::cmp::Ordering::Greater => error.over(allowed),
        }
    }

    fn absolute(number: &Dyadic) -> Dyadic {
        if number.order().is_lt() {
            Dyadic::new(0.0).minus(number)
        } else {
            number.clone()
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]
        #[test]
        fn errors_are_within_their_bounds(a in number(), b in number(), c in number(), d in number()) {
            let (x, y) = (DoubleDouble::difference(a, b), DoubleDouble::product(c, d));
            prop_assert_eq!(x.exact().minus(&Dyadic::new(a).minus(&Dyadic::new(b))).order(), std::cmp::Ordering::Equal);
            prop_assert_eq!(y.exact().minus(&Dyadic::new(c).times(&Dyadic::new(d))).order(), std::cmp::Ordering::Equal);
            let square = Dyadic::new(UNIT_ROUNDOFF * UNIT_ROUNDOFF);
            let (exact_x, exact_y) = (x.exact(), y.exact());
            let of_sums = absolute(&exact_x).plus(&absolute(&exact_y)).times(&Dyadic::new(3.0)).times(&square);
            let of_product = absolute(&exact_x.times(&exact_y)).times(&Dyadic::new(8.0)).times(&square);
            for (found, exact, allowed) in [
                (x.plus(y), exact_x.plus(&exact_y), &of_sums),
                (x.minus(y), exact_x.minus(&exact_y), &of_sums),
                (x.times(y), exact_x.times(&exact_y), &of_product),
            ] {
                prop_assert!(share(found, &exact, allowed) <= 1.0);
                prop_assert!(found.low.abs() <= found.high.abs() * UNIT_ROUNDOFF);
            }
        }
    }
}
