//! The slab directions of k-DOPs, and how any vector is put together from few of them.
//!
//! All directions have coordinates -1, 0 and 1: the 3 axes of a box, and beside them 4 cube corners (14-DOP), 6 edge
//! middles (18-DOP) or both (26-DOP). They are not normalised; only comparisons along the same direction matter.

use glam::DVec3;

/// Axes, then edges, then corners: those of the 26-DOP.
const ALL: [[i8; 3]; 13] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 0],
    [1, -1, 0],
    [1, 0, 1],
    [1, 0, -1],
    [0, 1, 1],
    [0, 1, -1],
    [1, 1, 1],
    [1, 1, -1],
    [1, -1, 1],
    [1, -1, -1],
];
const FIRST_EDGE: usize = 3;
const FIRST_CORNER: usize = 9;

/// Direction `i` of the k-DOP with `slabs` slabs.
pub(super) const fn direction(slabs: usize, i: usize) -> [i8; 3] {
    let without_edges = slabs == 7;
    if without_edges && i >= FIRST_EDGE {
        ALL[i + FIRST_CORNER - FIRST_EDGE]
    } else {
        ALL[i]
    }
}

/// How long a direction is in the 1-norm: what an error per coordinate becomes along it.
pub(super) const fn length(slabs: usize, i: usize) -> f32 {
    let d = direction(slabs, i);
    (d[0].abs() + d[1].abs() + d[2].abs()) as f32
}

pub(super) fn along(slabs: usize, i: usize, p: DVec3) -> f64 {
    let [x, y, z] = direction(slabs, i).map(f64::from);
    x * p.x + y * p.y + z * p.z
}

/// A slab direction and how much of it.
pub(super) type Term = (usize, f64);

/// `v` as a sum of at most three directions of the k-DOP, the ones around it, so that the bound
/// `max v.q <= sum |coefficient| * (the slab's end)` is as tight as the k-DOP allows.
pub(super) fn decompose(slabs: usize, v: DVec3) -> [Term; 3] {
    match slabs {
        FIRST_EDGE => [(0, v.x), (1, v.y), (2, v.z)],
        _ => around(slabs, v),
    }
}

/// The terms of a k-DOP that has more directions than the axes.
fn around(slabs: usize, v: DVec3) -> [Term; 3] {
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| v[j].abs().total_cmp(&v[i].abs()));
    let [i, j, k] = order;
    // Signs and magnitudes with a >= b >= c >= 0.
    let [a, b, c] = order.map(|axis| v[axis].abs());
    let sign = |axis: usize| if v[axis] < 0.0 { -1_i8 } else { 1 };
    let axis = |axis: usize, amount: f64| (axis, amount * f64::from(sign(axis)));
    let edge = |p: usize, q: usize, amount: f64| {
        let mut d = [0; 3];
        d[p] = sign(p);
        d[q] = sign(q);
        term(slabs, d, amount)
    };
    let corner = |flip_last: bool, amount: f64| {
        let mut d = [0, 1, 2].map(sign);
        d[k] *= if flip_last { -1 } else { 1 };
        term(slabs, d, amount)
    };
    match slabs {
        7 => [
            axis(i, a - b),
            corner(false, 0.5 * (b + c)),
            corner(true, 0.5 * (b - c)),
        ],
        9 if a >= b + c => [axis(i, a - b - c), edge(i, j, b), edge(i, k, c)],
        9 => [
            edge(i, j, 0.5 * (a + b - c)),
            edge(i, k, 0.5 * (a + c - b)),
            edge(j, k, 0.5 * (b + c - a)),
        ],
        _ => [axis(i, a - b), edge(i, j, b - c), corner(false, c)],
    }
}

/// A direction given with its signs, as the stored one or its opposite.
fn term(slabs: usize, d: [i8; 3], amount: f64) -> Term {
    let negated = d.map(|x| -x);
    for i in FIRST_EDGE..slabs {
        let stored = direction(slabs, i);
        if stored == d {
            return (i, amount);
        }
        if stored == negated {
            return (i, -amount);
        }
    }
    // Not reached: every sign pattern of an edge or corner is stored or is the opposite of one.
    (0, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_vector_is_the_sum_of_its_terms() {
        for slabs in [3, 7, 9, 13] {
            for step in 0..2000 {
                let t = f64::from(step);
                let v = DVec3::new((t * 0.7).sin(), (t * 1.3).cos(), (t * 0.11).sin() * (t * 3.1).cos());
                let sum: DVec3 = decompose(slabs, v)
                    .into_iter()
                    .map(|(i, amount)| DVec3::from_array(direction(slabs, i).map(f64::from)) * amount)
                    .sum();
                assert!((sum - v).abs().max_element() < 1e-15, "{slabs} slabs: {v} became {sum}");
            }
        }
    }

    #[test]
    fn directions_of_each_dop_differ_and_are_not_opposite() {
        for slabs in [3, 7, 9, 13] {
            for i in 0..slabs {
                for j in 0..i {
                    let (d, e) = (direction(slabs, i), direction(slabs, j));
                    assert!(d != e && d != e.map(|x| -x), "{slabs} slabs: {d:?} and {e:?}");
                }
            }
        }
    }
}
