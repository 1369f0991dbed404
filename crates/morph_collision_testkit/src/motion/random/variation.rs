//! Turns a motion into a more difficult one.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::motion::elementary::ElementaryMotion;

/// Moves one coordinate of one point, at the start or at the end, by one unit in the last place, or sometimes by up to a million;
/// sometimes another one, too.
pub(super) fn nudged(mut motion: ElementaryMotion, rng: &mut Pcg64Mcg) -> ElementaryMotion {
    loop {
        let point = &mut motion.points[rng.random_range(0..4_usize)];
        let coordinate = &mut point[rng.random_range(0..2_usize)][rng.random_range(0..3_usize)];
        let units = if rng.random_bool(0.7) {
            1
        } else {
            1 << rng.random_range(0..20)
        };
        // Next to zero there is nothing but subnormal numbers. They are rare elsewhere, and so here.
        if *coordinate != 0.0 || rng.random_bool(0.05) {
            *coordinate = moved(*coordinate, if rng.random_bool(0.5) { units } else { -units });
        }
        if rng.random_bool(0.7) {
            return motion;
        }
    }
}

/// The number whose magnitude is this many representable numbers larger. It stays if there is none.
fn moved(number: f64, units: i64) -> f64 {
    let magnitude = number.abs().to_bits().checked_add_signed(units).map(f64::from_bits);
    match magnitude {
        Some(magnitude) if magnitude.is_finite() => magnitude.copysign(number),
        _ => number,
    }
}

/// Multiplies everything by a power of two.
pub(super) fn scaled(motion: ElementaryMotion, rng: &mut Pcg64Mcg) -> ElementaryMotion {
    let scale = power(300, rng);
    multiplied(motion, |_| scale)
}

/// Multiplies each axis by its own power of two, which changes no contact; or each coordinate by its own.
pub(super) fn mixed_scales(motion: ElementaryMotion, rng: &mut Pcg64Mcg) -> ElementaryMotion {
    let axes = [(); 3].map(|()| power(300, rng));
    if rng.random_bool(0.6) {
        return multiplied(motion, |axis| axes[axis]);
    }
    let limit = [3, 60, 300][rng.random_range(0..3_usize)];
    multiplied(motion, |_| power(limit, rng))
}

/// Multiplies by powers of two next to the ends of the range of `f64`, or replaces coordinates by random bits.
pub(super) fn extreme(mut motion: ElementaryMotion, rng: &mut Pcg64Mcg) -> ElementaryMotion {
    match rng.random_range(0..4) {
        0 => multiplied(motion, |_| 2.0_f64.powi(1000)),
        1 => multiplied(motion, |_| 2.0_f64.powi(-1000) * 2.0_f64.powi(-60)),
        2 => {
            let axes = [(); 3].map(|()| power(1000, rng));
            multiplied(motion, |axis| axes[axis])
        }
        _ => {
            let share = [0.1, 1.0][rng.random_range(0..2_usize)];
            for coordinate in motion.points.as_flattened_mut().as_flattened_mut() {
                let bits = f64::from_bits(rng.random());
                if bits.is_finite() && rng.random_bool(share) {
                    *coordinate = bits;
                }
            }
            motion
        }
    }
}

/// A power of two with an exponent of either sign up to a limit.
fn power(limit: i32, rng: &mut Pcg64Mcg) -> f64 {
    2.0_f64.powi(rng.random_range(-limit..=limit))
}

/// Multiplies each coordinate by a factor for its axis, and keeps the coordinates finite.
fn multiplied(mut motion: ElementaryMotion, mut factor: impl FnMut(usize) -> f64) -> ElementaryMotion {
    for position in motion.points.as_flattened_mut() {
        for (axis, coordinate) in position.iter_mut().enumerate() {
            *coordinate = (*coordinate * factor(axis)).clamp(f64::MIN, f64::MAX);
        }
    }
    motion
}
