//! The normals of k-DOPs, and the decomposition of any vector into a few of them.
//!
//! Normals have coordinates -1, 0 and 1. The paper normalises them. Here only values along the same normal are compared,
//! so their lengths do not matter.

use glam::DVec3;

/// The axes, the diagonals of a cube's faces, the diagonals of a cube.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[f64; 3]; 6] = [
    [1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, -1.0],
];
const CORNERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0]];

/// The normals of the k-DOP with `H = k / 2` slabs, the axes first: 3 (box), 7 (14-DOP), 9 (18-DOP) or 13 (26-DOP).
pub(super) const fn normals<const H: usize>() -> [DVec3; H] {
    let mut normals = [DVec3::ZERO; H];
    let mut i = 0;
    while i < H {
        normals[i] = DVec3::from_array(if i < 3 {
            AXES[i]
        } else if H == 7 {
            CORNERS[i - 3]
        } else if i < 9 {
            FACES[i - 3]
        } else {
            CORNERS[i - 9]
        });
        i += 1;
    }
    normals
}

/// The index of a normal, and a factor.
pub(super) type Term = (usize, f64);

/// `v` as a sum of at most three normals of the k-DOP, those around it. `H` is a number of slabs as above.
///
/// A point's extent along `v` is then bounded by its extents along the normals; no other three bound it more tightly.
pub(super) fn decompose<const H: usize>(v: DVec3) -> [Term; 3] {
    // The axes sorted by the size of `v` along them: x >= y >= z >= 0 up to signs and order.
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| v[j].abs().total_cmp(&v[i].abs()));
    let [x, y, z] = order.map(|axis| v[axis].abs());
    let [first, second, third] = order.map(|axis| {
        let mut unit = DVec3::ZERO;
        unit[axis] = v[axis].signum();
        unit
    });
    let term = |normal: DVec3, factor: f64| numbered::<H>(normal, factor);
    match H {
        7 => [
            term(first, x - y),
            term(first + second + third, 0.5 * (y + z)),
            term(first + second - third, 0.5 * (y - z)),
        ],
        9 if x >= y + z => [term(first, x - y - z), term(first + second, y), term(first + third, z)],
        9 => [
            term(first + second, 0.5 * (x + y - z)),
            term(first + third, 0.5 * (x + z - y)),
            term(second + third, 0.5 * (y + z - x)),
        ],
        13 => [
            term(first, x - y),
            term(first + second, y - z),
            term(first + second + third, z),
        ],
        _ => [(0, v.x), (1, v.y), (2, v.z)],
    }
}

/// The index of a normal, or that of its opposite with the negated factor.
fn numbered<const H: usize>(normal: DVec3, factor: f64) -> Term {
    let normals = const { normals::<H>() };
    let same = normals.iter().position(|&n| n == normal).map(|i| (i, factor));
    let opposite = || normals.iter().position(|&n| n == -normal).map(|i| (i, -factor));
    // One of the two exists, because the normals are all those with a given number of nonzero coordinates, up to sign.
    same.or_else(opposite).unwrap_or((0, f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge<const H: usize>() {
        let normals = normals::<H>();
        for (i, n) in normals.iter().enumerate() {
            assert!(normals[..i].iter().all(|m| m != n && *m != -n), "{H} slabs: {n} twice");
        }
        let odd = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::NEG_Y,
            DVec3::new(1.0, -1.0, 0.0),
            DVec3::ONE,
        ];
        let wave = |step: f64| DVec3::new((step * 0.7).sin(), (step * 1.3).cos(), (step * 0.11).sin());
        for v in odd.into_iter().chain((0..2000).map(|step| wave(f64::from(step)))) {
            let terms = decompose::<H>(v);
            let sum: DVec3 = terms.iter().map(|&(i, factor)| normals[i] * factor).sum();
            assert!((sum - v).abs().max_element() < 1e-15, "{H} slabs: {v} became {sum}");
        }
    }

    #[test]
    fn every_vector_is_the_sum_of_its_terms() {
        judge::<3>();
        judge::<7>();
        judge::<9>();
        judge::<13>();
    }
}
