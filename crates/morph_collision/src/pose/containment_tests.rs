//! No vertex outside its blended box: rounded or exact, for weights of any sign and sum.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use proptest::prelude::*;

use super::Pose;
use crate::bounds::Aabb;
use crate::model::MorphModel;
use crate::tree::{BuildOptions, ChildKind, MorphBvh};

/// A mesh of random triangles over random vertices, with targets that leave about half of the vertices alone.
fn models() -> impl Strategy<Value = MorphModel> {
    (3_usize..20, 0_usize..7, -6_i32..7).prop_flat_map(|(vertices, targets, scale)| {
        let scale = 10_f32.powi(scale);
        let vector = move || prop::array::uniform3(-1_f32..1.0).prop_map(move |v| Vec3::from_array(v) * scale);
        let displacement = prop_oneof![Just(Vec3::ZERO), vector()];
        (
            prop::collection::vec(vector(), vertices),
            prop::collection::vec(prop::array::uniform3(0..vertices as u32), 1..40),
            prop::collection::vec(prop::collection::vec(displacement, vertices), targets),
        )
            .prop_map(|(base, triangles, targets)| MorphModel::from_displacements(&base, &triangles, &targets).unwrap())
    })
}

/// Convex, one-hot, zero, negative, above one, sums of twelve and far beyond.
fn weights() -> impl Strategy<Value = [f32; 6]> {
    let weight = prop_oneof![
        3 => 0_f32..1.0,
        1 => Just(0.0),
        1 => Just(1.0),
        1 => -1e-7_f32..1e-7,
        1 => -3_f32..3.0,
        1 => -1e6_f32..1e6,
    ];
    let any = prop::array::uniform6(weight);
    let convex = prop::array::uniform6(0_f32..1.0).prop_map(|w| w.map(|x| x / w.iter().sum::<f32>().max(1e-6)));
    prop_oneof![any, convex]
}

fn exact_vertex(model: &MorphModel, vertex: u32, weights: &[f32]) -> DVec3 {
    model
        .displacements(vertex)
        .iter()
        .fold(model.base(vertex).as_dvec3(), |p, d| {
            p + d.delta.as_dvec3() * f64::from(weights[d.target as usize])
        })
}

/// Checks every box of the tree against every vertex below it; returns how many checks were made.
fn check_subtree(pose: &mut Pose, group: usize, above: &mut Vec<Aabb>) -> usize {
    let slot = pose.open(group);
    let bvh = pose.bvh().clone();
    let mut checks = 0;
    for (lane, child) in bvh.group(group).children().iter().enumerate() {
        above.push(pose.boxes(slot).get(lane));
        checks += match child.kind() {
            ChildKind::Group(group) => check_subtree(pose, group, above),
            ChildKind::Leaf(leaf) => {
                let vertices = bvh
                    .leaf_triangles(leaf)
                    .iter()
                    .flat_map(|&t| bvh.model().triangle(t as usize));
                vertices.map(|vertex| check_vertex(pose, vertex, above)).sum()
            }
        };
        above.pop();
    }
    checks
}

fn check_vertex(pose: &mut Pose, vertex: u32, boxes: &[Aabb]) -> usize {
    let rounded = pose.vertex(vertex);
    let exact = exact_vertex(pose.bvh().model(), vertex, pose.weights());
    for bounds in boxes {
        assert!(
            bounds.contains(rounded),
            "{rounded} outside {bounds:?}, weights {:?}",
            pose.weights()
        );
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        assert!(
            min.cmple(exact).all() && exact.cmple(max).all(),
            "exact {exact} outside {bounds:?}, weights {:?}",
            pose.weights()
        );
    }
    boxes.len()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn every_vertex_lies_in_every_box_above_it(model in models(), weights in weights(), leaf_size in 1_usize..5) {
        let options = BuildOptions::default().with_leaf_size(leaf_size);
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &options).unwrap());
        let mut pose = Pose::new(bvh.clone());
        pose.set_weights(&weights[..bvh.model().target_count()]).unwrap();
        let checks = check_subtree(&mut pose, 0, &mut Vec::new());
        prop_assert!(checks >= 3 * bvh.model().triangle_count());
    }
}

/// Two references that differ wildly, as the paper's figures have them.
fn two_references() -> Arc<MorphBvh> {
    let references = [
        vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        vec![Vec3::Z, Vec3::splat(5.0), Vec3::NEG_ONE],
    ];
    let model = MorphModel::from_references(&references, &[[0, 1, 2]]).unwrap();
    Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::paper()).unwrap())
}

#[test]
fn blended_boxes_are_tight_at_each_reference() {
    let mut pose = Pose::new(two_references());
    for (weight, expected) in [
        (
            0.0,
            Aabb {
                min: Vec3::ZERO,
                max: Vec3::new(1.0, 1.0, 0.0),
            },
        ),
        (
            1.0,
            Aabb {
                min: Vec3::NEG_ONE,
                max: Vec3::splat(5.0),
            },
        ),
    ] {
        pose.set_weights(&[weight]).unwrap();
        let bounds = pose.bounds();
        assert!(bounds.min.abs_diff_eq(expected.min, 1e-5), "{bounds:?} at {weight}");
        assert!(bounds.max.abs_diff_eq(expected.max, 1e-5), "{bounds:?} at {weight}");
    }
}

#[test]
fn a_weight_just_above_one_loosens_a_box_by_next_to_nothing() {
    let mut pose = Pose::new(two_references());
    pose.set_weights(&[1.0 + 2.0 * f32::EPSILON]).unwrap();
    assert!(pose.bounds().max.max_element() < 5.0 + 1e-4);
}
