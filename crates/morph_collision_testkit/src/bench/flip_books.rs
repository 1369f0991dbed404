//! Flip-book characters, upright along `+Y`, that pass right through each other.
//!
//! A placement is that of a character's middle, which its own steps do not move. Lengths are in sizes of its bounds at
//! rest.

use std::f64::consts::{PI, TAU};

use glam::{Affine3A, DQuat, DVec3};

use morph_collision_models::scenes::rigid;

/// `world_from_middle` of one of two horses that gallop along `z` in opposite directions, half a flank in each other's way.
pub(super) fn horses(index: usize, t: f64, size: DVec3) -> Affine3A {
    let (turn, side) = if index == 0 { (0.0, 0.5) } else { (PI, -0.5) };
    let place = DVec3::new(0.5, 0.0, 2.3 * (t - 0.5)) * side;
    rigid(DQuat::from_rotation_y(turn), place * size)
}

/// `world_from_middle` of one of two dancers that dance towards each other, through each other and away, turning once.
pub(super) fn dancers(index: usize, t: f64, size: DVec3) -> Affine3A {
    let side = if index == 0 { 0.5 } else { -0.5 };
    let turn = TAU * t + if index == 0 { 0.0 } else { PI };
    let place = DVec3::new(0.1, 0.0, 2.2 * (t - 0.5)) * (side * size.z);
    rigid(DQuat::from_rotation_y(turn), place)
}
