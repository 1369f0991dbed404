//! Exact arithmetic on `f64`s and their sums, differences and products.

use std::cmp::Ordering;

use dashu_int::IBig;
use dashu_int::ops::{BitTest, DivRem};

use super::number::{Number, power_of_two};

/// The number `mantissa * 2^exponent`. Sums, differences and products of finite `f64`s of any size are such numbers.
///
/// Slow, so it is only used if [`Approx`](super::number::Approx) or the `robust` predicates cannot decide.
#[derive(Clone, Debug)]
pub(crate) struct Dyadic {
    mantissa: IBig,
    exponent: i64,
}

impl Dyadic {
    /// The sign.
    pub(crate) fn order(&self) -> Ordering {
        self.mantissa.cmp(&IBig::ZERO)
    }

    /// The quotient, rounded to the nearest `f64`; below the range of normal numbers, rounded twice. The operands may be outside the
    /// range of `f64`. Dividing by zero gives what it does for `f64`s.
    ///
    /// A larger exact quotient never gives a smaller result.
    pub(crate) fn over(&self, divisor: &Self) -> f64 {
        if divisor.mantissa.is_zero() {
            return match self.order() {
                Ordering::Less => f64::NEG_INFINITY,
                Ordering::Equal => f64::NAN,
                Ordering::Greater => f64::INFINITY,
            };
        }
        // The quotient of whole numbers gets 65 or 66 bits. The last one stands for all digits below, so that rounding sees them.
        let shift = 65 + divisor.mantissa.bit_len() as i64 - self.mantissa.bit_len() as i64;
        let (dividend, by) = if shift >= 0 {
            (&self.mantissa << shift as usize, divisor.mantissa.clone())
        } else {
            (self.mantissa.clone(), &divisor.mantissa << -shift as usize)
        };
        let (quotient, rest) = dividend.div_rem(by);
        let digits = i128::try_from(quotient).unwrap_or(0);
        let magnitude = digits.unsigned_abs() | u128::from(!rest.is_zero());
        let is_negative = (self.order() == Ordering::Less) != (divisor.order() == Ordering::Less);
        let rounded = if is_negative {
            -(magnitude as f64)
        } else {
            magnitude as f64
        };
        scaled(rounded, self.exponent - divisor.exponent - shift)
    }
}

/// A finite `f64` as `mantissa * 2^exponent`.
fn parts(value: f64) -> (i64, i64) {
    const FRACTION_BITS: u32 = 52;
    let bits = value.to_bits();
    let biased = (bits >> FRACTION_BITS & 0x7ff) as i64;
    let fraction = (bits & ((1 << FRACTION_BITS) - 1)) as i64;
    let (magnitude, exponent) = match biased {
        0 => (fraction, -1074),
        _ => (fraction | 1 << FRACTION_BITS, biased - 1075),
    };
    (if value < 0.0 { -magnitude } else { magnitude }, exponent)
}

/// Finite numbers, all times the same power of two, which makes them whole. It is the smallest such power.
pub(super) fn whole_numbers(values: &[f64]) -> Vec<IBig> {
    let odd = |value: &f64| {
        let (mantissa, exponent) = parts(*value);
        let zeros = mantissa.trailing_zeros();
        (mantissa != 0).then(|| (mantissa >> zeros, exponent + i64::from(zeros)))
    };
    let numbers: Vec<Option<(i64, i64)>> = values.iter().map(odd).collect();
    let unit = numbers
        .iter()
        .flatten()
        .map(|(_, exponent)| *exponent)
        .min()
        .unwrap_or(0);
    let whole = |number: &Option<(i64, i64)>| match number {
        Some((mantissa, exponent)) => IBig::from(*mantissa) << (exponent - unit) as usize,
        None => IBig::ZERO,
    };
    numbers.iter().map(whole).collect()
}

impl Number for Dyadic {
    fn new(value: f64) -> Self {
        let (mantissa, exponent) = parts(value);
        Self {
            mantissa: mantissa.into(),
            exponent,
        }
    }

    fn plus(&self, other: &Self) -> Self {
        let exponent = match (self.mantissa.is_zero(), other.mantissa.is_zero()) {
            (true, _) => other.exponent,
            (_, true) => self.exponent,
            _ => self.exponent.min(other.exponent),
        };
        // Only the exponent of a zero can be lower.
        let [a, b] = [self, other].map(|n| &n.mantissa << (n.exponent - exponent).max(0) as usize);
        Self {
            mantissa: a + b,
            exponent,
        }
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&Self {
            mantissa: -&other.mantissa,
            exponent: other.exponent,
        })
    }

    fn times(&self, other: &Self) -> Self {
        Self {
            mantissa: &self.mantissa * &other.mantissa,
            exponent: self.exponent + other.exponent,
        }
    }

    fn sign(&self) -> Option<Ordering> {
        Some(self.order())
    }
}

/// `value * 2^exponent`, in steps that stay in range as long as the result does.
fn scaled(value: f64, exponent: i64) -> f64 {
    const STEP: i64 = 500;
    let (mut value, mut rest) = (value, exponent.clamp(-5000, 5000));
    while rest != 0 {
        let step = rest.clamp(-STEP, STEP);
        value *= power_of_two(step);
        rest -= step;
    }
    value
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Integers up to 2^40; products of three fit an `i128`.
    fn whole() -> impl Strategy<Value = i64> {
        prop_oneof![-4_i64..5, -(1_i64 << 40)..(1_i64 << 40)]
    }

    proptest! {
        #[test]
        fn polynomials_of_whole_numbers_are_exact_at_any_scale(
            a in whole(), b in whole(), c in whole(), d in whole(), power in -1000_i32..950,
        ) {
            let unit = 2.0_f64.powi(power);
            let [x, y, z, w] = [a, b, c, d].map(|n| Dyadic::new(n as f64 * unit));
            let value = x.times(&y).times(&z).minus(&w.times(&x).times(&y));
            let [a, b, c, d] = [a, b, c, d].map(i128::from);
            let truth = a * b * c - d * a * b;
            prop_assert_eq!(value.order(), truth.cmp(&0));
            let cube = Dyadic::new(unit).times(&Dyadic::new(unit)).times(&Dyadic::new(unit));
            // The conversion rounds to the nearest `f64`, too.
            prop_assert_eq!(value.over(&cube), truth as f64);
        }

        #[test]
        fn differences_keep_what_rounding_would_lose(a in -1e10..1e10, b in -1e-300..1e-300) {
            let difference = Dyadic::new(a).minus(&Dyadic::new(b)).plus(&Dyadic::new(b));
            prop_assert_eq!(difference.minus(&Dyadic::new(a)).order(), Ordering::Equal);
        }
    }

    #[test]
    fn every_finite_f64_is_represented() {
        for value in [0.0, -0.0, 1.0, -3.5, 5e-324, -f64::MIN_POSITIVE, f64::MAX, 0.1] {
            let same = Dyadic::new(value).over(&Dyadic::new(1.0));
            assert_eq!(same, value);
        }
    }

    #[test]
    fn numbers_become_whole_at_any_scale() {
        for unit in [1.0, f64::from_bits(1), power_of_two(1000)] {
            let whole = whole_numbers(&[3.0, -0.0, -8.0, 5.0].map(|value| value * unit));
            assert_eq!(whole, [3, 0, -8, 5].map(IBig::from));
        }
        assert_eq!(whole_numbers(&[0.75, 2.0]), [3, 8].map(IBig::from));
        assert_eq!(whole_numbers(&[0.0, 0.0]), [0, 0].map(IBig::from));
    }

    #[test]
    fn quotients_out_of_range_are_infinite_or_zero() {
        let (large, small) = (Dyadic::new(f64::MAX), Dyadic::new(5e-324));
        assert_eq!(large.over(&small), f64::INFINITY);
        assert_eq!(small.over(&large), 0.0);
        let zero = Dyadic::new(0.0);
        assert_eq!(Dyadic::new(-1.0).over(&zero), f64::NEG_INFINITY);
        assert!(zero.over(&zero).is_nan());
        assert_eq!(zero.over(&Dyadic::new(-1.0)), 0.0);
    }

    #[test]
    fn quotients_are_rounded_to_the_nearest_f64() {
        let over = |a: &[f64], b: f64| {
            let sum = a.iter().fold(Dyadic::new(0.0), |sum, x| sum.plus(&Dyadic::new(*x)));
            sum.over(&Dyadic::new(b))
        };
        let (half, tiny) = (0.5 * f64::EPSILON, power_of_two(-200));
        // Halfway between two numbers: the even one. Anything above or below halfway, however little: the nearer one.
        assert_eq!(over(&[1.0, half], 1.0), 1.0);
        assert_eq!(over(&[1.0, half, tiny], 1.0), 1.0 + f64::EPSILON);
        assert_eq!(over(&[1.0, 3.0 * half], 1.0), 1.0 + 2.0 * f64::EPSILON);
        assert_eq!(over(&[1.0, 3.0 * half, -tiny], -1.0), -1.0 - f64::EPSILON);
        for (a, b) in [(1.0, 3.0), (2.0, 3.0), (-7.0, 0.1), (5e-324, 3.0), (0.3, -0.7)] {
            assert_eq!(over(&[a], b), a / b);
        }
    }
}
