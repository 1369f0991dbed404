//! Bernstein coefficients of polynomials in the time, rounded to `f64`.

use glam::DVec3;

/// A vector that moves from the first value to the second.
pub(super) type Linear = [DVec3; 2];
/// The Bernstein coefficients of a vector of degree 2.
pub(super) type Quadratic = [DVec3; 3];

#[inline(always)]
pub(super) fn cross(a: &Linear, b: &Linear) -> Quadratic {
    let middle = (a[0].cross(b[1]) + a[1].cross(b[0])) * 0.5;
    [a[0].cross(b[0]), middle, a[1].cross(b[1])]
}

#[inline(always)]
pub(super) fn dot_linear(a: &Quadratic, b: &Linear) -> [f64; 4] {
    const THIRD: f64 = 1.0 / 3.0;
    [
        a[0].dot(b[0]),
        (a[0].dot(b[1]) + 2.0 * a[1].dot(b[0])) * THIRD,
        (2.0 * a[1].dot(b[1]) + a[2].dot(b[0])) * THIRD,
        a[2].dot(b[1]),
    ]
}

#[inline(always)]
pub(super) fn dot_quadratic(a: &Quadratic, b: &Quadratic) -> [f64; 5] {
    const SIXTH: f64 = 1.0 / 6.0;
    [
        a[0].dot(b[0]),
        (a[0].dot(b[1]) + a[1].dot(b[0])) * 0.5,
        (a[0].dot(b[2]) + 4.0 * a[1].dot(b[1]) + a[2].dot(b[0])) * SIXTH,
        (a[1].dot(b[2]) + a[2].dot(b[1])) * 0.5,
        a[2].dot(b[2]),
    ]
}

/// The coefficients of `L` polynomials on the two halves of an interval (de Casteljau). `N` is one more than the degree.
#[inline(always)]
pub(super) fn halves<const N: usize, const L: usize>(coefficients: &[[f64; L]; N]) -> [[[f64; L]; N]; 2] {
    let (mut left, mut right) = (*coefficients, *coefficients);
    for (step, first) in left.iter_mut().enumerate().skip(1) {
        for i in 0..N - step {
            right[i] = std::array::from_fn(|lane| (right[i][lane] + right[i + 1][lane]) * 0.5);
        }
        *first = right[0];
    }
    [left, right]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_the_polynomial_on_half_the_interval() {
        // t^2 and 1 - t.
        let [left, right] = halves(&[[0.0, 1.0], [0.0, 0.5], [1.0, 0.0]]);
        assert_eq!(left, [[0.0, 1.0], [0.0, 0.75], [0.25, 0.5]]);
        assert_eq!(right, [[0.25, 0.5], [0.5, 0.25], [1.0, 0.0]]);
    }

    #[test]
    fn products_have_the_values_of_their_factors() {
        let lines = [
            [1.0, 2.0, -3.0, 5.0, 0.5, 2.0],
            [4.0, -1.0, 2.0, 0.0, 3.0, 1.0],
            [-2.0, 1.0, 7.0, 2.0, 2.0, -1.0],
        ];
        let [a, b, c] = lines.map(|[x, y, z, u, v, w]| [DVec3::new(x, y, z), DVec3::new(u, v, w)]);
        let at = |linear: &Linear| (linear[0] + linear[1]) * 0.5;
        let (normal, other) = (cross(&a, &b), cross(&b, &c));
        let (cubic, quartic) = (dot_linear(&normal, &c), dot_quadratic(&normal, &other));
        let middle = |[left, _]: [[[f64; 1]; 5]; 2]| left[4][0];
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        let exact = at(&a).cross(at(&b));
        near(middle(halves(&quartic.map(|c| [c]))), exact.dot(at(&b).cross(at(&c))));
        near(halves(&cubic.map(|c| [c]))[0][3][0], exact.dot(at(&c)));
    }
}
