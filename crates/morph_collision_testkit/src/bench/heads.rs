//! Heads of people, upright along `+Y` and looking along `+Z`: two that greet each other cheek to cheek, and a crowd.
//!
//! A placement is that of the middle of a head's bounds. Lengths are in sizes of these bounds.

use std::f64::consts::{PI, TAU};

use glam::{Affine3A, DQuat, DVec3, EulerRot};

use morph_collision_models::scenes::rigid;

/// Number of heads in the crowd.
pub(super) const CROWD: usize = 12;

/// How far a head turns its face away from the other, in radians, so that the cheek is in front.
const AWAY: f64 = 0.2;
/// How far it leans towards the other, in radians.
const LEAN: f64 = 0.15;

/// The offset between the middles, to the side and forwards, at which cheeks touch.
const BESIDE: f64 = 0.635;
const AHEAD: f64 = 0.5;
/// How far the heads come apart or press together, to the side.
const SWAY: f64 = 0.035;

/// `world_from_middle` of one of two heads that look past each other, left cheek to left cheek. They press together and come
/// apart twice while `t` goes from 0 to 1.
pub(super) fn cheek_to_cheek(index: usize, t: f64, size: DVec3) -> Affine3A {
    let beside = BESIDE + SWAY * (2.0 * TAU * t).cos();
    let nod = 0.03 * (TAU * (3.0 * t + 0.4 * index as f64)).sin();
    let (turn, side) = if index == 0 { (0.0, -0.5) } else { (PI, 0.5) };
    let rotation = DQuat::from_euler(EulerRot::YXZ, turn - AWAY, nod, LEAN);
    rigid(rotation, DVec3::new(beside * size.x, 0.0, AHEAD * size.z) * side)
}

/// Distances between neighbours in a row and between rows.
const IN_ROW: f64 = 1.03;
const BETWEEN_ROWS: f64 = 0.98;
/// How much these distances shrink and grow as the crowd is crushed and released.
const CRUSH: f64 = 0.06;
/// How far a head sways to each side of its place.
const STEP: f64 = 0.05;

/// `world_from_middle` of head `index` of a crowd that stands in rows, sways, looks around, and is crushed together twice while
/// `t` goes from 0 to 1, so that neighbours touch now and then.
pub(super) fn crowd(index: usize, t: f64, size: DVec3) -> Affine3A {
    let columns = 4;
    let (row, column) = (index / columns, index % columns);
    let shift = if row.is_multiple_of(2) { -0.25 } else { 0.25 };
    // A phase, evenly scattered over the heads.
    let own = |square: f64| ((index + 1) as f64 * square.sqrt()).fract();
    let wave = |cycles: f64, phase: f64| (TAU * (cycles * t + phase)).sin();
    let room = 1.0 + CRUSH * (2.0 * TAU * t).cos();
    let place = DVec3::new(
        room * IN_ROW * (column as f64 - 1.5 + shift) + STEP * wave(2.0, own(2.0)),
        0.06 * (own(3.0) - 0.5),
        room * BETWEEN_ROWS * (row as f64 - 1.0) + STEP * wave(3.0, own(5.0)),
    );
    let rotation = DQuat::from_euler(
        EulerRot::YXZ,
        0.5 * wave(1.0, own(7.0)),
        0.08 * wave(4.0, own(11.0)),
        0.06 * wave(3.0, own(13.0)),
    );
    rigid(rotation, place * size)
}
