//! Polynomials in the time, with integer coefficients.

use std::cmp::Ordering::{self, Equal};

use dashu_int::IBig;
use dashu_int::ops::Gcd;

/// A polynomial. The coefficient of `t^i` is at index `i`, and the last one is not zero. Zero has no coefficients.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Polynomial(Vec<IBig>);

impl Polynomial {
    pub(super) fn new(mut coefficients: Vec<IBig>) -> Self {
        while coefficients.last().is_some_and(IBig::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    /// The linear polynomial with the values `start` at time 0 and `end` at time 1.
    pub(super) fn between(start: &IBig, end: &IBig) -> Self {
        Self::new(vec![start.clone(), end - start])
    }

    pub(super) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// The degree; 0 for zero.
    pub(super) fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        self.combined(other, |a, b| a + b)
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        self.combined(other, |a, b| a - b)
    }

    fn combined(&self, other: &Self, combine: impl Fn(&IBig, &IBig) -> IBig) -> Self {
        let count = self.0.len().max(other.0.len());
        let term = |of: &Self, i: usize| of.0.get(i).cloned().unwrap_or(IBig::ZERO);
        Self::new((0..count).map(|i| combine(&term(self, i), &term(other, i))).collect())
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self(Vec::new());
        }
        let mut product = vec![IBig::ZERO; self.0.len() + other.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Self::new(product)
    }

    /// The sign at the time `numerator / 2^level`.
    pub(super) fn sign_at(&self, numerator: &IBig, level: usize) -> Ordering {
        let mut sum = IBig::ZERO;
        for (i, coefficient) in self.0.iter().rev().enumerate() {
            sum = sum * numerator + (coefficient << (i * level));
        }
        sum.cmp(&IBig::ZERO)
    }

    /// The Bernstein coefficients on the interval of length `2^-level` that starts at `numerator / 2^level`, times a positive
    /// number. One more than the degree.
    pub(super) fn bernstein(&self, numerator: &IBig, level: usize) -> Vec<IBig> {
        let degree = self.degree();
        let scaled = self.0.iter().enumerate();
        let mut shifted: Vec<IBig> = scaled.map(|(i, c)| c << ((degree - i) * level)).collect();
        for first in 0..degree {
            for i in (first..degree).rev() {
                let carried = &shifted[i + 1] * numerator;
                shifted[i] += carried;
            }
        }
        // b_j = sum over i of choose(j, i) / choose(n, i) a_i, times choose(n, 0) ... choose(n, n) to stay whole.
        let all: u32 = (0..=degree).map(|i| choose(degree, i)).product();
        let coefficient = |j: usize| {
            let term = |i: usize| &shifted[i] * IBig::from(all / choose(degree, i) * choose(j, i));
            (0..=j.min(shifted.len().saturating_sub(1))).map(term).sum()
        };
        if shifted.is_empty() {
            return vec![IBig::ZERO];
        }
        (0..=degree).map(coefficient).collect()
    }

    /// The greatest common divisor, up to a constant factor.
    pub(super) fn common_divisor(&self, other: &Self) -> Self {
        let (mut a, mut b) = (self.primitive(), other.primitive());
        if a.degree() < b.degree() {
            (a, b) = (b, a);
        }
        while !b.is_zero() {
            let rest = if b.degree() == 0 {
                Self(Vec::new())
            } else {
                a.divided(&b).1.primitive()
            };
            (a, b) = (b, rest);
        }
        a
    }

    /// A polynomial with the same roots, each of them simple. Not for zero.
    pub(super) fn square_free(&self) -> Self {
        let repeated = self.common_divisor(&self.derivative());
        if repeated.degree() == 0 {
            self.primitive()
        } else {
            self.divided(&repeated).0.primitive()
        }
    }

    fn derivative(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Self::new(terms.map(|(i, c)| c * IBig::from(i)).collect())
    }

    /// The polynomial divided by the greatest common divisor of its coefficients.
    pub(super) fn primitive(&self) -> Self {
        let mut content = IBig::ZERO;
        for coefficient in &self.0 {
            content = if content.is_zero() {
                coefficient.clone()
            } else if coefficient.is_zero() {
                content
            } else {
                (&content).gcd(coefficient).into()
            };
        }
        if content.cmp(&IBig::ZERO) == Equal {
            return self.clone();
        }
        if content < IBig::ZERO {
            content = -content;
        }
        Self(self.0.iter().map(|c| c / &content).collect())
    }

    /// Quotient and rest of this polynomial, times a constant that keeps them whole, by a polynomial that is not zero.
    fn divided(&self, divisor: &Self) -> (Self, Self) {
        let Some(leading) = divisor.0.last() else {
            return (self.clone(), Self(Vec::new()));
        };
        let (mut quotient, mut rest) = (Self(Vec::new()), self.clone());
        while let Some(factor) = rest.0.last().cloned()
            && rest.0.len() >= divisor.0.len()
        {
            let mut term = vec![IBig::ZERO; rest.0.len() - divisor.0.len()];
            term.push(factor);
            let (term, scale) = (Self(term), Self(vec![leading.clone()]));
            rest = scale.times(&rest).minus(&term.times(divisor));
            quotient = scale.times(&quotient).plus(&term);
        }
        (quotient, rest)
    }
}

/// Binomial coefficients of small numbers.
fn choose(n: usize, k: usize) -> u32 {
    const ROWS: [[u32; 5]; 5] = [
        [1, 0, 0, 0, 0],
        [1, 1, 0, 0, 0],
        [1, 2, 1, 0, 0],
        [1, 3, 3, 1, 0],
        [1, 4, 6, 4, 1],
    ];
    ROWS[n][k]
}

/// The Bernstein coefficients on the two halves of an interval, both times the same positive number.
pub(super) fn halves(coefficients: &[IBig]) -> [Vec<IBig>; 2] {
    let degree = coefficients.len() - 1;
    let mut row = coefficients.to_vec();
    let (mut left, mut right) = (Vec::with_capacity(row.len()), Vec::with_capacity(row.len()));
    // Row `i` of the triangle of sums is `2^i` times that of averages.
    for step in 0..=degree {
        left.push(&row[0] << (degree - step));
        right.push(&row[degree - step] << (degree - step));
        for i in 0..degree - step {
            row[i] = &row[i] + &row[i + 1];
        }
    }
    right.reverse();
    [left, right]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|&c| c.into()).collect())
    }

    #[test]
    fn common_divisors_hold_the_common_roots() {
        // (t - 2) (t - 3) (2 t - 1) and (t - 3) (t + 5) (2 t - 1) (t - 7).
        let [a, b, c, d, e] = [&[-2, 1][..], &[-3, 1], &[-1, 2], &[5, 1], &[-7, 1]].map(polynomial);
        let (first, second) = (a.times(&b).times(&c), b.times(&d).times(&c).times(&e));
        let common = first.common_divisor(&second);
        assert!(
            common == b.times(&c) || common == polynomial(&[]).minus(&b.times(&c)),
            "{common:?}"
        );
        assert_eq!(a.common_divisor(&b).degree(), 0);
        assert_eq!(polynomial(&[]).common_divisor(&a).degree(), 1);
    }

    #[test]
    fn square_free_parts_have_simple_roots() {
        let [a, b] = [&[-2, 1][..], &[-1, 3]].map(polynomial);
        let part = a.times(&a).times(&b).square_free();
        assert_eq!(part.degree(), 2);
        assert_eq!(part.sign_at(&2.into(), 0), Equal);
        assert_eq!(a.times(&a).times(&a).times(&a).square_free().degree(), 1);
    }

    #[test]
    fn bernstein_coefficients_are_those_of_the_interval() {
        // t^2 on [1/4, 1/2]: 1/16, 1/8, 1/4.
        let coefficients = polynomial(&[0, 0, 1]).bernstein(&1.into(), 2);
        let unit = coefficients[0].clone();
        assert!(unit > IBig::ZERO);
        assert_eq!(
            coefficients,
            [unit.clone(), &unit * IBig::from(2), &unit * IBig::from(4)]
        );
        // On its halves, [1/4, 3/8] and [3/8, 1/2]: 4/64, 6/64, 9/64 and 9/64, 12/64, 16/64.
        let [left, right] = halves(&coefficients);
        let whole = |numbers: [i64; 3]| numbers.map(|n| &unit * IBig::from(n)).to_vec();
        assert_eq!((left, right), (whole([4, 6, 9]), whole([9, 12, 16])));
    }

    #[test]
    fn signs_at_dyadic_times_are_exact() {
        let cubic = polynomial(&[-3, 0, 0, 24]);
        assert_eq!(cubic.sign_at(&1.into(), 1), Equal);
        assert_eq!(cubic.sign_at(&((1_i64 << 40) + 1).into(), 41), Ordering::Greater);
        assert_eq!(cubic.sign_at(&((1_i64 << 40) - 1).into(), 41), Ordering::Less);
    }
}
