use glam::DVec3;

use super::dyadic::Dyadic;
use super::triangles::triangles_intersect;

/// A vector of exact coordinates.
type Vector = [Dyadic; 3];

/// A quotient of exact numbers, with a positive divisor.
#[derive(Clone)]
struct Fraction {
    dividend: Dyadic,
    divisor: Dyadic,
}

/// The smallest `t >= 0` at which `origin + t direction` is on a closed triangle, rounded to the nearest `f64`; `None` if the ray misses
/// it. The triangle may be a segment or a point. The direction is not zero.
pub fn ray_parameter(origin: DVec3, direction: DVec3, triangle: &[DVec3; 3]) -> Option<f64> {
    let d = exact(direction);
    let [a, b, c] = *triangle;
    let (u, v) = (minus(b, a), minus(c, a));
    let normal = cross(&u, &v);
    let speed = dot(&d, &normal);
    let to_a = minus(a, origin);
    let first = if is_zero(&speed) {
        edge_on(origin, &d, triangle)
    } else {
        // Cramer's rule for `t d - y u - z v = a - origin`.
        let t = fraction(dot(&to_a, &normal), speed.clone());
        let y = fraction(dot(&cross(&v, &to_a), &d), speed.clone());
        let z = fraction(dot(&cross(&to_a, &u), &d), speed);
        let sum = Fraction {
            dividend: y.dividend.clone() + z.dividend.clone(),
            divisor: y.divisor.clone(),
        };
        let is_met = !t.is_negative() && !y.is_negative() && !z.is_negative() && sum.dividend <= sum.divisor;
        is_met.then_some(t)
    };
    first.map(|t| t.rounded())
}

/// The first parameter if the ray lies in the triangle's plane or the triangle has none.
fn edge_on(origin: DVec3, d: &Vector, triangle: &[DVec3; 3]) -> Option<Fraction> {
    if triangles_intersect(&[origin; 3], triangle) {
        return Some(fraction(Dyadic::zero(), Dyadic::from(1.0)));
    }
    let [a, b, c] = *triangle;
    let entries = [[a, b], [b, c], [c, a]]
        .into_iter()
        .filter_map(|edge| on_segment(origin, d, edge));
    entries.reduce(|x, y| if y.is_less_than(&x) { y } else { x })
}

/// The first parameter at which the ray is on a closed segment, which may be a point.
fn on_segment(origin: DVec3, d: &Vector, [p, q]: [DVec3; 2]) -> Option<Fraction> {
    let (to_p, to_q, edge) = (minus(p, origin), minus(q, origin), minus(q, p));
    let across = cross(d, &edge);
    if across.iter().all(is_zero) {
        // Parallel, or a point: on the ray's line, or nowhere.
        if !cross(&to_p, d).iter().all(is_zero) {
            return None;
        }
        let ends = [&to_p, &to_q].map(|to| fraction(dot(to, d), dot(d, d)));
        let ahead = ends.iter().filter(|end| !end.is_negative()).cloned();
        let first = ahead.reduce(|x, y| if y.is_less_than(&x) { y } else { x })?;
        let starts_inside = ends.iter().any(Fraction::is_negative);
        return Some(if starts_inside {
            fraction(Dyadic::zero(), Dyadic::from(1.0))
        } else {
            first
        });
    }
    if !is_zero(&dot(&to_p, &across)) {
        return None;
    }
    // `t d - s edge = to_p`.
    let squared = dot(&across, &across);
    let t = fraction(dot(&cross(&to_p, &edge), &across), squared.clone());
    let s = fraction(dot(&cross(&to_p, d), &across), squared);
    (!t.is_negative() && !s.is_negative() && s.dividend <= s.divisor).then_some(t)
}

impl Fraction {
    fn is_negative(&self) -> bool {
        self.dividend.is_negative()
    }

    fn is_less_than(&self, other: &Self) -> bool {
        self.dividend.clone() * other.divisor.clone() < other.dividend.clone() * self.divisor.clone()
    }

    /// The nearest `f64`; of two that are equally near, the one with an even last digit.
    fn rounded(&self) -> f64 {
        let nearly = self.dividend.ratio(&self.divisor);
        let off = |value: f64| (Dyadic::from(value) * self.divisor.clone() - self.dividend.clone()).abs();
        let mut best = (off(nearly), nearly);
        let (mut lower, mut higher) = (nearly, nearly);
        for _ in 0..4 {
            (lower, higher) = (lower.next_down(), higher.next_up());
            for value in [lower, higher] {
                let off = off(value);
                if off < best.0 || off == best.0 && value.to_bits() % 2 == 0 {
                    best = (off, value);
                }
            }
        }
        best.1
    }
}

/// A fraction with a positive divisor.
fn fraction(dividend: Dyadic, divisor: Dyadic) -> Fraction {
    if divisor.is_negative() {
        return Fraction {
            dividend: -dividend,
            divisor: -divisor,
        };
    }
    Fraction { dividend, divisor }
}

fn exact(v: DVec3) -> Vector {
    v.to_array().map(Dyadic::from)
}

fn minus(a: DVec3, b: DVec3) -> Vector {
    std::array::from_fn(|i| Dyadic::from(a[i]) - Dyadic::from(b[i]))
}

fn dot(a: &Vector, b: &Vector) -> Dyadic {
    (0..3).map(|i| a[i].clone() * b[i].clone()).sum()
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i].clone() * b[j].clone() - a[j].clone() * b[i].clone()
    })
}

fn is_zero(number: &Dyadic) -> bool {
    *number == Dyadic::zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn rays_meet_the_inside_the_edges_and_the_corners_of_a_triangle() {
        let above = |x: f64, y: f64| ray_parameter(DVec3::new(x, y, 3.0), DVec3::NEG_Z, &TRIANGLE);
        for (x, y) in [(0.25, 0.25), (0.5, 0.5), (0.0, 0.0), (1.0, 0.0), (0.0, 0.5)] {
            assert_eq!(above(x, y), Some(3.0), "{x} {y}");
        }
        assert_eq!(above(0.5, 0.5_f64.next_up()), None);
        assert_eq!(ray_parameter(DVec3::Z, DVec3::Z, &TRIANGLE), None);
        // A third, rounded to the nearest.
        let slow = ray_parameter(DVec3::new(0.25, 0.25, 1.0), DVec3::NEG_Z * 3.0, &TRIANGLE);
        assert_eq!(slow, Some(1.0 / 3.0));
    }

    #[test]
    fn rays_in_the_plane_enter_through_an_edge() {
        let from_left = |y: f64| ray_parameter(DVec3::new(-1.0, y, 0.0), DVec3::X, &TRIANGLE);
        assert_eq!(
            [0.0, 0.5, 1.0, 2.0].map(from_left),
            [Some(1.0), Some(1.0), Some(1.0), None]
        );
        assert_eq!(ray_parameter(DVec3::new(0.2, 0.2, 0.0), DVec3::X, &TRIANGLE), Some(0.0));
        assert_eq!(
            ray_parameter(DVec3::new(0.2, 0.0, 0.0), DVec3::NEG_X, &TRIANGLE),
            Some(0.0)
        );
        assert_eq!(ray_parameter(DVec3::new(0.2, 0.2, 0.1), DVec3::X, &TRIANGLE), None);
    }

    #[test]
    fn rays_meet_triangles_without_area() {
        let segment = [DVec3::X, DVec3::X * 3.0, DVec3::X * 2.0];
        assert_eq!(ray_parameter(DVec3::ZERO, DVec3::X, &segment), Some(1.0));
        assert_eq!(ray_parameter(DVec3::X * 5.0, DVec3::NEG_X, &segment), Some(2.0));
        assert_eq!(
            ray_parameter(DVec3::new(2.5, 2.0, 0.0), DVec3::NEG_Y, &segment),
            Some(2.0)
        );
        assert_eq!(ray_parameter(DVec3::new(2.5, 2.0, 1.0), DVec3::NEG_Y, &segment), None);
        let point = [DVec3::X; 3];
        assert_eq!(ray_parameter(DVec3::ZERO, DVec3::X * 4.0, &point), Some(0.25));
        assert_eq!(ray_parameter(DVec3::ZERO, DVec3::NEG_X, &point), None);
    }
}
