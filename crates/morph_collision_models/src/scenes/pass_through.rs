//! The paper's first experiment: two morphing bodies that pass right through each other in 400 steps.
//!
//! They approach from both sides along `x`, slightly offset from each other, turn slowly, and morph from the start
//! through the middle to the end reference. They first touch in step 41 and last in step 364, as in the paper.

use std::f64::consts::TAU;

use glam::{Affine3A, DQuat, DVec3};

use super::rigid;
use crate::generated::round6;

/// The number of steps of the paper's simulation.
pub const STEPS: usize = 400;

/// Half the distance of the bodies at the start and at the end, along `x`.
const START: f64 = 1.034;
const END: f64 = 0.648;
/// Half the offset between their paths, along `y` and `z`.
const ASIDE: [f64; 2] = [0.06, 0.04];

/// `world_from_model` of both bodies in `step` of `steps`, counted from 0.
pub fn placements(step: usize, steps: usize) -> [Affine3A; 2] {
    let t = step as f64 / steps.max(1) as f64;
    let x = START + (-END - START) * t;
    let body = |side: f64, turns: f64, tilt: f64| {
        let rotation = DQuat::from_rotation_y(TAU * turns * t) * DQuat::from_rotation_x(tilt);
        rigid(rotation, DVec3::new(-side * x, side * ASIDE[0], side * ASIDE[1]))
    };
    [body(1.0, 0.25, 0.0), body(-1.0, -0.2, 0.4)]
}

/// The weights `[middle, end]` of both bodies in `step` of `steps`: start to middle in the first half, middle to end in
/// the second.
pub fn weights(step: usize, steps: usize) -> [f32; 2] {
    let t = 2.0 * step as f64 / steps.max(1) as f64;
    [
        round6(if t < 1.0 { t } else { 2.0 - t }.max(0.0)),
        round6((t - 1.0).clamp(0.0, 1.0)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_morph_goes_from_start_through_middle_to_end() {
        assert_eq!(weights(0, STEPS), [0.0, 0.0]);
        assert_eq!(weights(100, STEPS), [0.5, 0.0]);
        assert_eq!(weights(200, STEPS), [1.0, 0.0]);
        assert_eq!(weights(400, STEPS), [0.0, 1.0]);
    }

    #[test]
    fn the_bodies_change_sides() {
        let [a, b] = placements(0, STEPS);
        assert!(a.translation.x < b.translation.x);
        let [a, b] = placements(STEPS, STEPS);
        assert!(a.translation.x > b.translation.x);
    }
}
