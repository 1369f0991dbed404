//! Roots of integer polynomials in [0, 1]: isolated, refined and compared with zeros of other polynomials.

use std::cmp::Ordering::{self, Equal, Greater, Less};

use dashu_int::IBig;

use super::moving::TimeOfImpact;
use super::polynomial::{Polynomial, halves};

/// A root of a polynomial that is simple, or at an end of [0, 1].
#[derive(Clone, Debug)]
pub(super) struct Root {
    polynomial: Polynomial,
    /// The root is in the open interval of length `2^-level` that starts at `start / 2^level`, or it is its start.
    start: IBig,
    level: usize,
    location: Location,
}

#[derive(Clone, Debug)]
enum Location {
    Start,
    /// The polynomial's Bernstein coefficients on the interval, which have one change of sign.
    Inside(Vec<IBig>),
}

impl Root {
    /// Time 0, whether a polynomial is zero there or not.
    pub(super) fn zero() -> Self {
        Self {
            polynomial: Polynomial::new(Vec::new()),
            start: IBig::ZERO,
            level: 0,
            location: Location::Start,
        }
    }

    /// The sign of a polynomial at the root. Halves the interval as often as needed.
    pub(super) fn sign_of(&mut self, other: &Polynomial) -> Ordering {
        // The level at which to search for a common root, which costs more than halving. Most signs are certain by then.
        const SHORT: usize = 10;
        if matches!(self.location, Location::Start) {
            return other.sign_at(&self.start, self.level);
        }
        let mut coefficients = other.bernstein(&self.start, self.level);
        let mut may_be_zero = true;
        loop {
            if matches!(self.location, Location::Start) {
                return other.sign_at(&self.start, self.level);
            }
            if let Some(sign) = common_sign(&coefficients) {
                return sign;
            }
            if may_be_zero && self.level >= SHORT {
                if self.is_root_of(other) {
                    return Equal;
                }
                may_be_zero = false;
            }
            let [left, right] = halves(&coefficients);
            coefficients = if self.halve() == Less { left } else { right };
        }
    }

    /// Whether a polynomial is zero at the root, which is inside its interval.
    fn is_root_of(&self, other: &Polynomial) -> bool {
        // In the interval, the divisor has no root but this one, and only a simple one. Then the number of changes is odd.
        let common = self.polynomial.common_divisor(other);
        common.degree() > 0 && variations(&common.bernstein(&self.start, self.level)) % 2 == 1
    }

    /// Halves the interval. `Less` if the root is in the left half.
    fn halve(&mut self) -> Ordering {
        let Location::Inside(coefficients) = &self.location else {
            return Equal;
        };
        let [left, right] = halves(coefficients);
        let middle = &self.start * IBig::from(2) + IBig::ONE;
        let is_left = variations(&left) == 1;
        let is_middle = right.first().is_none_or(IBig::is_zero);
        self.level += 1;
        (self.start, self.location) = if is_middle {
            (middle, Location::Start)
        } else if is_left {
            (middle - IBig::ONE, Location::Inside(left))
        } else {
            (middle, Location::Inside(right))
        };
        if is_left && !is_middle { Less } else { Greater }
    }

    /// An interval of `f64`s around the root. Not longer than `tolerance`, or its ends are neighbours.
    pub(super) fn bracket(&self, tolerance: f64) -> TimeOfImpact {
        // Halvings of the interval itself. After them, halve the range of bits, which ends soon for roots near 0, too.
        const ARITHMETIC: usize = 60;
        let (mut earliest, mut latest) = (0.0_f64, 1.0_f64);
        for halving in 0.. {
            if latest - earliest <= tolerance || earliest.next_up() >= latest {
                break;
            }
            let bits = (earliest.to_bits() + latest.to_bits()) / 2;
            let middle = if halving < ARITHMETIC {
                earliest.midpoint(latest)
            } else {
                f64::from_bits(bits)
            };
            match self.compared_with(middle) {
                Less => latest = middle,
                Greater => earliest = middle,
                Equal => {
                    return TimeOfImpact {
                        earliest: middle,
                        latest: middle,
                    };
                }
            }
        }
        // The ends of [0, 1] are never a middle.
        for end in [earliest, latest] {
            if self.compared_with(end) == Equal {
                return TimeOfImpact {
                    earliest: end,
                    latest: end,
                };
            }
        }
        TimeOfImpact { earliest, latest }
    }

    /// On which side of a time from 0 to 1 the root is.
    fn compared_with(&self, time: f64) -> Ordering {
        let (numerator, level) = fraction(time);
        // The start and end of the interval, and the time, as multiples of the same power of two.
        let common = level.max(self.level);
        let start = &self.start << (common - self.level);
        let end = (&self.start + IBig::ONE) << (common - self.level);
        let scaled = &numerator << (common - level);
        match &self.location {
            Location::Start => start.cmp(&scaled),
            Location::Inside(_) if scaled <= start => Greater,
            Location::Inside(_) if scaled >= end => Less,
            Location::Inside(coefficients) => match self.polynomial.sign_at(&numerator, level) {
                Equal => Equal,
                // The sign to the left of the root is that of the first coefficient that is not zero.
                sign if Some(sign) == first_sign(coefficients) => Greater,
                _ => Less,
            },
        }
    }
}

/// A time from 0 to 1 as a whole number over a power of two.
fn fraction(time: f64) -> (IBig, usize) {
    const FRACTION_BITS: u32 = 52;
    if time == 0.0 {
        return (IBig::ZERO, 0);
    }
    let bits = time.to_bits();
    let fraction = bits & ((1 << FRACTION_BITS) - 1);
    let (numerator, level) = match bits >> FRACTION_BITS {
        0 => (fraction, 1074),
        biased => (fraction | 1 << FRACTION_BITS, 1075 - biased as usize),
    };
    let zeros = (numerator.trailing_zeros().min(63) as usize).min(level);
    (IBig::from(numerator >> zeros), level - zeros)
}

/// The roots of a polynomial in [0, 1], in ascending order. None for zero.
///
/// Descartes' rule of signs on Bernstein coefficients, and bisection. It ends, because the roots of the square-free part are simple
/// (Collins and Akritas 1976).
pub(super) fn roots(polynomial: &Polynomial) -> Vec<Root> {
    if polynomial.degree() == 0 {
        return Vec::new();
    }
    let mut simple = polynomial.primitive();
    let mut whole = simple.bernstein(&IBig::ZERO, 0);
    // With at most one change of sign, roots between 0 and 1 are simple, and those at 0 and 1 need not be.
    if variations(&whole) > 1 {
        simple = polynomial.square_free();
        whole = simple.bernstein(&IBig::ZERO, 0);
    }
    let root = |start: IBig, level, location| Root {
        polynomial: simple.clone(),
        start,
        level,
        location,
    };
    let mut found = Vec::new();
    if whole.first().is_some_and(IBig::is_zero) {
        found.push(root(IBig::ZERO, 0, Location::Start));
    }
    let ends_in_root = whole.last().is_some_and(IBig::is_zero);
    let mut open = vec![(IBig::ZERO, 0, whole)];
    while let Some((start, level, coefficients)) = open.pop() {
        // A root at the start of an interval that is not the first.
        let is_half = level > 0 && start.clone() % IBig::from(2) == IBig::ONE;
        if is_half && coefficients.first().is_some_and(IBig::is_zero) {
            found.push(root(start.clone(), level, Location::Start));
        }
        match variations(&coefficients) {
            0 => {}
            1 => found.push(root(start, level, Location::Inside(coefficients))),
            _ => {
                let [left, right] = halves(&coefficients);
                let middle = start * IBig::from(2) + IBig::ONE;
                open.push((middle.clone(), level + 1, right));
                open.push((middle - IBig::ONE, level + 1, left));
            }
        }
    }
    if ends_in_root {
        found.push(root(IBig::ONE, 0, Location::Start));
    }
    found
}

/// The number of changes of sign, without zeros.
fn variations(coefficients: &[IBig]) -> usize {
    let signs: Vec<bool> = coefficients
        .iter()
        .filter(|c| !c.is_zero())
        .map(|c| *c > IBig::ZERO)
        .collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

fn first_sign(coefficients: &[IBig]) -> Option<Ordering> {
    coefficients
        .iter()
        .map(|c| c.cmp(&IBig::ZERO))
        .find(|sign| *sign != Equal)
}

/// The sign on the whole open interval, if the coefficients show that it is the same everywhere.
fn common_sign(coefficients: &[IBig]) -> Option<Ordering> {
    match first_sign(coefficients) {
        None => Some(Equal),
        sign => (variations(coefficients) == 0).then_some(sign).flatten(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|&c| c.into()).collect())
    }

    fn product(factors: &[&[i64]]) -> Polynomial {
        let one = polynomial(&[1]);
        factors
            .iter()
            .fold(one, |product, factor| product.times(&polynomial(factor)))
    }

    fn values(polynomial: &Polynomial) -> Vec<f64> {
        let brackets = roots(polynomial)
            .iter()
            .map(|root| root.bracket(0.0))
            .collect::<Vec<_>>();
        for bracket in &brackets {
            let width = bracket.latest.to_bits() - bracket.earliest.to_bits();
            assert!(width <= 1, "{bracket:?}");
        }
        brackets.iter().map(|bracket| bracket.earliest).collect()
    }

    #[test]
    fn every_root_is_found_once_in_order() {
        let at = |factors: &[&[i64]]| values(&product(factors));
        assert_eq!(at(&[&[0, 1], &[-1, 2], &[-1, 1]]), [0.0, 0.5, 1.0]);
        assert_eq!(at(&[&[-1, 4], &[-1, 2], &[-3, 4], &[-1, 8]]), [0.125, 0.25, 0.5, 0.75]);
        assert_eq!(at(&[&[-1, 3], &[-1, 3], &[-2, 1]]), [1.0_f64 / 3.0]);
        assert_eq!(at(&[&[1, 1], &[-3, 2]]), [0.0; 0]);
        assert_eq!(at(&[&[1, 0, 1]]), [0.0; 0]);
        assert_eq!(at(&[&[0, 1], &[0, 1], &[-1, 1]]), [0.0, 1.0]);
        assert_eq!(values(&polynomial(&[])), [0.0; 0]);
        // The root of 2 t^2 - 1, rounded down.
        assert_eq!(at(&[&[-1, 0, 2]]), [0.5_f64.sqrt().next_down()]);
    }

    #[test]
    fn roots_closer_than_neighbouring_floats_are_told_apart() {
        let n = 1_i64 << 61;
        let near = product(&[&[-n, 3 * n + 1], &[-1, 3]]);
        let found = roots(&near);
        assert_eq!(found.len(), 2);
        let [first, mut second] = <[Root; 2]>::try_from(found).unwrap();
        assert_eq!(second.sign_of(&polynomial(&[-1, 3])), Equal);
        assert_eq!(second.sign_of(&polynomial(&[-n, 3 * n + 1])), Greater);
        assert_eq!(first.clone().sign_of(&polynomial(&[-1, 3])), Less);
    }

    #[test]
    fn signs_at_roots_are_exact() {
        let mut root = roots(&polynomial(&[-1, 0, 2])).remove(0);
        assert_eq!(root.sign_of(&product(&[&[-1, 0, 2], &[5, 1]])), Equal);
        assert_eq!(root.sign_of(&polynomial(&[])), Equal);
        assert_eq!(root.sign_of(&polynomial(&[-7])), Less);
        // 665857/470832 is larger than the square root of 2 by less than 2e-12.
        assert_eq!(root.sign_of(&polynomial(&[-665_857, 941_664])), Less);
        assert_eq!(root.sign_of(&polynomial(&[-665_855, 941_664])), Greater);
        let mut zero = Root::zero();
        assert_eq!(
            (zero.sign_of(&polynomial(&[0, 1])), zero.sign_of(&polynomial(&[2, -9]))),
            (Equal, Greater)
        );
    }

    #[test]
    fn roots_next_to_zero_have_short_brackets() {
        // 2^-1074 is the smallest float; the root 2^-1500 is below it, and 2^-1000 is a float.
        let power = |exponent: usize| Polynomial::new(vec![IBig::from(-1), IBig::ONE << exponent]);
        let tiny = f64::from_bits(1);
        assert_eq!(
            roots(&power(1500))[0].bracket(0.0),
            TimeOfImpact {
                earliest: 0.0,
                latest: tiny
            }
        );
        let exact = 2.0_f64.powi(-1000);
        assert_eq!(
            roots(&power(1000))[0].bracket(0.0),
            TimeOfImpact {
                earliest: exact,
                latest: exact
            }
        );
        let wide = roots(&power(1000))[0].bracket(0.125);
        assert_eq!(
            wide,
            TimeOfImpact {
                earliest: 0.0,
                latest: 0.125
            }
        );
    }
}
