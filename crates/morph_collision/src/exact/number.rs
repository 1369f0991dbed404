//! Geometry that is generic over [`Number`]. It runs with error bounds first, and exactly if that leaves a sign open.

use std::cmp::Ordering;

use glam::DVec3;

/// Half a unit in the last place of 1.
pub(super) const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// `2^exponent`. The result must be a normal number.
pub(crate) const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The largest of some numbers and 0. NaN does not count.
///
/// Written out, because LLVM 22 (rustc 1.97.1) can compile `fold(0.0, f64::max)` incorrectly when it computes the numbers side by
/// side: the largest of three came out as 0.
#[inline]
pub(crate) fn largest<T: PartialOrd + Default>(numbers: impl IntoIterator<Item = T>) -> T {
    let larger = |most, number| if number > most { number } else { most };
    numbers.into_iter().fold(T::default(), larger)
}

/// The largest power of two that is not above a positive number. Dividing by it is exact.
pub(crate) fn power_of_two_below(value: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    const SHIFT: f64 = power_of_two(60);
    if value < f64::MIN_POSITIVE {
        f64::from_bits((value * SHIFT).to_bits() & EXPONENT) / SHIFT
    } else {
        f64::from_bits(value.to_bits() & EXPONENT)
    }
}

/// A number that knows whether its sign is certain.
///
/// A test is a function of [`Number`]s that returns `None` as soon as it needs a sign that is not certain. It runs
/// with [`Approx`] first. If that returns `None`, it runs with [`Dyadic`](super::dyadic::Dyadic), which is always certain.
pub(crate) trait Number: Clone {
    /// The number `value`, which must be finite.
    fn new(value: f64) -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn sign(&self) -> Option<Ordering>;
}

/// An `f64` and a bound on its error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approx {
    value: f64,
    error: f64,
}

impl Approx {
    /// The result of an operation. Adds the rounding of `value` to the carried error; the factor covers the roundings of the
    /// error itself.
    fn rounded(value: f64, carried: f64) -> Self {
        Self {
            value,
            error: (carried + UNIT_ROUNDOFF * value.abs()) * (1.0 + 8.0 * UNIT_ROUNDOFF),
        }
    }
}

impl Number for Approx {
    #[inline]
    fn new(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    #[inline]
    fn plus(&self, other: &Self) -> Self {
        Self::rounded(self.value + other.value, self.error + other.error)
    }

    #[inline]
    fn minus(&self, other: &Self) -> Self {
        Self::rounded(self.value - other.value, self.error + other.error)
    }

    #[inline]
    fn times(&self, other: &Self) -> Self {
        let is_zero = |n: &Self| n.value == 0.0 && n.error == 0.0;
        if is_zero(self) || is_zero(other) {
            return Self::new(0.0);
        }
        let carried = self.value.abs() * other.error + self.error * other.value.abs() + self.error * other.error;
        // The product and the three terms above can each lose half the smallest subnormal to underflow. This adds four
        // subnormals.
        Self::rounded(self.value * other.value, carried + f64::from_bits(4))
    }

    #[inline]
    fn sign(&self) -> Option<Ordering> {
        let is_certain = self.value.abs() > self.error || self.error == 0.0;
        if is_certain { self.value.partial_cmp(&0.0) } else { None }
    }
}

pub(crate) type Vector<N> = [N; 3];

#[inline]
pub(crate) fn vector<N: Number>(v: DVec3) -> Vector<N> {
    [N::new(v.x), N::new(v.y), N::new(v.z)]
}

/// `a - b`.
#[inline]
pub(crate) fn difference<N: Number>(a: DVec3, b: DVec3) -> Vector<N> {
    let along = |a, b| N::new(a).minus(&N::new(b));
    [along(a.x, b.x), along(a.y, b.y), along(a.z, b.z)]
}

#[inline]
pub(crate) fn dot<N: Number>(a: &Vector<N>, b: &Vector<N>) -> N {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

/// One coordinate of the cross product.
#[inline]
pub(crate) fn cross_coordinate<N: Number>(a: &Vector<N>, b: &Vector<N>, axis: usize) -> N {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    a[i].times(&b[j]).minus(&a[j].times(&b[i]))
}

#[inline]
pub(crate) fn cross<N: Number>(a: &Vector<N>, b: &Vector<N>) -> Vector<N> {
    [
        cross_coordinate(a, b, 0),
        cross_coordinate(a, b, 1),
        cross_coordinate(a, b, 2),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_found_for_numbers_of_every_size() {
        for (value, power) in [
            (1.0, 1.0),
            (3.9, 2.0),
            (0.3, 0.25),
            (5e-324, 5e-324),
            (f64::MAX, power_of_two(1023)),
        ] {
            assert_eq!(power_of_two_below(value), power);
        }
        assert_eq!(power_of_two(-3), 0.125);
    }

    #[test]
    fn one_rounding_adds_half_a_unit_in_the_last_place_and_next_to_nothing() {
        let sum = Approx::new(0.1).plus(&Approx::new(0.2));
        assert_eq!(sum.sign(), Some(Ordering::Greater));
        let share = sum.error / (2.0_f64.powi(-53) * 0.3);
        assert!((1.0..1.0 + 1e-12).contains(&share), "{share}");
    }

    #[test]
    fn errors_grow_with_factors_and_vanish_only_in_products_with_zero() {
        // The sum is rounded to 1, so the second term is lost.
        let lost = Approx::new(1.0)
            .plus(&Approx::new(UNIT_ROUNDOFF))
            .minus(&Approx::new(1.0));
        let (zero, factor) = (Approx::new(0.0), Approx::new(1024.0));
        for product in [lost.times(&factor), factor.times(&lost)] {
            assert_eq!((product.value, product.sign()), (0.0, None));
            assert!(product.error >= 1024.0 * UNIT_ROUNDOFF, "{product:?}");
        }
        for product in [lost.times(&zero), zero.times(&lost)] {
            assert_eq!(product.sign(), Some(Ordering::Equal));
        }
        let share = lost.times(&lost).error / (UNIT_ROUNDOFF * UNIT_ROUNDOFF);
        assert!((1.0..1.0 + 1e-12).contains(&share), "{share}");
    }

    #[test]
    fn errors_add_up_in_differences_and_cover_underflow() {
        let lost = Approx::new(1.0)
            .plus(&Approx::new(UNIT_ROUNDOFF))
            .minus(&Approx::new(1.0));
        assert_eq!(lost.minus(&lost).sign(), None);
        assert_eq!(Approx::new(1e-200).times(&Approx::new(1e-200)).sign(), None);
    }
}
