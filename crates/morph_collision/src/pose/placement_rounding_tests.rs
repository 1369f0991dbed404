//! Measures, in exact arithmetic, how close the rounding errors of placed vertices come to their bound.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::{Climb, is_as_known};
use rand::RngExt;

use super::Pose;
use crate::bounds::{ExactPoint, exact_image};
use crate::joints::JointMatrices;
use crate::model::{Influences, MorphModel};
use crate::tree::{BuildOptions, MorphBvh};

/// Number of values per matrix.
const MATRIX: usize = 12;

/// The error of a placed vertex with `n` influences, as a share of the bound `(n + 4) v W (|J| r + |t|)`. `numbers` are its position, and the
/// weights and matrices of its joints.
fn placement_share(slots: usize, numbers: &[f32]) -> Option<f64> {
    let (p, rest) = numbers.split_at(3);
    let (weights, matrices) = rest.split_at(slots);
    let place = |m: &[f32]| Affine3A::from_cols_array(&std::array::from_fn(|i| m[i]));
    let joints = JointMatrices::new(&matrices.chunks_exact(MATRIX).map(place).collect::<Vec<_>>()).ok()?;
    let weights: Vec<f32> = weights.iter().map(|weight| weight.abs()).collect();
    let set = |set: usize| {
        let at = |i: usize| 4 * set + i;
        let joints = [std::array::from_fn(|i| at(i) as u16)];
        (joints, [std::array::from_fn(|i| weights[at(i)])])
    };
    let sets: Vec<_> = (0..slots / 4).map(set).collect();
    let influences: Vec<_> = sets
        .iter()
        .map(|(joints, weights)| Influences { joints, weights })
        .collect();
    let model = MorphModel::skinned::<[Vec3; 0]>(&[Vec3::from_slice(p)], &[[0; 3]], &[], slots, &influences).ok()?;
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    pose.set_joints(&joints).ok()?;
    let found = pose.posed().world_vertex(0).to_array();
    let claimed = pose.posed().skin.as_ref().map_or(0.0, |(_, skinning)| skinning.error());
    let point: ExactPoint = std::array::from_fn(|i| Dyadic::from(p[i]));
    let reach = point.clone().into_iter().map(Dyadic::abs).max()?;
    let moved = Dyadic::from(joints.linear_reach()) * reach + Dyadic::from(joints.spread(DVec3::ZERO));
    let sum: Dyadic = weights.iter().copied().map(Dyadic::from).sum();
    let bound = Dyadic::from(slots as f64 + 4.0) * Dyadic::power_of_two(-53) * sum * moved;
    let mut share = 0.0_f64;
    for (axis, found) in found.into_iter().enumerate() {
        let image = |joint: usize| exact_image(&joints.columns(joint as u16), &point)[axis].clone();
        let exact: Dyadic = (0..slots)
            .map(|joint| Dyadic::from(weights[joint]) * image(joint))
            .sum();
        let off = (Dyadic::from(found) - exact).abs();
        assert!(off <= Dyadic::from(claimed), "{numbers:?}");
        if bound > Dyadic::zero() {
            share = share.max(off.ratio(&bound));
        }
    }
    assert!(share <= 1.0 + 1e-12, "{share}: {numbers:?}");
    Some(share)
}

#[test]
fn placed_vertices_are_off_by_nearly_their_bound_and_never_by_more() {
    for (slots, known) in [(8, 0.883), (16, 0.923)] {
        let climb = Climb {
            seed: 8,
            starts: 6,
            steps: 1500,
        };
        let others = 3 + slots;
        let (found, _) = climb.highest(
            |i, rng| {
                let mut numbers: Vec<f32> = (0..others + slots * MATRIX)
                    .map(|_| rng.random_range(-1.0..1.0))
                    .collect();
                if i.is_multiple_of(2) {
                    // One product is near 1. All values added to it are just above half a unit in its last place.
                    let tiny = 2_f32.powi(-53) * 1.01;
                    numbers[..4].fill(1.0);
                    numbers[4..others].fill(tiny);
                    for matrix in numbers[others..].chunks_exact_mut(MATRIX) {
                        matrix[..3].fill(1.01);
                        matrix[3..].fill(tiny);
                    }
                }
                numbers
            },
            |numbers| placement_share(slots, numbers),
        );
        println!("vertices with {slots} influences: {found:.3} of the bound");
        assert!(
            is_as_known(found, known),
            "{slots} influences: {found} of the bound, known is {known}"
        );
    }
}
