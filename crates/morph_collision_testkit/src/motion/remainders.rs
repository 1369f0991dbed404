//! Signed remainder sequences: how often, and with which signs of another polynomial, a polynomial has roots in an interval.

use num_bigint::Sign;

use super::polynomial::Polynomial;
use crate::oracle::Dyadic;

/// The signed remainder sequence of `p` and `p' q`: each member is minus the remainder of the two before it, up to a positive
/// factor. `p' q` is replaced by its remainder, which has the same values at the roots of `p`, up to that factor.
///
/// Sturm's theorem, in Tarski's form: if `p` is zero neither at `from` nor at `to`, the sign changes lost between them are the sum,
/// over the distinct roots of `p` in between, of the sign of `q` there. For `q = 1` this counts the roots.
#[derive(Clone, Debug)]
pub(super) struct SignedRemainders(Vec<Polynomial>);

impl SignedRemainders {
    /// The sequence for `p`, which must not be zero, and `q`.
    pub(super) fn new(p: &Polynomial, q: &Polynomial) -> Self {
        let mut sequence = vec![p.clone()];
        let mut next = (&p.derivative() * &q.remainder(p)).remainder(p);
        while !next.is_zero() {
            let last = &sequence[sequence.len() - 1];
            let remainder = last.remainder(&next).negated();
            sequence.push(next);
            next = remainder;
        }
        Self(sequence)
    }

    /// The sum of the signs of `q` over the distinct roots of `p` between two numbers that are no roots of `p`.
    pub(super) fn sum_of_signs(&self, from: &Dyadic, to: &Dyadic) -> i64 {
        self.sign_changes(from) - self.sign_changes(to)
    }

    fn sign_changes(&self, t: &Dyadic) -> i64 {
        let mut signs = self.0.iter().map(|p| p.sign_at(t)).filter(|&sign| sign != Sign::NoSign);
        let mut last = signs.next();
        let mut changes = 0;
        for sign in signs {
            changes += i64::from(last != Some(sign));
            last = Some(sign);
        }
        changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear(root_times: i64, factor: i64) -> Polynomial {
        Polynomial::new(vec![(-root_times).into(), factor.into()])
    }

    #[test]
    fn distinct_roots_are_counted_once_with_the_sign_of_another_polynomial() {
        // Roots 1, 2 (three times) and 5.
        let p = [1, 2, 2, 2, 5]
            .iter()
            .fold(Polynomial::one(), |p, &root| &p * &linear(root, 1));
        let sum =
            |q: &Polynomial, from: f64, to: f64| SignedRemainders::new(&p, q).sum_of_signs(&from.into(), &to.into());
        assert_eq!(sum(&Polynomial::one(), 0.0, 6.0), 3);
        assert_eq!(sum(&Polynomial::one(), 1.5, 2.5), 1);
        assert_eq!(sum(&Polynomial::one(), 2.5, 4.5), 0);
        // 2t - 3 is negative at 1 and positive at 2 and 5; (t - 2)(t - 4) is positive, zero, positive.
        assert_eq!(sum(&linear(3, 2), 0.0, 6.0), 1);
        assert_eq!(sum(&linear(3, 2), 0.0, 1.5), -1);
        let q = &linear(2, 1) * &linear(4, 1);
        assert_eq!(sum(&q, 0.0, 6.0), 2);
        assert_eq!(sum(&q, 1.5, 2.5), 0);
        assert_eq!(sum(&Polynomial::new(Vec::new()), 0.0, 6.0), 0);
    }
}
