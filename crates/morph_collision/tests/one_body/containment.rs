//! Every vertex is inside every box above it, rounded or exact, for weights of any sign and sum.

use std::sync::Arc;

use glam::Vec3;
use morph_collision::{BuildOptions, MorphBvh, Pose};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::verify::check_containment;
use proptest::prelude::*;

/// Random triangles over random vertices, with targets that do not move about half of the vertices.
fn meshes() -> impl Strategy<Value = MorphMesh> {
    (3_usize..20, 0_usize..7, -6_i32..7).prop_flat_map(|(vertices, targets, scale)| {
        let scale = 10_f32.powi(scale);
        let vector = move || prop::array::uniform3(-1_f32..1.0).prop_map(move |v| Vec3::from_array(v) * scale);
        let displacement = prop_oneof![Just(Vec3::ZERO), vector()];
        (
            prop::collection::vec(vector(), vertices),
            prop::collection::vec(prop::array::uniform3(0..vertices as u32), 1..200),
            prop::collection::vec(prop::collection::vec(displacement, vertices), targets),
        )
            .prop_map(|(positions, triangles, targets)| MorphMesh {
                targets,
                ..MorphMesh::rigid("random", positions, triangles)
            })
    })
}

/// Weights that are convex, one-hot, zero, negative or above one, and some that are very large.
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2048))]

    #[test]
    fn every_vertex_lies_in_every_box_above_it(mesh in meshes(), weights in weights(), leaf_size in 1_usize..5) {
        let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
        let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(mesh.to_model().unwrap()), &options)));
        pose.set_weights(&weights[..mesh.targets.len()]).unwrap();
        let report = check_containment(&mesh, &mut pose);
        prop_assert!(report.checks >= 6 * mesh.triangles.len() as u64);
        prop_assert_eq!(report.first, None);
    }
}
