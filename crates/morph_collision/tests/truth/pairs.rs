//! Intersecting triangle pairs, checked against brute force in exact arithmetic for every way to build a tree.

use crate::scenes::{self, Scene};
use morph_collision::BuildOptions;

/// Leaves of every kind: single triangles, too few triangles for patches, full and half-empty patches, several patches, and one leaf for
/// everything.
fn matrix() -> Vec<BuildOptions> {
    let leaf_size = |size| BuildOptions::default().with_leaf_size(size).unwrap();
    [1, 2, 3, 5, 8, 9, 16, 255].map(leaf_size).to_vec()
}

/// Returns how many pairs touch.
fn agrees(scene: &Scene, options: &[BuildOptions]) -> usize {
    let truth = scene.truth();
    for options in options {
        let (answer, _) = scenes::answer(scene, options);
        let missed = truth.iter().find(|pair| answer.binary_search(pair).is_err());
        let spurious = answer.iter().find(|pair| truth.binary_search(pair).is_err());
        assert!(
            missed.is_none() && spurious.is_none() && answer.len() == truth.len(),
            "{}: missed {missed:?}, spurious {spurious:?} with {options:?}",
            scene.name
        );
    }
    truth.len()
}

#[test]
fn every_tree_gives_the_same_pairs_on_generated_scenes() {
    let mut touching = 0;
    for scene in scenes::generated() {
        touching += agrees(&scene, &matrix());
    }
    assert!(touching > 1000, "only {touching} pairs to find");
}

#[test]
fn the_pass_through_agrees_with_the_oracle() {
    for step in [45, 200] {
        let scene = scenes::pass_through(step);
        let options = [
            BuildOptions::default(),
            BuildOptions::default().with_leaf_size(1).unwrap(),
        ];
        assert!(agrees(&scene, &options) > 0);
    }
}

#[test]
fn real_models_agree_with_weights_of_any_sign_and_sum() {
    const HEAD: &str = "mh_head_eyes_teeth_arkit52.glb";
    let mut touching_heads = 0;
    let weights: [fn(usize, usize) -> f32; 4] = [
        |body, target| if target == body { 1.0 } else { 0.0 },
        |body, target| ((body + target) % 5) as f32 * 0.1,
        |body, target| ((3 * body + 7 * target) % 11) as f32 * 0.2 - 0.6,
        |_, target| if target % 4 == 0 { 1.0 } else { -0.05 },
    ];
    let options = [
        BuildOptions::default(),
        BuildOptions::default().with_leaf_size(1).unwrap(),
        BuildOptions::default().with_leaf_size(20).unwrap(),
    ];
    for name in [
        "AnimatedMorphCube.gltf",
        "AnimatedMorphSphere.gltf",
        "SimpleMorph.gltf",
        "MorphStressTest.gltf",
        HEAD,
        "ict_face_skin.glb",
    ] {
        for weights in weights {
            if let Some(scene) = scenes::from_file(name, weights) {
                let touching = agrees(&scene, &options);
                touching_heads += usize::from(name == HEAD && touching > 0);
            }
        }
    }
    assert_eq!(touching_heads, weights.len(), "the head is in assets/");
}

#[test]
fn bodies_with_different_trees_give_the_same_pairs() {
    use std::ops::ControlFlow;
    use std::sync::Arc;

    use morph_collision::{Body, MorphBvh, PairQuery, Pose, WorldFromModel};

    let scene = &scenes::generated()[2];
    let truth = scene.truth();
    assert!(!truth.is_empty());
    let model = Arc::new(scene.meshes[0].to_model().unwrap());
    for options_a in matrix() {
        for options_b in matrix() {
            let mut bodies = [(0, &options_a), (1, &options_b)].map(|(body, options)| {
                let mut pose = Pose::new(Arc::new(MorphBvh::build(model.clone(), options)));
                pose.set_weights(&scene.bodies[body].1).unwrap();
                (pose, WorldFromModel::new(scene.bodies[body].2).unwrap())
            });
            let [(a, place_a), (b, place_b)] = &mut bodies;
            let mut pairs = Vec::new();
            PairQuery::new().all(Body::new(a, place_a), Body::new(b, place_b), &mut pairs);
            let mut visited = Vec::new();
            PairQuery::new().visit(Body::new(a, place_a), Body::new(b, place_b), |pair| {
                visited.push(pair);
                ControlFlow::Continue(())
            });
            assert_eq!(visited, pairs);
            let mut pairs: Vec<_> = pairs.iter().map(|p| [0, 1, p.triangle_a, p.triangle_b]).collect();
            pairs.sort_unstable();
            assert_eq!(pairs, truth, "{options_a:?} against {options_b:?}");
        }
    }
}
