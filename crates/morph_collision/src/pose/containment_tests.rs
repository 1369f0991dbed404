//! No vertex outside its blended box: rounded or exact, for weights of any sign and sum.

use std::sync::Arc;

use glam::Vec3;
use proptest::prelude::*;

use super::Pose;
use crate::bounds::Aabb;
use crate::model::MorphModel;
use crate::tree::{BuildOptions, MorphBvh};

/// A mesh of random triangles over random vertices, with targets that leave about half of the vertices alone.
fn models() -> impl Strategy<Value = MorphModel> {
    (3_usize..20, 0_usize..7, -6_i32..7).prop_flat_map(|(vertices, targets, scale)| {
        let scale = 10_f32.powi(scale);
        let vector = move || prop::array::uniform3(-1_f32..1.0).prop_map(move |v| Vec3::from_array(v) * scale);
        let displacement = prop_oneof![Just(Vec3::ZERO), vector()];
        (
            prop::collection::vec(vector(), vertices),
            prop::collection::vec(prop::array::uniform3(0..vertices as u32), 1..200),
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
    let pair = (0_usize..5, 0_f32..1.0).prop_map(|(k, t)| {
        let mut weights = [0.0; 6];
        weights[k] = 1.0 - t;
        weights[k + 1] = t;
        weights
    });
    let convex = prop::array::uniform6(0_f32..1.0).prop_map(|w| w.map(|x| x / w.iter().sum::<f32>().max(1e-6)));
    prop_oneof![any, convex, pair]
}

fn options() -> impl Strategy<Value = BuildOptions> {
    (1_usize..5).prop_map(|leaf_size| BuildOptions::default().with_leaf_size(leaf_size))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2048))]

    #[test]
    fn every_vertex_lies_in_every_box_above_it(model in models(), weights in weights(), options in options()) {
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &options).unwrap());
        let mut pose = Pose::new(bvh.clone());
        pose.set_weights(&weights[..bvh.model().target_count()]).unwrap();
        let report = pose.check_containment();
        prop_assert!(report.checks >= 6 * bvh.model().triangle_count() as u64);
        prop_assert_eq!(report.first, None);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1024))]

    #[test]
    fn an_anchor_holds_every_vertex_while_weights_move_away_from_it(
        model in models(), from in weights(), to in weights(), options in options(),
    ) {
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &options).unwrap());
        let targets = bvh.model().target_count();
        let mut pose = Pose::new(bvh);
        pose.set_weights(&from[..targets]).unwrap();
        pose.take_anchor();
        prop_assert_eq!(pose.check_containment().first, None);
        pose.set_weights(&to[..targets]).unwrap();
        prop_assert!(pose.is_anchored());
        prop_assert_eq!(pose.check_containment().first, None);
    }
}

/// Two references that differ wildly, as the paper's figures have them.
fn two_references() -> Arc<MorphBvh> {
    let references = [
        vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        vec![Vec3::Z, Vec3::splat(5.0), Vec3::NEG_ONE],
    ];
    let model = MorphModel::from_references(&references, &[[0, 1, 2]]).unwrap();
    Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()).unwrap())
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
