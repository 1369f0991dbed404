//! Rays that are cast at a body.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::rivals::CastRay;

/// Rays from around a body to points of a box of this half size about its middle. They differ from step to step, and most of them
/// hit.
pub(super) fn rays_at(middle: DVec3, half_size: DVec3, step: usize, rays: usize) -> Vec<CastRay> {
    (0..rays)
        .map(|ray| ray_at(middle, half_size, (step * 131 + ray) as f64))
        .collect()
}

fn ray_at(middle: DVec3, half_size: DVec3, number: f64) -> CastRay {
    // Low-discrepancy steps, from -1 to 1.
    let share = |stride: f64| 2.0 * (number * stride).fract() - 1.0;
    let (turn, distance) = (0.5 * TAU * share(0.618_034), 5.0 * half_size.max_element());
    let from = DVec3::new(turn.cos(), 0.2 * share(0.569_840), turn.sin()) * distance;
    let aside = DVec3::new(share(0.324_718), share(0.754_878), share(0.438_579));
    CastRay {
        origin: middle + from,
        direction: half_size * aside - from,
    }
}
