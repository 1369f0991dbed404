//! When the origin is in a moving triangle.

use super::polynomial::{Polynomial, Vector, cross, dot, plus};
use super::root::Root;

/// Everything whose sign says whether the origin is in the closed triangle `u, v, w`, as polynomials in time.
///
/// Let `A = v x w`, `B = w x u`, `C = u x v` and `N = A + B + C`, which is the triangle's normal.
///
/// - The origin is on the segment from `u` to `v` exactly if `u x v = 0` and `u . v <= 0`. This holds for points, too.
/// - If `N` is not zero, the origin is in the triangle's plane exactly if `det(u, v, w) = 0`, because `u . N` is the determinant.
///   Its barycentric coordinates then are `A . N`, `B . N` and `C . N`, divided by `N . N`.
/// - If `N` is zero, the triangle is the union of its edges.
#[derive(Clone, Debug)]
pub(super) struct OriginInTriangle {
    determinant: Polynomial,
    /// `N . N`.
    normal_squared: Polynomial,
    /// `A . N`, `B . N`, `C . N`.
    sides: [Polynomial; 3],
    edges: [OriginOnSegment; 3],
}

/// The same for a segment.
#[derive(Clone, Debug)]
struct OriginOnSegment {
    /// `(u x v) . (u x v)`.
    cross_squared: Polynomial,
    /// `u . v`.
    dot: Polynomial,
}

impl OriginInTriangle {
    /// For corners that move linearly.
    fn new([u, v, w]: &[Vector; 3]) -> Self {
        let crosses = [cross(v, w), cross(w, u), cross(u, v)];
        let [a, b, c] = &crosses;
        let normal = plus(&plus(a, b), c);
        let edge = |i: usize, p: &Vector, q: &Vector| OriginOnSegment {
            cross_squared: dot(&crosses[i], &crosses[i]).halved(),
            dot: dot(p, q).halved(),
        };
        Self {
            determinant: dot(u, a).halved(),
            normal_squared: dot(&normal, &normal).halved(),
            sides: [a, b, c].map(|part| dot(part, &normal).halved()),
            edges: [edge(0, v, w), edge(1, w, u), edge(2, u, v)],
        }
    }

    /// Polynomials whose roots hold all times at which the answer changes.
    fn all(&self) -> Vec<&Polynomial> {
        let edges = self.edges.iter().flat_map(|edge| [&edge.cross_squared, &edge.dot]);
        [&self.determinant, &self.normal_squared]
            .into_iter()
            .chain(&self.sides)
            .chain(edges)
            .collect()
    }

    /// The first contact at time 0 or at a root of some polynomials.
    fn first_among(&self, polynomials: &[&Polynomial]) -> Option<Root> {
        let start = Root::in_unit_interval(&Polynomial::new(vec![0.into(), 1.into()]));
        if let Some(start) = start.into_iter().find(|time| self.holds_at(time)) {
            return Some(start);
        }
        let times = polynomials
            .iter()
            .flat_map(|polynomial| Root::in_unit_interval(polynomial));
        times.filter(|time| self.holds_at(time)).min()
    }

    /// Whether the origin is in the triangle at a time.
    fn holds_at(&self, time: &Root) -> bool {
        let on_edge =
            |edge: &OriginOnSegment| time.sign_of(&edge.cross_squared).is_eq() && time.sign_of(&edge.dot).is_le();
        if time.sign_of(&self.normal_squared).is_eq() {
            self.edges.iter().any(on_edge)
        } else {
            time.sign_of(&self.determinant).is_eq() && self.sides.iter().all(|side| time.sign_of(side).is_ge())
        }
    }
}

/// The first time in `[0, 1]` at which the origin is in a triangle whose corners move linearly.
///
/// The set of such times is closed. Its first member is 0 or a time at which some of the signs change, which is a root of a
/// polynomial that is not zero everywhere. So it is enough to look at these times.
pub(super) fn first_time(corners: &[Vector; 3]) -> Option<Root> {
    let [u, v, w] = corners;
    // The determinant is zero at every contact, so that its roots are enough if it is not zero everywhere.
    let determinant = dot(u, &cross(v, w)).halved();
    if determinant.is_zero() {
        let triangle = OriginInTriangle::new(corners);
        return triangle.first_among(&triangle.all());
    }
    let times = Root::in_unit_interval(&determinant);
    if times.is_empty() {
        return None;
    }
    let triangle = OriginInTriangle::new(corners);
    times.into_iter().find(|time| triangle.holds_at(time))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Family;
    use crate::motion::truth::{moving_points, triangles};

    #[test]
    fn the_roots_of_the_determinant_are_enough_unless_it_is_zero() {
        let mut contacts = 0;
        for family in Family::ALL {
            // Large exponents take long.
            let count = if family == Family::Extreme { 5 } else { 40 };
            for index in 0..count {
                let motion = family.motion(7, index);
                for corners in triangles(motion.kind, &moving_points(&motion.points)) {
                    let triangle = OriginInTriangle::new(&corners);
                    let first = first_time(&corners);
                    assert_eq!(
                        first,
                        triangle.first_among(&triangle.all()),
                        "{family} {index}: {motion:?}"
                    );
                    contacts += usize::from(first.is_some());
                }
            }
        }
        assert!(contacts > 300, "{contacts}");
    }
}
