//! Boxes under joints are as small as rounding allows. Around single points, only rounding gives them a size.

use std::sync::Arc;

use glam::{Affine3A, EulerRot, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::bounds::Aabb;
use crate::{BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, Pose, WorldFromModel};

const COUNT: usize = 40;

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;

fn vector(rng: &mut Pcg64Mcg, reach: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| rng.random_range(-reach..reach)))
}

/// A displacement that intervals store without rounding.
fn displacement(rng: &mut Pcg64Mcg) -> Vec3 {
    Aabb::from_points([vector(rng, 0.3)]).coarse().min
}

/// Triangles that are points. Each is a leaf, moved by two targets and by some of three joints with weights that sum to 1.
fn points(rng: &mut Pcg64Mcg, weights: [f32; 4]) -> Pose {
    let base: Vec<Vec3> = (0..COUNT).map(|_| vector(rng, 1.0)).collect();
    let targets = [(); 2].map(|()| (0..COUNT).map(|_| displacement(rng)).collect::<Vec<_>>());
    let triangles: Vec<_> = (0..COUNT as u32).map(|i| [i; 3]).collect();
    let joints: Vec<[u16; 4]> = (0..COUNT as u16).map(|i| [i % 3, (i + 1) % 3, 0, 0]).collect();
    let influences = Influences {
        joints: &joints,
        weights: &[weights; COUNT],
    };
    let model = MorphModel::skinned(&base, &triangles, &targets, 3, &[influences]).unwrap();
    let options = BuildOptions::default().with_leaf_size(1).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &options)))
}

/// A random rotation, and a translation of up to `far` from `at`.
fn joints(rng: &mut Pcg64Mcg, far: f32, at: Vec3) -> JointMatrices {
    let joint = [(); 3].map(|()| {
        let [x, y, z] = vector(rng, 3.0).to_array();
        Affine3A::from_rotation_translation(Quat::from_euler(EulerRot::XYZ, x, y, z), at + vector(rng, far))
    });
    JointMatrices::new(&joint).unwrap()
}

/// The largest side of any leaf's box.
fn largest_leaf(pose: &mut Pose) -> f32 {
    let mut largest = 0.0_f32;
    pose.visit_nodes(|node| {
        if node.is_leaf {
            largest = largest.max(node.bounds.size().max_element());
        }
        true
    });
    largest
}

#[test]
fn boxes_around_points_are_as_small_as_roundings() {
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    for weights in [[1.0, 0.0, 0.0, 0.0], [0.75, 0.25, 0.0, 0.0]] {
        for far in [0.1, 10.0, 1000.0] {
            let mut pose = points(&mut rng, weights);
            let mut worst = 0.0_f32;
            for _ in 0..20 {
                pose.set_joints(&joints(&mut rng, far, Vec3::ZERO)).unwrap();
                pose.set_weights(&[rng.random_range(-1.0..2.0), rng.random_range(0.0..1.0)])
                    .unwrap();
                // The size of coordinates, plus the distance between joints.
                let reach = 2.0 + 2.0 * far;
                worst = worst.max(largest_leaf(&mut pose) / (U * reach));
            }
            // Measured: 4.1 to 5.5.
            assert!((1.0..10.0).contains(&worst), "{weights:?} {far}: {worst}");
        }
    }
}

/// The origin of boxes is in the body, so where it is does not matter.
#[test]
fn boxes_are_as_small_far_away() {
    let mut rng = Pcg64Mcg::seed_from_u64(10);
    let mut pose = points(&mut rng, [0.75, 0.25, 0.0, 0.0]);
    for at in [0.0, 1e3, -1e7] {
        let mut worst = 0.0_f32;
        for _ in 0..20 {
            pose.set_joints(&joints(&mut rng, 0.1, Vec3::new(at, 0.0, 2.0 * at)))
                .unwrap();
            worst = worst.max(largest_leaf(&mut pose) / (2.2 * U));
        }
        // Measured: 3.6.
        assert!((1.0..10.0).contains(&worst), "{at}: {worst}");
    }
}

#[test]
fn bounds_of_a_body_that_one_joint_moves_are_as_small_as_roundings() {
    let mut rng = Pcg64Mcg::seed_from_u64(9);
    for far in [0.1, 10.0, 1000.0] {
        let mut worst = [0.0_f32; 4];
        for _ in 0..20 {
            let base = [vector(&mut rng, 1.0)];
            let influences = Influences {
                joints: &[[0; 4]],
                weights: &[[1.0, 0.0, 0.0, 0.0]],
            };
            let model = MorphModel::skinned(&base, &[[0; 3]], &[[displacement(&mut rng)]], 3, &[influences]).unwrap();
            let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
            pose.set_joints(&joints(&mut rng, far, Vec3::ZERO)).unwrap();
            pose.set_weights(&[rng.random_range(-1.0..2.0)]).unwrap();
            let place = WorldFromModel::IDENTITY;
            let turned = Affine3A::from_rotation_translation(Quat::from_rotation_y(1.0), vector(&mut rng, far));
            let turned = WorldFromModel::new(turned).unwrap();
            let bounds = [
                pose.bounds(),
                pose.world_bounds(&place),
                pose.broad_phase_bounds(&place),
                pose.local_bounds(&turned),
            ];
            for (worst, bounds) in worst.iter_mut().zip(bounds) {
                *worst = worst.max(bounds.size().max_element() / (U * (2.0 + 2.0 * far)));
            }
        }
        // Measured: up to 25 and 23.
        assert!(
            worst.iter().all(|worst| (0.1..40.0).contains(worst)),
            "{far}: {worst:?}"
        );
    }
}
