//! The distance of two convex sets that are given by their support points (Gilbert, Johnson and Keerthi 1988).
//!
//! A simplex of up to four differences of support points is moved towards the origin. Each new difference also gives a lower bound of the
//! distance, so the method knows when it is done.

use glam::DVec3;

/// Closest points of two sets that do not touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Separation {
    pub(super) on_b: DVec3,
    /// The unit vector from the first set to the second.
    pub(super) normal: DVec3,
    /// The width of the gap along the normal: a lower bound of the distance.
    pub(super) distance: f64,
}

/// Gaps below this, relative to the coordinates involved, may count as touching: the direction across is then mostly rounding error. It is
/// the root of the rounding error of a coordinate.
pub(in super::super) const BLIND: f64 = 1.5e-8;

/// Far more than curved sets need until the two bounds agree in all digits.
const MAX_STEPS: usize = 128;

/// A point of the second set less one of the first.
#[derive(Clone, Copy)]
struct Difference {
    on_b: DVec3,
    apart: DVec3,
}

/// The point of a simplex that is nearest to the origin.
struct Nearest {
    weights: [f64; 4],
    apart: DVec3,
    /// Like `apart`, possibly with more digits of the direction.
    direction: DVec3,
    rounding: f64,
}

/// Returns the closest points; `None` if no plane is found between the sets: they intersect, or their gap is [`BLIND`].
/// `toward` is a guess of the direction from the first set to the second.
pub(super) fn separation(a: impl Fn(DVec3) -> DVec3, b: impl Fn(DVec3) -> DVec3, toward: DVec3) -> Option<Separation> {
    let mut reach = 0.0_f64;
    let mut difference = |toward: DVec3| {
        let (on_a, on_b) = (a(toward), b(-toward));
        reach = reach.max(on_a.abs().max(on_b.abs()).max_element());
        let difference = Difference {
            on_b,
            apart: on_b - on_a,
        };
        (difference, 4.0 * f64::EPSILON * reach)
    };
    let (first, mut rounding) = difference(toward);
    let mut corners = [first; 4];
    let mut count = 1;
    let mut shortest = f64::INFINITY;
    let mut last = Separation {
        on_b: first.on_b,
        normal: DVec3::ZERO,
        distance: 0.0,
    };
    let mut widest = last;
    for _ in 0..MAX_STEPS {
        let nearest = nearest_to_origin(&corners[..count], widest.distance > 0.0, rounding)?;
        let distance = nearest.apart.length();
        if distance <= rounding {
            return None;
        }
        if distance >= shortest {
            break;
        }
        shortest = distance;
        let on_b = corners[..count].iter().zip(nearest.weights);
        last.on_b = on_b.fold(DVec3::ZERO, |sum, (corner, weight)| sum + corner.on_b * weight);
        let mut kept = 0;
        for corner in 0..count {
            if nearest.weights[corner] > 0.0 {
                corners[kept] = corners[corner];
                kept += 1;
            }
        }
        let direction = nearest.direction.normalize();
        let (next, now) = difference(direction);
        rounding = now;
        let lower_bound = next.apart.dot(direction);
        (last.normal, last.distance) = (direction, lower_bound);
        if lower_bound > widest.distance {
            widest = last;
        }
        if distance - lower_bound <= (f64::EPSILON * distance).max(0.25 * rounding) || kept == 4 {
            break;
        }
        corners[kept] = next;
        count = kept + 1;
    }
    // The last direction is the most accurate, unless rounding spoiled it.
    let best = if last.distance > 0.999 * widest.distance {
        last
    } else {
        widest
    };
    // Not proven to be apart, they intersect or are closer than the digits of a direction can tell.
    (best.distance > 0.0).then_some(best)
}

/// The nearest point of a simplex of one to four corners; `None` if the origin is in a tetrahedron.
///
/// Near the end, tetrahedra are flat, and signs of their volumes are noise. By then it is known whether the sets are apart.
fn nearest_to_origin(simplex: &[Difference], are_apart: bool, rounding: f64) -> Option<Nearest> {
    let at = |i: usize| simplex[i].apart;
    let mut best = Nearest {
        weights: [0.0; 4],
        apart: DVec3::INFINITY,
        direction: DVec3::INFINITY,
        rounding,
    };
    match simplex.len() {
        1 => best.offer([(0, 1.0)], at),
        2 => best.offer_segment([0, 1], at),
        3 => best.offer_triangle([0, 1, 2], at),
        _ => {
            let mut is_inside = true;
            for (face, opposite) in [([0, 1, 2], 3), ([0, 1, 3], 2), ([0, 2, 3], 1), ([1, 2, 3], 0)] {
                let [a, b, c] = face.map(at);
                let normal = (b - a).cross(c - a);
                let (inner, origin) = (normal.dot(at(opposite) - a), -normal.dot(a));
                let is_beyond = (inner > 0.0 && origin < 0.0) || (inner < 0.0 && origin > 0.0);
                if are_apart || is_beyond || inner == 0.0 {
                    is_inside = false;
                    best.offer_triangle(face, at);
                }
            }
            if is_inside {
                return None;
            }
        }
    }
    Some(best)
}

impl Nearest {
    /// Keeps the weighted sum of some corners if it is nearer.
    fn offer<const N: usize>(&mut self, weighted: [(usize, f64); N], at: impl Fn(usize) -> DVec3) {
        let apart = weighted
            .iter()
            .fold(DVec3::ZERO, |sum, (corner, weight)| sum + at(*corner) * *weight);
        if apart.length_squared() < self.apart.length_squared() {
            (self.apart, self.direction) = (apart, apart);
            self.weights = [0.0; 4];
            for (corner, weight) in weighted {
                self.weights[corner] = weight;
            }
        }
    }

    fn offer_segment(&mut self, [i, j]: [usize; 2], at: impl Fn(usize) -> DVec3) {
        let along = at(j) - at(i);
        let squared = along.length_squared();
        let t = if squared > 0.0 {
            (-at(i).dot(along) / squared).clamp(0.0, 1.0)
        } else {
            0.0
        };
        self.offer([(i, 1.0 - t), (j, t)], at);
    }

    fn offer_triangle(&mut self, [i, j, k]: [usize; 3], at: impl Fn(usize) -> DVec3 + Copy) {
        let [a, b, c] = [at(i), at(j), at(k)];
        // From the edges, which keep their digits if the triangle is small: along the first, and across it.
        let (u, v) = (b - a, c - a);
        let along = v.dot(u) / u.length_squared();
        let across = v - u * along;
        let of_c = -a.dot(across) / across.length_squared();
        let of_b = -a.dot(u) / u.length_squared() - of_c * along;
        let of_a = 1.0 - of_b - of_c;
        if of_a > 0.0 && of_b > 0.0 && of_c > 0.0 {
            self.offer([(i, of_a), (j, of_b), (k, of_c)], at);
            // Near the origin, the sum has lost the direction, which the normal of a triangle that is not thin has kept.
            let normal = u.cross(across).normalize_or_zero();
            let along_normal = normal * normal.dot(a);
            if self.apart.distance(along_normal) <= self.rounding {
                self.direction = along_normal;
            }
        }
        for edge in [[i, j], [j, k], [k, i]] {
            self.offer_segment(edge, at);
        }
    }
}
