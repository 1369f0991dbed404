//! Tests of trees built in steps.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use morph_collision_models::generated::{degenerate, dolphin, random};
use morph_collision_models::mesh::MorphMesh;

use super::builder::STEP;
use super::*;
use crate::joints::JointMatrices;
use crate::model::{Influences, MorphModel, WeightBox};
use crate::pose::Pose;
use crate::proof::{Effort, SelfProof};

/// Builds in steps. Returns the tree, the number of steps, and how many steps left no work unused.
fn in_steps(model: &Arc<MorphModel>, options: &BuildOptions) -> (MorphBvh, usize, usize) {
    finish(MorphBvhBuilder::new(model.clone(), options))
}

fn finish(mut builder: MorphBvhBuilder) -> (MorphBvh, usize, usize) {
    let (mut steps, mut long) = (1, 0);
    loop {
        let budget = builder.budget.clone();
        match builder.step() {
            ControlFlow::Break(bvh) => return (bvh, steps, long),
            ControlFlow::Continue(rest) => builder = rest,
        }
        steps += 1;
        long += usize::from(budget.left() == 0);
    }
}

/// The bits of all boxes of a tree in a few poses.
fn boxes(bvh: &MorphBvh) -> Vec<u32> {
    let mut pose = Pose::new(Arc::new(bvh.clone()));
    let mut bits = Vec::new();
    for turn in 0..3 {
        let weight = |target: usize| ((target + 3 * turn) as f32 * 0.7).sin() * 1.5;
        let weights: Vec<f32> = (0..bvh.model().target_count()).map(weight).collect();
        pose.set_weights(&weights).unwrap();
        if let Some(joints) = bvh.model().joint_count() {
            let joint = |i: usize| Affine3A::from_rotation_y(i as f32 * turn as f32);
            let joints: Vec<Affine3A> = (0..joints).map(joint).collect();
            pose.set_joints(&JointMatrices::new(&joints).unwrap()).unwrap();
        }
        pose.visit_nodes(|node| {
            let bounds = node.bounds;
            bits.extend(
                [bounds.min, bounds.max]
                    .map(|p| p.to_array().map(f32::to_bits))
                    .as_flattened(),
            );
            true
        });
    }
    bits
}

fn model_of(mesh: &MorphMesh) -> Arc<MorphModel> {
    Arc::new(MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap())
}

/// A mesh whose vertices follow three joints.
fn skinned(mesh: &MorphMesh) -> Arc<MorphModel> {
    let vertices = 0..mesh.positions.len();
    let joints: Vec<[u16; 4]> = vertices.clone().map(|i| [(i % 3) as u16, 2, 1, 0]).collect();
    let weights: Vec<[f32; 4]> = vertices
        .map(|i| [0.75, 0.25 - (i % 5) as f32 * 0.05, 0.0, 0.0])
        .collect();
    let influences = Influences {
        joints: &joints,
        weights: &weights,
    };
    Arc::new(MorphModel::skinned(&mesh.positions, &mesh.triangles, &mesh.targets, 3, &[influences]).unwrap())
}

#[test]
fn a_tree_that_is_built_in_steps_is_the_same_tree() {
    let models = [
        model_of(&dolphin(1)),
        model_of(&random::random_blob(2, 4, 5, 0.5)),
        model_of(&random::triangle_soup(3, 2000, 2)),
        model_of(&degenerate::all_equal(5000)),
        skinned(&random::random_blob(4, 4, 3, 0.5)),
    ];
    for model in &models {
        for leaf_size in [1, 8] {
            let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
            let (bvh, steps, _) = in_steps(model, &options);
            assert!(steps > 1, "{model:?}");
            let run_to_end = MorphBvh::build(model.clone(), &options);
            assert_eq!(bvh.layout(), run_to_end.layout());
            assert_eq!(bvh.bytes(), run_to_end.bytes());
            assert_eq!(boxes(&bvh), boxes(&run_to_end));
        }
    }
}

#[test]
fn no_step_is_long_and_there_are_as_many_as_the_work_takes() {
    // Every target moves nearly everything.
    let mesh = random::random_blob(1, 5, 6, 0.05);
    let (triangles, shapes) = (mesh.triangles.len(), 1 + mesh.targets.len());
    for model in [model_of(&mesh), skinned(&mesh)] {
        let (bvh, steps, long) = in_steps(&model, &BuildOptions::default());
        assert_eq!(long, 0, "of {steps} steps");
        // Each time nodes are halved, every triangle is put into boxes once per shape and axis.
        let levels = (bvh.leaf_count() as f64).log2().floor() as usize;
        let least = 3 * triangles * shapes * levels / STEP;
        println!("{triangles} triangles: {steps} steps, of at least {least}");
        assert!((least..3 * least).contains(&steps), "{steps} instead of {least}");
    }
}

#[test]
fn a_triangle_is_built_in_one_step() {
    let base = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let model = MorphModel::from_displacements::<[Vec3; 0]>(&base, &[[0, 1, 2]], &[]).unwrap();
    let (bvh, steps, _) = in_steps(&Arc::new(model), &BuildOptions::default());
    assert_eq!((bvh.node_count(), steps), (1, 1));
}

#[test]
fn a_layout_is_restored_in_steps_with_its_certificates_if_they_are_good() {
    let mesh = random::random_blob(5, 4, 12, 0.4);
    for model in [model_of(&mesh), skinned(&mesh)] {
        let built = Arc::new(MorphBvh::build(model.clone(), &BuildOptions::default()));
        let restored = |layout: &TreeLayout| finish(MorphBvhBuilder::from_layout(model.clone(), layout).unwrap());
        let (bvh, steps, _) = restored(&built.layout());
        assert!(boxes(&bvh) == boxes(&built));
        let (_, all_steps, _) = in_steps(&model, &BuildOptions::default());
        assert!((2..all_steps).contains(&steps), "{steps} of {all_steps}");
    }
    let small = model_of(&random::random_blob(3, 3, 2, 0.9));
    let certified = Arc::new(MorphBvh::build(small.clone(), &BuildOptions::default()));
    let proof = SelfProof::new(&certified, &WeightBox::unit(2), Effort::light()).unwrap();
    certified
        .set_certificates(proof.certificates(&proof.run()).unwrap())
        .unwrap();
    let restored = MorphBvhBuilder::from_layout(small, &certified.layout()).unwrap();
    assert!(finish(restored).0.layout() == certified.layout());
    let other = model_of(&random::random_blob(6, 4, 12, 0.4));
    let layout = MorphBvh::build(model_of(&mesh), &BuildOptions::default()).layout();
    assert!(matches!(
        MorphBvhBuilder::from_layout(other, &layout),
        Err(LayoutError::OtherMesh { .. })
    ));
}
