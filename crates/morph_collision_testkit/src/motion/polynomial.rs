//! Polynomials in one variable with integer coefficients.

use std::ops::{Add, Mul, Sub};

use num_bigint::{BigInt, Sign};

use crate::oracle::Dyadic;

/// `c_0 + c_1 t + c_2 t^2 + ...`
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Polynomial {
    /// `c_0` first. The last is not zero; the zero polynomial has none.
    coefficients: Vec<BigInt>,
}

impl Polynomial {
    pub(super) fn new(mut coefficients: Vec<BigInt>) -> Self {
        while coefficients.last().is_some_and(|last| last.sign() == Sign::NoSign) {
            coefficients.pop();
        }
        Self { coefficients }
    }

    pub(super) fn one() -> Self {
        Self::new(vec![BigInt::from(1)])
    }

    pub(super) fn is_zero(&self) -> bool {
        self.coefficients.is_empty()
    }

    /// The derivative.
    pub(super) fn derivative(&self) -> Self {
        let terms = self.coefficients.iter().enumerate().skip(1);
        Self::new(terms.map(|(power, c)| c * power).collect())
    }

    /// The sign of the value at `t`.
    pub(super) fn sign_at(&self, t: &Dyadic) -> Sign {
        let (mantissa, exponent) = t.parts();
        let (t, bits) = match u32::try_from(exponent) {
            Ok(exponent) => (mantissa << exponent, 0),
            Err(_) => (mantissa.clone(), exponent.unsigned_abs()),
        };
        // Horner's rule for t / 2^bits, with the value multiplied by a power of 2^bits, so that it stays whole.
        let mut value = BigInt::ZERO;
        let mut scale = 0;
        for c in self.coefficients.iter().rev() {
            value = value * &t + (c << scale);
            scale += bits;
        }
        value.sign()
    }

    /// The remainder of `self` divided by `divisor`, times some positive number.
    pub(super) fn remainder(&self, divisor: &Self) -> Self {
        let Some(leading) = divisor.coefficients.last() else {
            return self.clone();
        };
        let magnitude = BigInt::from(leading.magnitude().clone());
        let mut rest = self.coefficients.clone();
        while rest.len() >= divisor.coefficients.len() {
            let Some(mut factor) = rest.pop() else { break };
            // rest * |leading| - divisor * (+-factor) t^shift. Their leading terms cancel, so that of `rest` is dropped above.
            if leading.sign() == Sign::Minus {
                factor = -factor;
            }
            for c in &mut rest {
                *c *= &magnitude;
            }
            let shift = rest.len() + 1 - divisor.coefficients.len();
            for (c, d) in rest[shift..].iter_mut().zip(&divisor.coefficients) {
                *c -= d * &factor;
            }
        }
        Self::new(rest).halved()
    }

    /// Divides by the largest power of two that divides all coefficients, which keeps numbers small.
    pub(super) fn halved(mut self) -> Self {
        let zeros = self
            .coefficients
            .iter()
            .filter_map(BigInt::trailing_zeros)
            .min()
            .unwrap_or(0);
        if zeros > 0 {
            for c in &mut self.coefficients {
                *c >>= zeros;
            }
        }
        self
    }

    /// The polynomial with the opposite sign everywhere.
    pub(super) fn negated(mut self) -> Self {
        for c in &mut self.coefficients {
            *c = -std::mem::take(c);
        }
        self
    }

    fn zipped(&self, other: &Self, join: impl Fn(&BigInt, &BigInt) -> BigInt) -> Self {
        let count = self.coefficients.len().max(other.coefficients.len());
        let at = |of: &Self, power: usize| of.coefficients.get(power).cloned().unwrap_or_default();
        Self::new(
            (0..count)
                .map(|power| join(&at(self, power), &at(other, power)))
                .collect(),
        )
    }
}

impl Add for &Polynomial {
    type Output = Polynomial;

    fn add(self, other: Self) -> Polynomial {
        self.zipped(other, |a, b| a + b)
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;

    fn sub(self, other: Self) -> Polynomial {
        self.zipped(other, |a, b| a - b)
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;

    fn mul(self, other: Self) -> Polynomial {
        let count = self.coefficients.len() + other.coefficients.len();
        let mut product = vec![BigInt::ZERO; count];
        for (i, a) in self.coefficients.iter().enumerate() {
            for (j, b) in other.coefficients.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Polynomial::new(product)
    }
}

/// A point or vector that moves.
pub(super) type Vector = [Polynomial; 3];

pub(super) fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|axis| &a[axis] - &b[axis])
}

pub(super) fn plus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|axis| &a[axis] + &b[axis])
}

pub(super) fn dot(a: &Vector, b: &Vector) -> Polynomial {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

pub(super) fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|axis| {
        let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
        &(&a[y] * &b[z]) - &(&a[z] * &b[y])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|&c| c.into()).collect())
    }

    #[test]
    fn arithmetic_is_that_of_polynomials() {
        let (p, q) = (polynomial(&[1, 2]), polynomial(&[-1, 0, 3]));
        assert_eq!(&p + &q, polynomial(&[0, 2, 3]));
        assert_eq!(&p - &p, polynomial(&[]));
        assert_eq!(&p * &q, polynomial(&[-1, -2, 3, 6]));
        assert_eq!((&p * &q).derivative(), polynomial(&[-2, 6, 18]));
        assert_eq!(polynomial(&[24, -36, 0, 0]).halved(), polynomial(&[6, -9]));
        assert!(polynomial(&[7]).derivative().is_zero());
    }

    #[test]
    fn remainders_keep_their_sign_and_are_zero_for_multiples() {
        // t^3 + 2t^2 - t + 5 = (t^2 + 1)(t + 2) + (-2t + 3), for divisors of either sign.
        let p = polynomial(&[5, -1, 2, 1]);
        assert_eq!(p.remainder(&polynomial(&[1, 0, 1])), polynomial(&[3, -2]));
        assert_eq!(p.remainder(&polynomial(&[-1, 0, -1])), polynomial(&[3, -2]));
        assert_eq!(p.remainder(&polynomial(&[-7, 0, -7])), polynomial(&[3 * 49, -2 * 49]));
        let multiple = &p * &polynomial(&[-3, 4]);
        assert!(multiple.remainder(&p).is_zero());
        assert_eq!(polynomial(&[4, 2]).remainder(&p), polynomial(&[2, 1]));
        assert_eq!(polynomial(&[]).remainder(&p), polynomial(&[]));
        assert!(p.remainder(&polynomial(&[-3])).is_zero());
    }

    #[test]
    fn signs_are_exact_at_fractions_and_large_numbers() {
        // (4t - 3)(t - 8)
        let p = polynomial(&[24, -35, 4]);
        let sign = |t: f64| p.sign_at(&t.into());
        assert_eq!((sign(0.75), sign(8.0)), (Sign::NoSign, Sign::NoSign));
        assert_eq!(
            (sign(0.75_f64.next_down()), sign(0.75_f64.next_up())),
            (Sign::Plus, Sign::Minus)
        );
        assert_eq!(
            (sign(8.0_f64.next_up()), sign(1e300), sign(-1e-300)),
            (Sign::Plus, Sign::Plus, Sign::Plus)
        );
        assert_eq!(polynomial(&[]).sign_at(&1.0_f64.into()), Sign::NoSign);
    }
}
