//! Numbers with few bits, and points made of them.

use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::motion::elementary::{ElementaryMotion, MotionKind};

/// Between -2 and 2, a multiple of `2^-10`. Often it is a small whole number.
pub(super) fn short(rng: &mut Pcg64Mcg) -> f64 {
    if rng.random_bool(0.2) {
        return f64::from(rng.random_range(-2..3));
    }
    f64::from(rng.random_range(-2048..2049)) / 1024.0
}

pub(super) fn short_vector(rng: &mut Pcg64Mcg) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| short(rng)))
}

/// Whole coordinates up to a limit.
pub(super) fn whole_vector(limit: i32, rng: &mut Pcg64Mcg) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| f64::from(rng.random_range(-limit..=limit))))
}

/// A multiple of 1/16 strictly between 0 and 1.
pub(super) fn between(rng: &mut Pcg64Mcg) -> f64 {
    f64::from(rng.random_range(1..16)) / 16.0
}

/// A time: a multiple of 1/16 from 0 to 1.
pub(super) fn instant(rng: &mut Pcg64Mcg) -> f64 {
    f64::from(rng.random_range(0..17)) / 16.0
}

/// Random digits; start and end in the same cube, or near each other.
pub(super) fn any_motion(kind: MotionKind, rng: &mut Pcg64Mcg) -> ElementaryMotion {
    let step = if rng.random_bool(0.5) { 2.0 } else { 0.5 };
    let points = std::array::from_fn(|_| {
        let start: [f64; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
        [start, start.map(|x| x + rng.random_range(-step..step))]
    });
    ElementaryMotion { kind, points }
}

/// Whole coordinates, few of them different.
pub(super) fn grid_motion(kind: MotionKind, rng: &mut Pcg64Mcg) -> ElementaryMotion {
    let limit = rng.random_range(1..3);
    let points = [[(); 2]; 4].map(|motion| motion.map(|()| whole_vector(limit, rng).to_array()));
    ElementaryMotion { kind, points }
}
