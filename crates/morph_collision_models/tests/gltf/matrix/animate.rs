//! Makes the clip of a file.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::choice::{Choice, Form};
use super::description::{Channel, Description, Interpolation, Local, Target};
use super::numbers::{Kind, Numbers, is_signed, largest, rotation};
use crate::support::{F32, U16};

/// The channels of a choice. The first `shown` nodes show `mesh`.
pub(super) fn channels(
    made: &Description,
    choice: &Choice,
    mesh: usize,
    shown: usize,
    rng: &mut Pcg64Mcg,
) -> Vec<Channel> {
    let mut channels = Vec::new();
    let mut weights = |target, by_pointer, rng: &mut Pcg64Mcg| {
        channels.push(weight_channel(choice, target, by_pointer, rng));
    };
    match choice.animated_weights() {
        0 => {}
        3 => weights(Target::MeshWeights(mesh), true, rng),
        by => {
            // Of three nodes, two are animated.
            for node in 0..shown.min(2) {
                weights(Target::Weights(node), by == 2, rng);
            }
        }
    }
    if choice.animated_nodes() > 0 {
        let can_move = |node: &usize| matches!(made.nodes[*node].local, Local::Parts { .. });
        let nodes: Vec<usize> = (0..made.nodes.len()).filter(can_move).collect();
        for number in 0..nodes.len().min(8) {
            // The nodes that show the mesh, one above them, and joints.
            let node = match number {
                0..2 => nodes[number],
                2 => nodes[nodes.len() - 2],
                _ => nodes[rng.random_range(0..nodes.len())],
            };
            let target =
                [Target::Translation(node), Target::Rotation(node), Target::Scale(node)][rng.random_range(0..3)];
            if channels.iter().all(|channel| channel.target != target) {
                channels.push(node_channel(choice, target, choice.animated_nodes() == 2, rng));
            }
        }
    }
    channels
}

fn times(rng: &mut Pcg64Mcg) -> Numbers {
    let mut time = [0.0, 0.25][rng.random_range(0..2)];
    let mut times = Vec::new();
    for _ in 0..rng.random_range(1..5) {
        times.push(time);
        time += rng.random_range(0.2..1.0);
    }
    Numbers::of((F32, false), 1, times)
}

fn weight_channel(choice: &Choice, target: Target, by_pointer: bool, rng: &mut Pcg64Mcg) -> Channel {
    let times = times(rng);
    let per_key = if choice.interpolation() == Interpolation::Cubic {
        3
    } else {
        1
    };
    let kind = choice.values();
    let zeros = if choice.value_form() == Form::SparseZeros(U16) {
        0.5
    } else {
        0.1
    };
    let least = if is_signed(kind.0) { -1.0 } else { 0.0 };
    let mut value = || {
        if rng.random_bool(zeros) {
            0.0
        } else {
            rng.random_range(least..1.0)
        }
    };
    let values: Vec<f64> = (0..times.count() * per_key * choice.targets())
        .map(|_| value())
        .collect();
    Channel {
        target,
        by_pointer,
        interpolation: choice.interpolation(),
        times,
        values: Numbers::of(kind, 1, values),
    }
}

fn node_channel(choice: &Choice, target: Target, by_pointer: bool, rng: &mut Pcg64Mcg) -> Channel {
    let (times, interpolation) = (times(rng), choice.interpolation());
    let values = match target {
        Target::Rotation(_) => rotations(choice.values(), interpolation, times.count(), rng),
        target => {
            let range = if matches!(target, Target::Scale(_)) {
                0.6..1.4
            } else {
                -2.0..2.0
            };
            let mut values = Vec::new();
            for _ in 0..times.count() {
                let mut add =
                    |range: std::ops::Range<f64>| values.extend([0; 3].map(|_| rng.random_range(range.clone())));
                if interpolation == Interpolation::Cubic {
                    add(-0.5..0.5);
                    add(range.clone());
                    add(-0.5..0.5);
                } else {
                    add(range.clone());
                }
            }
            Numbers::of((F32, false), 3, values)
        }
    };
    Channel {
        target,
        by_pointer,
        interpolation,
        times,
        values,
    }
}

/// Rotations such that what is between two of them is certain.
fn rotations(kind: Kind, interpolation: Interpolation, keys: usize, rng: &mut Pcg64Mcg) -> Numbers {
    let one = largest(kind.0).unwrap_or(1.0);
    let mut written: Vec<f64> = Vec::new();
    let mut previous: Option<[f64; 4]> = None;
    for _ in 0..keys {
        let turn = loop {
            let turn = rotation(kind.0, rng);
            let cosine = previous.map_or(0.5, |previous| {
                (0..4).map(|c| previous[c] * turn[c]).sum::<f64>() / (one * one)
            });
            let is_certain = match interpolation {
                Interpolation::Cubic => (0.3..0.99).contains(&cosine),
                _ => (0.1..0.99).contains(&cosine.abs()),
            };
            if is_certain {
                break turn;
            }
        };
        previous = Some(turn);
        let tangent = |rng: &mut Pcg64Mcg| {
            let least = if is_signed(kind.0) { -0.3 } else { 0.0 };
            let number = rng.random_range(least..0.3) * one;
            if one > 1.0 { number.round() } else { number }
        };
        if interpolation == Interpolation::Cubic {
            written.extend([0; 4].map(|_| tangent(rng)));
            written.extend(turn);
            written.extend([0; 4].map(|_| tangent(rng)));
        } else {
            written.extend(turn);
        }
    }
    match largest(kind.0) {
        None => Numbers::of(kind, 4, written),
        Some(_) => Numbers::integers(kind, 4, written),
    }
}
