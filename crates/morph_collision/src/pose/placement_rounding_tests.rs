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

/// The error of a placed vertex, as a share of the bound `12 v W (|J| r + |t|)`. `numbers` are its position, and the weights and
/// matrices of its joints.
fn placement_share(numbers: &[f32]) -> Option<f64> {
    const SLOTS: usize = 8;
    let (p, rest) = numbers.split_at(3);
    let (weights, matrices) = rest.split_at(SLOTS);
    let place = |m: &[f32]| Affine3A::from_cols_array(&std::array::from_fn(|i| m[i]));
    let joints = JointMatrices::new(&matrices.chunks_exact(MATRIX).map(place).collect::<Vec<_>>()).ok()?;
    let weights: [f32; SLOTS] = std::array::from_fn(|i| weights[i].abs());
    let four = |at: usize| [[weights[at], weights[at + 1], weights[at + 2], weights[at + 3]]];
    let sets = [four(0), four(4)];
    let influences = [
        Influences {
            joints: &[[0, 1, 2, 3]],
            weights: &sets[0],
        },
        Influences {
            joints: &[[4, 5, 6, 7]],
            weights: &sets[1],
        },
    ];
    let model = MorphModel::skinned::<[Vec3; 0]>(&[Vec3::from_slice(p)], &[[0; 3]], &[], SLOTS, &influences).ok()?;
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    pose.set_joints(&joints).ok()?;
    let found = pose.posed().world_vertex(0).to_array();
    let claimed = pose.posed().skin.as_ref().map_or(0.0, |(_, skinning)| skinning.error());
    let point: ExactPoint = std::array::from_fn(|i| Dyadic::from(p[i]));
    let reach = point.clone().into_iter().map(Dyadic::abs).max()?;
    let moved = Dyadic::from(joints.linear_reach()) * reach + Dyadic::from(joints.spread(DVec3::ZERO));
    let sum: Dyadic = weights.into_iter().map(Dyadic::from).sum();
    let bound = Dyadic::from(12.0_f64) * Dyadic::power_of_two(-53) * sum * moved;
    let mut share = 0.0_f64;
    for (axis, found) in found.into_iter().enumerate() {
        let image = |joint: usize| exact_image(&joints.columns(joint as u16), &point)[axis].clone();
        let exact: Dyadic = (0..SLOTS)
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
    let climb = Climb {
        seed: 8,
        starts: 6,
        steps: 1500,
    };
    let (found, _) = climb.highest(
        |i, rng| {
            let mut numbers: Vec<f32> = (0..11 + 8 * MATRIX).map(|_| rng.random_range(-1.0..1.0)).collect();
            if i.is_multiple_of(2) {
                // One product is near 1. All values added to it are just above half a unit in its last place.
                let tiny = 2_f32.powi(-53) * 1.01;
                numbers[..4].fill(1.0);
                numbers[4..11].fill(tiny);
                for matrix in numbers[11..].chunks_exact_mut(MATRIX) {
                    matrix[..3].fill(1.01);
                    matrix[3..].fill(tiny);
                }
            }
            numbers
        },
        placement_share,
    );
    println!("vertices: {found:.3} of the bound");
    assert!(is_as_known(found, 0.883), "{found} of the bound, known is 0.883");
}
