//! Geometry written once for two kinds of numbers: with an error bound first, exactly where that leaves a sign open.

use std::cmp::Ordering;

use glam::DVec3;

/// Half a unit in the last place of 1.
const U: f64 = f64::EPSILON / 2.0;

/// A number that knows whether its sign is certain.
///
/// A test is a function of [`Number`]s that returns `None` as soon as it needs a sign or value that is not certain;
/// it is run with [`Approx`], and, after a `None`, with [`Dyadic`](super::dyadic::Dyadic), which always is.
pub(crate) trait Number: Clone {
    fn new(value: f64) -> Self;
    fn difference(a: f64, b: f64) -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn sign(&self) -> Option<Ordering>;
    /// The quotient to a relative error of at most three [`VALUE_ERROR`]s.
    fn ratio(&self, divisor: &Self) -> Option<f64>;
}

/// The largest relative error of a dividend or divisor of [`Number::ratio`].
pub(crate) const VALUE_ERROR: f64 = 1e-12;

/// An `f64` and a bound on how far it is off the exact value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approx {
    value: f64,
    error: f64,
}

impl Approx {
    /// `rounding` is at least what the operation lost; the factor covers the roundings of the error itself.
    fn with_error(value: f64, carried: f64) -> Self {
        Self {
            value,
            error: (carried + U * value.abs()) * (1.0 + 8.0 * U),
        }
    }
}

impl Number for Approx {
    #[inline]
    fn new(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    #[inline]
    fn difference(a: f64, b: f64) -> Self {
        Self::with_error(a - b, 0.0)
    }

    #[inline]
    fn plus(&self, other: &Self) -> Self {
        Self::with_error(self.value + other.value, self.error + other.error)
    }

    #[inline]
    fn minus(&self, other: &Self) -> Self {
        Self::with_error(self.value - other.value, self.error + other.error)
    }

    #[inline]
    fn times(&self, other: &Self) -> Self {
        let is_zero = |n: &Self| n.value == 0.0 && n.error == 0.0;
        if is_zero(self) || is_zero(other) {
            return Self::new(0.0);
        }
        let carried = self.value.abs() * other.error + self.error * other.value.abs() + self.error * other.error;
        // A product that underflows loses up to half the smallest subnormal, the error's terms each as much.
        Self::with_error(self.value * other.value, carried + f64::from_bits(4))
    }

    #[inline]
    fn sign(&self) -> Option<Ordering> {
        if self.value.abs() > self.error || self.error == 0.0 {
            self.value.partial_cmp(&0.0)
        } else {
            None
        }
    }

    #[inline]
    fn ratio(&self, divisor: &Self) -> Option<f64> {
        let is_known = |n: &Self| n.error <= n.value.abs() * VALUE_ERROR;
        (is_known(self) && is_known(divisor)).then(|| self.value / divisor.value)
    }
}

/// A vector of numbers.
pub(crate) type Vector<N> = [N; 3];

#[inline]
pub(crate) fn vector<N: Number>(v: DVec3) -> Vector<N> {
    v.to_array().map(N::new)
}

/// `a - b`.
#[inline]
pub(crate) fn difference<N: Number>(a: DVec3, b: DVec3) -> Vector<N> {
    [
        N::difference(a.x, b.x),
        N::difference(a.y, b.y),
        N::difference(a.z, b.z),
    ]
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
    std::array::from_fn(|axis| cross_coordinate(a, b, axis))
}
