//! Decides pairs of triangles in `f64` arithmetic if the result is certain, so that integers are needed only for the rest.
//!
//! Every number comes with an error bound, and a sign counts only if the error cannot change it. The result is always the one
//! that integers would give; uncertain cases are left to them.

use std::array::from_fn;

use glam::DVec3;

/// An upper bound on the error of a dot product of rounded differences, relative to the sum of its terms' magnitudes. The
/// error is `5 * 2^-53` and terms of second order.
const DOT_ERROR: f64 = 8.0 * f64::EPSILON;

/// An upper bound on the error of a determinant of rounded differences, relative to its permanent. The error is `8 * 2^-53`
/// (Shewchuk 1997).
const DETERMINANT_ERROR: f64 = 16.0 * f64::EPSILON;

/// Whether two closed triangles share a point, or `None` if `f64` arithmetic is not certain. Vertices must be finite.
pub(super) fn certainly(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<bool> {
    if separated(a, b) {
        return Some(false);
    }
    let pierced = (0..3).any(|i| pierces(a[i], a[(i + 1) % 3], b) || pierces(b[i], b[(i + 1) % 3], a));
    pierced.then_some(true)
}

/// Whether one of the directions tried certainly separates the triangles, strictly.
///
/// A direction counts as the exact vector of its rounded coordinates, so it does not matter how it was found.
fn separated(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let origin = a[0];
    let (near_a, near_b) = (a.map(|p| p - origin), b.map(|p| p - origin));
    let separates = |direction: DVec3| {
        let ((low_a, high_a), (low_b, high_b)) = (extent(direction, &near_a), extent(direction, &near_b));
        high_a < low_b || high_b < low_a
    };
    let (edges_a, edges_b) = (edges(&near_a), edges(&near_b));
    let (normal_a, normal_b) = (edges_a[0].cross(edges_a[1]), edges_b[0].cross(edges_b[1]));
    separates(normal_a)
        || separates(normal_b)
        || edges_a
            .iter()
            .any(|edge| edges_b.iter().any(|other| separates(edge.cross(*other))))
        || edges_a.iter().any(|edge| separates(edge.cross(normal_a)))
        || edges_b.iter().any(|edge| separates(edge.cross(normal_b)))
}

/// Bounds on the points' positions along a direction. NaN if `f64` overflows, so that no comparison holds.
fn extent(direction: DVec3, points: &[DVec3; 3]) -> (f64, f64) {
    points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            let terms = direction * point;
            let along = terms.x + terms.y + terms.z;
            let magnitude = terms.x.abs() + terms.y.abs() + terms.z.abs();
            // The smallest normal number exceeds anything that underflows.
            let error = magnitude * DOT_ERROR + f64::MIN_POSITIVE;
            if !(along - error).is_finite() || !(along + error).is_finite() {
                return (f64::NEG_INFINITY, f64::INFINITY);
            }
            (low.min(along - error), high.max(along + error))
        })
}

/// Whether an edge certainly passes through the inside of a triangle: its ends are on different sides of the plane, and all
/// three edges wind in the same direction around its line.
fn pierces(p: DVec3, q: DVec3, [a, b, c]: &[DVec3; 3]) -> bool {
    let (Some(p_above), Some(q_above)) = (above(*a, *b, *c, p), above(*a, *b, *c, q)) else {
        return false;
    };
    if p_above == q_above {
        return false;
    }
    let turns = [(*a, *b), (*b, *c), (*c, *a)].map(|(from, to)| above(p, q, from, to));
    turns[0].is_some() && turns[0] == turns[1] && turns[1] == turns[2]
}

/// Whether the determinant of `a - d`, `b - d`, `c - d` is positive; `None` unless its sign is certain and not zero.
fn above(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Option<bool> {
    let (a, b, c) = (a - d, b - d, c - d);
    // In this range no product of three factors underflows or overflows.
    let in_range = |value: f64| value == 0.0 || (1e-90..=1e90).contains(&value.abs());
    if ![a, b, c].iter().all(|v| v.to_array().into_iter().all(in_range)) {
        return None;
    }
    let determinant = a.x * (b.y * c.z - b.z * c.y) + b.x * (c.y * a.z - c.z * a.y) + c.x * (a.y * b.z - a.z * b.y);
    let (a, b, c) = (a.abs(), b.abs(), c.abs());
    let permanent = a.x * (b.y * c.z + b.z * c.y) + b.x * (c.y * a.z + c.z * a.y) + c.x * (a.y * b.z + a.z * b.y);
    (determinant.abs() > permanent * DETERMINANT_ERROR).then_some(determinant > 0.0)
}

fn edges(triangle: &[DVec3; 3]) -> [DVec3; 3] {
    from_fn(|i| triangle[(i + 1) % 3] - triangle[i])
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::super::triangles_intersect;
    use super::*;

    /// Triangles on a coarse grid, so that touching is common. Each coordinate is on the grid or off by a few roundings.
    fn nearly_degenerate(rng: &mut Pcg64Mcg, scale: f64) -> [DVec3; 3] {
        from_fn(|_| {
            DVec3::from_array(from_fn(|_| {
                let coordinate = f64::from(rng.random_range(-3..=3_i32)) * scale;
                let off = f64::from(rng.random_range(-2..=2_i32)) * f64::EPSILON;
                coordinate * (1.0 + off) + off * scale * f64::from(rng.random_range(0..=1_i32))
            }))
        })
    }

    #[test]
    fn what_is_certain_is_true() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let (mut certain, mut open) = ([0, 0], 0);
        for round in 0..6000 {
            let scale = [1.0, 1e-30, 1e30, 1e-110, 1e120, 3e-45][round % 6];
            let (a, b) = (nearly_degenerate(&mut rng, scale), nearly_degenerate(&mut rng, scale));
            match certainly(&a, &b) {
                Some(answer) => {
                    assert_eq!(answer, triangles_intersect(&a, &b), "{a:?} {b:?}");
                    certain[usize::from(answer)] += 1;
                }
                None => open += 1,
            }
        }
        assert!(certain[0] > 500 && certain[1] > 500 && open > 500, "{certain:?} {open}");
    }

    #[test]
    fn touching_is_never_certain() {
        let a = [DVec3::ZERO, DVec3::X, DVec3::Y];
        for b in [
            a,
            a.map(|p| p + DVec3::X),
            [DVec3::ZERO, DVec3::Z, DVec3::Z + DVec3::X],
            [DVec3::new(0.25, 0.25, 0.0), DVec3::Z, DVec3::Z * 2.0],
        ] {
            assert_eq!(certainly(&a, &b), None);
        }
    }
}
