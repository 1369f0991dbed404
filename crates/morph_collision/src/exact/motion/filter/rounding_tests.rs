//! Measures in exact arithmetic how close the errors of the filter come to their bounds.

use glam::DVec3;
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::{Climb, is_as_known};
use rand::RngExt;

use super::height_roots::{SIDES_AT, sides_at};
use super::relative::{Relative, vectors};
use super::subdivision::Interval;
use crate::exact::motion::features::{FeaturePair, Kind};
use crate::exact::motion::{MovingPoint, TimeOfImpact};

type Exact = [Dyadic; 3];

/// Features. Each coordinate is the sum of two `f32`s, so that it uses all bits of an `f64`.
fn features(kind: Kind, numbers: &[f32]) -> FeaturePair {
    let coordinate = |i: usize| f64::from(numbers[2 * i]) + f64::from(numbers[2 * i + 1]) * 2_f64.powi(-27);
    let point = |p: usize| DVec3::from_array(std::array::from_fn(|axis| coordinate(3 * p + axis)));
    let corners = std::array::from_fn(|i| MovingPoint::new(point(2 * i), point(2 * i + 1)));
    FeaturePair { kind, corners }
}

fn whole(n: i32) -> Dyadic {
    Dyadic::from(f64::from(n))
}

/// The vectors `u`, `v` and `w` at a time.
fn exact_vectors(features: &FeaturePair, time: f64) -> [Exact; 3] {
    let at = |corner: usize, axis: usize| {
        let MovingPoint { start, end } = features.corners[corner];
        Dyadic::from(start[axis]) * (whole(1) - Dyadic::from(time)) + Dyadic::from(end[axis]) * Dyadic::from(time)
    };
    features
        .kind
        .spans()
        .map(|[from, to]| std::array::from_fn(|axis| at(to, axis) - at(from, axis)))
}

fn exact_cross(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].clone() * b[k].clone() - a[k].clone() * b[j].clone()
    })
}

fn exact_dot(a: &Exact, b: &Exact) -> Dyadic {
    (0..3).map(|i| a[i].clone() * b[i].clone()).sum()
}

/// Height and sides at a time.
fn exact_values(features: &FeaturePair, time: f64) -> (Dyadic, [Dyadic; 4]) {
    let [u, v, w] = exact_vectors(features, time);
    let n = exact_cross(&u, &v);
    let (normal, p) = (exact_dot(&n, &n), exact_dot(&exact_cross(&w, &v), &n));
    let q = exact_dot(&exact_cross(&u, &w), &n);
    let [a, b] = [&p, &q].map(Clone::clone);
    let sides = match features.kind {
        Kind::VertexFace => [a, b, normal.clone() - p - q, normal],
        Kind::EdgeEdge => [a, normal.clone() - p, whole(0) - b, normal + q],
    };
    (exact_dot(&n, &w), sides)
}

/// The values at `0`, `1 / 4`, ... `1` of an interval that Bernstein coefficients stand for, times a power of two, exactly.
fn values<const N: usize>(coefficients: [f64; N]) -> [Dyadic; 5] {
    std::array::from_fn(|quarter| {
        let mut row = coefficients.map(Dyadic::from);
        for step in 1..N {
            for i in 0..N - step {
                row[i] = row[i].clone() * whole(4 - quarter as i32) + row[i + 1].clone() * whole(quarter as i32);
            }
        }
        row[0].clone()
    })
}

fn ratio(error: Dyadic, bound: f64) -> f64 {
    error.abs().ratio(&Dyadic::from(bound))
}

/// The largest errors of height and sides over their bounds, after some halvings.
fn shares(kind: Kind, numbers: &[f32], halvings: &[usize]) -> Option<(f64, f64)> {
    let features = features(kind, numbers);
    let relative = Relative::new(kind, vectors(&features))?;
    let mut interval = Interval::whole(&relative);
    for &half in halvings {
        interval = interval.halves()[half];
    }
    let TimeOfImpact { earliest, latest } = interval.time(halvings.len() as u32);
    let depth = halvings.len() as u32;
    let (heights, sides) = (
        values(interval.height.map(|[c]| c)),
        [0, 1, 2, 3].map(|i| values(interval.sides.map(|row| row[i]))),
    );
    let (mut height_share, mut side_share) = (0.0_f64, 0.0_f64);
    for (quarter, found) in heights.into_iter().enumerate() {
        let (height, exact) = exact_values(&features, earliest + (latest - earliest) * 0.25 * quarter as f64);
        let error = found - height * whole(64);
        height_share = height_share.max(ratio(error, 64.0 * relative.errors.height(depth)));
        for (side, exact) in sides.iter().zip(exact) {
            let error = side[quarter].clone() - exact * whole(256);
            side_share = side_share.max(ratio(error, 256.0 * relative.errors.side(depth)));
        }
    }
    assert!(
        height_share <= 1.0 && side_share <= 1.0,
        "{height_share} {side_share} {numbers:?}"
    );
    Some((height_share, side_share))
}

/// The largest error of a side at a time over its bound.
fn share_at(kind: Kind, numbers: &[f32], time: f64) -> Option<f64> {
    let features = features(kind, numbers);
    let relative = Relative::new(kind, vectors(&features))?;
    let (_, exact) = exact_values(&features, time);
    let errors = sides_at(&relative, time)
        .into_iter()
        .zip(exact)
        .map(|(side, exact)| Dyadic::from(side) - exact);
    let share = errors
        .map(|error| ratio(error, SIDES_AT * relative.errors.side))
        .fold(0.0, f64::max);
    assert!(share <= 1.0, "{share} {numbers:?}");
    Some(share)
}

/// The highest share of a bound over both kinds of features.
fn highest(share: impl Fn(Kind, &[f32]) -> Option<f64>) -> f64 {
    let climb = Climb {
        seed: 7,
        starts: 6,
        steps: 250,
    };
    let found = [Kind::VertexFace, Kind::EdgeEdge].map(|kind| {
        let start = |i: usize, rng: &mut rand_pcg::Pcg64Mcg| -> Vec<f32> {
            let spread = [1.0, 0.5, 0.1][i % 3];
            let mut coordinate = || {
                let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
                [
                    sign * (1.0 + spread * rng.random_range(-1.0..1.0_f32)),
                    rng.random_range(-1.0..1.0),
                ]
            };
            (0..24).flat_map(|_| coordinate()).collect()
        };
        climb.highest(start, |numbers| share(kind, numbers)).0
    });
    found[0].max(found[1])
}

/// Compares the shares of the bounds of height and sides after some halvings with those of an earlier run.
fn assert_as_known(halvings: &[usize], known: [f64; 2]) {
    let height = highest(|kind, numbers| shares(kind, numbers, halvings).map(|(height, _)| height));
    let side = highest(|kind, numbers| shares(kind, numbers, halvings).map(|(_, side)| side));
    println!(
        "{} halvings: height {height:.4}, sides {side:.4} of their bounds",
        halvings.len()
    );
    assert!(
        is_as_known(height, known[0]) && is_as_known(side, known[1]),
        "{height} {side}"
    );
}

#[test]
fn polynomials_are_off_by_a_known_share_of_their_bounds_and_never_by_more() {
    assert_as_known(&[], [0.0743, 0.0247]);
}

#[test]
fn halved_polynomials_are_off_by_a_known_share_of_their_bounds_and_never_by_more() {
    assert_as_known(&[0, 1, 1, 0, 1, 0, 0, 1], [0.0149, 0.0032]);
}

#[test]
fn sides_at_one_time_are_off_by_a_known_share_of_their_bound_and_never_by_more() {
    let share = highest(|kind, numbers| share_at(kind, numbers, 311_063_573.0 * 0.5_f64.powi(30)));
    println!("sides at a time: {share:.3} of the bound");
    assert!(is_as_known(share, 0.0082), "{share} of the bound");
}
