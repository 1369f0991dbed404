//! Exact sums and products: whole multiples of powers of two.

use std::cmp::Ordering;
use std::iter::Sum;
use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::{BigInt, Sign};

/// A number `mantissa * 2^exponent` of any size. Every finite `f32` and `f64` is one. Sums, differences, products and
/// comparisons are exact.
#[derive(Clone, Debug)]
pub struct Dyadic {
    mantissa: BigInt,
    exponent: i32,
}

impl Dyadic {
    /// `2^exponent`.
    pub fn power_of_two(exponent: i32) -> Self {
        Self {
            mantissa: BigInt::from(1),
            exponent,
        }
    }

    /// Zero.
    pub fn zero() -> Self {
        Self {
            mantissa: BigInt::ZERO,
            exponent: 0,
        }
    }

    /// Whether it is below zero.
    pub fn is_negative(&self) -> bool {
        self.mantissa.sign() == Sign::Minus
    }

    /// The absolute value.
    pub fn abs(self) -> Self {
        if self.is_negative() { -self } else { self }
    }

    /// `self / other` up to a few roundings of `f64`; 0 if `self` is zero.
    pub fn ratio(&self, other: &Self) -> f64 {
        let ((a, a_exponent), (b, b_exponent)) = (self.leading(), other.leading());
        if a == 0.0 {
            return 0.0;
        }
        // In two steps, because the power of two may be out of range even if the quotient is not.
        let exponent = a_exponent - b_exponent;
        a / b * 2_f64.powi(exponent / 2) * 2_f64.powi(exponent - exponent / 2)
    }

    /// The nearest `f64`, up to a rounding or two.
    pub fn to_f64(&self) -> f64 {
        self.ratio(&Self::from(1.0_f64))
    }

    /// Halfway between two numbers.
    pub(crate) fn midpoint(&self, other: &Self) -> Self {
        let mut sum = self.clone() + other.clone();
        sum.exponent -= 1;
        sum
    }

    /// The mantissa and the exponent of the power of two.
    pub(crate) fn parts(&self) -> (&BigInt, i32) {
        (&self.mantissa, self.exponent)
    }

    /// At least 60 leading bits as a number, and the exponent of the power of two to multiply it by.
    fn leading(&self) -> (f64, i32) {
        let spare = self.mantissa.bits().saturating_sub(62) as i32;
        let bits = i64::try_from(&self.mantissa >> spare).unwrap_or(0);
        (bits as f64, self.exponent + spare)
    }

    /// Both mantissas as multiples of the same power of two.
    fn aligned(self, other: Self) -> (BigInt, BigInt, i32) {
        let exponent = self.exponent.min(other.exponent);
        let shifted = |x: Self| x.mantissa << (x.exponent - exponent);
        (shifted(self), shifted(other), exponent)
    }
}

impl From<f64> for Dyadic {
    /// The exact value of a finite number.
    fn from(value: f64) -> Self {
        let (mantissa, exponent) = mantissa_and_exponent(value);
        Self {
            mantissa: BigInt::from(mantissa),
            exponent,
        }
    }
}

impl From<f32> for Dyadic {
    /// The exact value of a finite number.
    fn from(value: f32) -> Self {
        f64::from(value).into()
    }
}

impl Add for Dyadic {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (a, b, exponent) = self.aligned(other);
        Self {
            mantissa: a + b,
            exponent,
        }
    }
}

impl Sub for Dyadic {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Dyadic {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            mantissa: self.mantissa * other.mantissa,
            exponent: self.exponent + other.exponent,
        }
    }
}

impl Neg for Dyadic {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            mantissa: -self.mantissa,
            exponent: self.exponent,
        }
    }
}

impl Sum for Dyadic {
    fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
        numbers.fold(Self::zero(), Add::add)
    }
}

impl PartialEq for Dyadic {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Dyadic {}

impl PartialOrd for Dyadic {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Dyadic {
    fn cmp(&self, other: &Self) -> Ordering {
        let (a, b, _) = self.clone().aligned(other.clone());
        a.cmp(&b)
    }
}

/// `mantissa * 2^exponent == value`, without trailing zero bits, so that integers stay small.
pub(crate) fn mantissa_and_exponent(value: f64) -> (i64, i32) {
    let bits = value.to_bits();
    let biased = ((bits >> 52) & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    // Denormals have no implicit leading bit and share the exponent of the smallest normal numbers.
    let (magnitude, exponent) = if biased == 0 {
        (fraction, -1074)
    } else {
        (fraction | (1 << 52), biased - 1075)
    };
    if magnitude == 0 {
        return (0, 0);
    }
    let zeros = magnitude.trailing_zeros();
    let magnitude = magnitude >> zeros;
    (
        if value < 0.0 { -magnitude } else { magnitude },
        exponent + zeros as i32,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_products_and_comparisons_lose_nothing() {
        let tiny = Dyadic::power_of_two(-900);
        let one = Dyadic::from(1.0_f64);
        let sum = one.clone() + tiny.clone();
        assert!(sum > one && sum.clone() - one.clone() == tiny);
        let square = sum.clone() * sum;
        let expected = one + Dyadic::from(2.0_f64) * tiny.clone() + tiny.clone() * tiny;
        assert_eq!(square, expected);
    }

    #[test]
    fn quotients_are_right_to_f64_and_out_of_its_range() {
        let third = Dyadic::from(1.0_f64).ratio(&Dyadic::from(3.0_f64));
        assert!((third - 1.0 / 3.0).abs() < 1e-15);
        let (p, q) = (Dyadic::power_of_two(-3000), Dyadic::power_of_two(-2990));
        assert_eq!(p.ratio(&q), 2_f64.powi(-10));
        assert_eq!(Dyadic::from(-0.1_f32).to_f64(), f64::from(-0.1_f32));
        assert_eq!(Dyadic::from(f64::from_bits(1)).to_f64(), f64::from_bits(1));
    }
}
