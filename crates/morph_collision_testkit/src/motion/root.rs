//! Real algebraic numbers: roots of polynomials with integer coefficients.

use std::cmp::Ordering;

use num_bigint::Sign;

use super::polynomial::Polynomial;
use super::remainders::SignedRemainders;
use crate::oracle::Dyadic;

/// An exact real number: the only root of a polynomial in an interval.
#[derive(Clone, Debug)]
pub struct Root {
    polynomial: Polynomial,
    /// Counts roots of the polynomial.
    counter: SignedRemainders,
    /// The root is strictly between these. The polynomial is zero at neither.
    interval: [Dyadic; 2],
}

impl Root {
    /// The distinct roots of a polynomial in `[0, 1]`, in ascending order. None for the zero polynomial.
    pub(super) fn in_unit_interval(polynomial: &Polynomial) -> Vec<Self> {
        if polynomial.is_zero() {
            return Vec::new();
        }
        let polynomial = polynomial.clone().halved();
        let counter = SignedRemainders::new(&polynomial, &Polynomial::one());
        let (zero, one) = (Dyadic::zero(), Dyadic::power_of_two(0));
        // Both ends of an interval that holds [0, 1] and where the polynomial is not zero.
        let beyond = |from: Dyadic, step: f64| {
            let mut end = from;
            loop {
                end = end + step.into();
                if polynomial.sign_at(&end) != Sign::NoSign {
                    return end;
                }
            }
        };
        let mut open = vec![[beyond(zero.clone(), -1.0), beyond(one.clone(), 1.0)]];
        let mut roots = Vec::new();
        while let Some([from, to]) = open.pop() {
            match counter.sum_of_signs(&from, &to) {
                0 => {}
                1 => roots.push(Self {
                    polynomial: polynomial.clone(),
                    counter: counter.clone(),
                    interval: [from, to],
                }),
                _ => {
                    let middle = inside(&polynomial, &from, &to);
                    // The later half is pushed first, so that the earlier one comes out first.
                    open.push([middle.clone(), to]);
                    open.push([from, middle]);
                }
            }
        }
        roots.retain(|root| root.cmp_dyadic(&zero).is_ge() && root.cmp_dyadic(&one).is_le());
        roots
    }

    /// Compares it with a finite number, exactly.
    #[must_use]
    pub fn cmp_f64(&self, number: f64) -> Ordering {
        self.cmp_dyadic(&number.into())
    }

    /// Whether it is in the closed interval, whose ends must be finite.
    #[must_use]
    pub fn is_within(&self, from: f64, to: f64) -> bool {
        self.cmp_f64(from).is_ge() && self.cmp_f64(to).is_le()
    }

    /// The nearest `f64` up to a unit in the last place, or a number below `2^-1000` if it is that small.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        let mut root = self.clone();
        loop {
            let [from, to] = &root.interval;
            if to.to_f64() <= from.to_f64().next_up()
                || from.clone().abs().max(to.clone().abs()) < Dyadic::power_of_two(-1000)
            {
                let middle = from.midpoint(to);
                return middle.to_f64();
            }
            root.refine();
        }
    }

    /// The sign of another polynomial at this number.
    pub(super) fn sign_of(&self, other: &Polynomial) -> Ordering {
        let [from, to] = &self.interval;
        SignedRemainders::new(&self.polynomial, other)
            .sum_of_signs(from, to)
            .cmp(&0)
    }

    fn cmp_dyadic(&self, number: &Dyadic) -> Ordering {
        let [from, to] = &self.interval;
        if number <= from {
            Ordering::Greater
        } else if number >= to {
            Ordering::Less
        } else if self.polynomial.sign_at(number) == Sign::NoSign {
            Ordering::Equal
        } else if self.counter.sum_of_signs(from, number) == 1 {
            Ordering::Less
        } else {
            Ordering::Greater
        }
    }

    /// Cuts the interval about in half.
    fn refine(&mut self) {
        let [from, to] = &self.interval;
        let middle = inside(&self.polynomial, from, to);
        let half = if self.cmp_dyadic(&middle).is_lt() { 1 } else { 0 };
        self.interval[half] = middle;
    }
}

impl Ord for Root {
    fn cmp(&self, other: &Self) -> Ordering {
        let [from, to] = &other.interval;
        // Equal if the other's polynomial is zero here and this is the one root in the other's interval.
        let inside = self.cmp_dyadic(from).is_gt() && self.cmp_dyadic(to).is_lt();
        if inside && self.sign_of(&other.polynomial).is_eq() {
            return Ordering::Equal;
        }
        let (mut a, mut b) = (self.clone(), other.clone());
        loop {
            if a.interval[1] <= b.interval[0] {
                return Ordering::Less;
            }
            if b.interval[1] <= a.interval[0] {
                return Ordering::Greater;
            }
            a.refine();
            b.refine();
        }
    }
}

impl PartialOrd for Root {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Root {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Root {}

/// A number strictly between two others at which the polynomial is not zero: halfway, or a little nearer to the first.
fn inside(polynomial: &Polynomial, from: &Dyadic, to: &Dyadic) -> Dyadic {
    let mut middle = from.midpoint(to);
    while polynomial.sign_at(&middle) == Sign::NoSign {
        middle = middle.midpoint(&from.midpoint(&middle));
    }
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|&c| c.into()).collect())
    }

    fn roots(coefficients: &[i64]) -> Vec<Root> {
        Root::in_unit_interval(&polynomial(coefficients))
    }

    #[test]
    fn roots_at_the_ends_and_in_the_middle_are_found_once() {
        // t (t - 1) (2t - 1)^2
        let p = &(&polynomial(&[0, -1, 1]) * &polynomial(&[-1, 2])) * &polynomial(&[-1, 2]);
        let found = Root::in_unit_interval(&p);
        assert_eq!(found.len(), 3);
        for (root, value) in found.iter().zip([0.0, 0.5, 1.0]) {
            assert!(root.cmp_f64(value).is_eq());
            assert!(root.is_within(value, value));
            assert!(!root.is_within(value.next_up(), 2.0) && !root.is_within(-1.0, value.next_down()));
        }
        assert!(
            roots(&[]).is_empty()
                && roots(&[3]).is_empty()
                && roots(&[-3, 2]).is_empty()
                && roots(&[1, 0, 1]).is_empty()
        );
    }

    #[test]
    fn irrational_roots_compare_exactly() {
        // 2t^2 - 1: the square root of a half is between two neighbouring numbers.
        let [root] = &roots(&[-1, 0, 2])[..] else {
            panic!("one root")
        };
        let near = std::f64::consts::FRAC_1_SQRT_2;
        let [below, above] = if root.cmp_f64(near).is_gt() {
            [near, near.next_up()]
        } else {
            [near.next_down(), near]
        };
        assert!(root.cmp_f64(below).is_gt() && root.cmp_f64(above).is_lt());
        assert!((root.to_f64() - near).abs() < 3e-16);
        // The same number as a root of (2t^2 - 1)(3t - 2)(t - 5), and another a little less than 2/3.
        let same = Root::in_unit_interval(&(&polynomial(&[-1, 0, 2]) * &polynomial(&[10, -17, 3])));
        assert_eq!(same.len(), 2);
        assert!(&same[1] == root && same[0] < *root && same[0] < same[1]);
        let third = &roots(&[-1, 3])[0];
        assert!(third.cmp_f64(1.0 / 3.0).is_ne() && third < root);
    }

    #[test]
    fn signs_at_a_root_are_exact() {
        let root = &roots(&[-1, 0, 2])[0];
        assert!(root.sign_of(&polynomial(&[1, 0, -2])).is_eq());
        assert!(root.sign_of(&polynomial(&[])).is_eq());
        assert!(root.sign_of(&polynomial(&[-5])).is_lt());
        // t - 0.70710678 is positive, t - 0.70710679 is negative.
        assert!(root.sign_of(&polynomial(&[-70_710_678, 100_000_000])).is_gt());
        assert!(root.sign_of(&polynomial(&[-70_710_679, 100_000_000])).is_lt());
    }

    #[test]
    fn roots_closer_than_a_unit_in_the_last_place_are_told_apart() {
        // (2^80 t - 2^79)(2^80 t - 2^79 - 1)
        let whole = |bits: u32| num_bigint::BigInt::from(1) << bits;
        let first = Polynomial::new(vec![-whole(79), whole(80)]);
        let second = Polynomial::new(vec![-whole(79) - 1, whole(80)]);
        let found = Root::in_unit_interval(&(&first * &second));
        assert_eq!(found.len(), 2);
        assert!(found[0].cmp_f64(0.5).is_eq() && found[1].cmp_f64(0.5).is_gt());
        assert!(found[1].cmp_f64(0.5_f64.next_up()).is_lt() && found[0] < found[1]);
    }
}
