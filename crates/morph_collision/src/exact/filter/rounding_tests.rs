//! Measures in exact arithmetic how close the error of a determinant comes to its bound.

use glam::DVec3;
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::{Climb, is_as_known};
use rand::RngExt;

use super::{RELATIVE, determinant, largest};

/// Four points. Each coordinate is the sum of two `f32`s, so that it uses all bits of an `f64`.
fn points(numbers: &[f32]) -> [DVec3; 4] {
    let coordinate = |i: usize| f64::from(numbers[2 * i]) + f64::from(numbers[2 * i + 1]) * 2_f64.powi(-27);
    std::array::from_fn(|p| DVec3::from_array(std::array::from_fn(|axis| coordinate(3 * p + axis))))
}

fn exact_determinant([o, p, q, r]: [DVec3; 4]) -> Dyadic {
    let minus_o = |p: DVec3| -> [Dyadic; 3] { std::array::from_fn(|i| Dyadic::from(p[i]) - Dyadic::from(o[i])) };
    let [u, v, w] = [p, q, r].map(minus_o);
    let cross = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        u[j].clone() * v[k].clone() - u[k].clone() * v[j].clone()
    };
    (0..3).map(|i| cross(i) * w[i].clone()).sum()
}

/// The error divided by its bound; `None` for bounds outside of 1e-30 to 1e30.
fn share(numbers: &[f32]) -> Option<f64> {
    let [o, p, q, r] = points(numbers);
    let (u, v, w) = (p - o, q - o, r - o);
    let bound = largest(u) * largest(v) * largest(w) * RELATIVE;
    if !(1e-30..1e30).contains(&bound) {
        return None;
    }
    let exact = exact_determinant([o, p, q, r]);
    let decided = determinant(u, v, w);
    assert!(decided.is_eq() || decided == exact.cmp(&Dyadic::zero()), "{numbers:?}");
    let error = (Dyadic::from(u.cross(v).dot(w)) - exact).abs();
    let share = error.ratio(&Dyadic::from(bound));
    assert!(share <= 1.0, "{share} of the bound: {numbers:?}");
    Some(share)
}

#[test]
fn a_determinant_is_off_by_a_known_share_of_its_bound_and_never_by_more() {
    let climb = Climb {
        seed: 5,
        starts: 12,
        steps: 1500,
    };
    let (share, _) = climb.highest(
        |i, rng| {
            // Coordinates of similar size, so that every term of the determinant counts.
            let spread = [1.0, 0.5, 0.1][i % 3];
            let mut coordinate = || {
                let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
                [
                    sign * (1.0 + spread * rng.random_range(-1.0..1.0_f32)),
                    rng.random_range(-1.0..1.0),
                ]
            };
            (0..12).flat_map(|_| coordinate()).collect()
        },
        share,
    );
    println!("determinant: {share:.3} of the bound");
    assert!(is_as_known(share, 0.183), "{share} of the bound, known is 0.183");
}
