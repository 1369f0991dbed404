//! The paper's second experiment: dolphins that swim closely together as a group and roll, for 400 frames.
//!
//! Every dolphin has its own lane along `+X`; the lanes form a compact grid across. Dolphins weave about their lanes
//! and roll about their long axes, each at its own phase, so that neighbours sometimes touch with fins and tails, but
//! rarely with their bodies. Apart from the distance swum, the motion repeats after `frames` frames.

use std::f64::consts::TAU;

use glam::{Affine3A, DQuat, DVec3, EulerRot};

use super::rigid;
use crate::generated::{round6, swim_weights};

/// The number of dolphins in the paper.
pub const COUNT: usize = 12;
/// The number of frames of the paper's simulation.
pub const FRAMES: usize = 400;

/// Distance between lanes; a dolphin is 2 long, and 0.36 thick without its fins.
const LANE: f64 = 0.56;
/// How far a dolphin weaves to each side of its lane.
const WEAVE: f64 = 0.09;
/// The distance swum over all frames.
const DISTANCE: f64 = 24.0;
/// Strokes of the tail over all frames: one every 100 frames.
const STROKES: f64 = 4.0;

/// `world_from_model` of dolphin `index` of `count` in `frame` of `frames`: a rotation and a translation.
///
/// The group swims along the `x` axis and is centred on it. Lane positions are the same for every frame count.
pub fn placement(index: usize, count: usize, frame: usize, frames: usize) -> Affine3A {
    let t = frame as f64 / frames.max(1) as f64;
    let [lane_y, lane_z] = lane(index, count);
    let own = |what| scatter(index, what);

    let sway = |cycles: f64, phase: f64| (TAU * (cycles * t + phase)).sin();
    let slope = |cycles: f64, phase: f64| TAU * cycles / DISTANCE * (TAU * (cycles * t + phase)).cos();
    let (cycles_y, cycles_z) = (2.0 + (index % 2) as f64, 3.0 - (index % 2) as f64);
    let translation = DVec3::new(
        DISTANCE * t + 0.5 * (own(Scatter::Ahead) - 0.5) + 0.1 * sway(1.0, own(Scatter::Surge)),
        lane_y + WEAVE * sway(cycles_y, own(Scatter::WeaveY)),
        lane_z + WEAVE * sway(cycles_z, own(Scatter::WeaveZ)),
    );
    // The nose follows the weave. The roll goes all the way round, with alternating direction from dolphin to
    // dolphin.
    let pitch = WEAVE * slope(cycles_y, own(Scatter::WeaveY));
    let yaw = -WEAVE * slope(cycles_z, own(Scatter::WeaveZ));
    let rolls = if index.is_multiple_of(2) { 2.0 } else { -2.0 };
    let roll = TAU * (rolls * t + own(Scatter::Roll));

    rigid(DQuat::from_euler(EulerRot::YZX, yaw, pitch, roll), translation)
}

/// How far the group has swum along `+X` in `frame` of `frames`.
pub fn way(frame: usize, frames: usize) -> f32 {
    (DISTANCE * frame as f64 / frames.max(1) as f64) as f32
}

/// The phase of dolphin `index`'s stroke at frame 0, in 0..1 strokes.
pub fn phase(index: usize) -> f32 {
    round6(scatter(index, Scatter::Stroke))
}

/// The weights `[tail_down, tail_up]` of dolphin `index` in `frame` of `frames`.
pub fn weights(index: usize, frame: usize, frames: usize) -> [f32; 2] {
    let strokes = STROKES * frame as f64 / frames.max(1) as f64;
    swim_weights((strokes + scatter(index, Scatter::Stroke)) as f32)
}

/// The `y` and `z` of a lane. The rows form about a square, and every second one is shifted by half a lane.
fn lane(index: usize, count: usize) -> [f64; 2] {
    let columns = (count as f64).sqrt().ceil().max(1.0) as usize;
    let rows = count.div_ceil(columns).max(1);
    let (row, column) = (index / columns, index % columns);
    let shift = if row.is_multiple_of(2) { -0.25 } else { 0.25 };
    let middle = |cells: usize| (cells - 1) as f64 / 2.0;
    [
        (row as f64 - middle(rows)) * LANE,
        (column as f64 - middle(columns) + shift) * LANE,
    ]
}

/// The properties that differ from dolphin to dolphin.
#[derive(Clone, Copy)]
enum Scatter {
    Ahead,
    Surge,
    WeaveY,
    WeaveZ,
    Roll,
    Stroke,
}

/// A number in 0..1 per index, evenly scattered: the fractional parts of multiples of a square root, a different one
/// for each property.
fn scatter(index: usize, what: Scatter) -> f64 {
    let square: f64 = match what {
        Scatter::Ahead => 2.0,
        Scatter::Surge => 3.0,
        Scatter::WeaveY => 5.0,
        Scatter::WeaveZ => 7.0,
        Scatter::Roll => 11.0,
        Scatter::Stroke => 13.0,
    };
    ((index + 1) as f64 * square.sqrt()).fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_keep_their_lanes_in_groups_of_any_size() {
        for count in [1, 2, 5, 12, 40] {
            for frame in (0..FRAMES).step_by(10) {
                let places: Vec<_> = (0..count)
                    .map(|i| placement(i, count, frame, FRAMES).translation)
                    .collect();
                for (i, a) in places.iter().enumerate() {
                    for b in &places[..i] {
                        let across = (a.y - b.y).hypot(a.z - b.z);
                        assert!(
                            across > 0.3,
                            "two of {count} dolphins are {across} apart in frame {frame}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_group_is_compact_and_swims_forward() {
        let (start, end) = (placement(0, COUNT, 0, FRAMES), placement(0, COUNT, FRAMES, FRAMES));
        let way = end.translation - start.translation;
        assert!((f64::from(way.x) - DISTANCE).abs() < 1e-4 && way.y.abs() < 1e-4 && way.z.abs() < 1e-4);
        for index in 0..COUNT {
            let place = placement(index, COUNT, 0, FRAMES).translation;
            assert!(place.length() < 2.0, "dolphin {index} is at {place}");
        }
    }

    #[test]
    fn dolphins_roll_and_their_strokes_differ() {
        let up = |frame| placement(3, COUNT, frame, FRAMES).transform_vector3(glam::Vec3::Y);
        assert!(up(0).dot(up(100)) < -0.9, "half a roll in a quarter of the time");
        assert_ne!(phase(0), phase(1));
        assert_ne!(weights(0, 7, FRAMES), weights(1, 7, FRAMES));
    }
}
