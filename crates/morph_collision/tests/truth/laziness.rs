//! What is looked at, counted: a tree that answers right but looks at everything would pass every other test.

use crate::scenes::{self, dolphins, pass_through};
use morph_collision::BuildOptions;

#[test]
fn only_the_roots_are_blended_when_they_are_apart() {
    let scene = pass_through(0);
    for options in [BuildOptions::paper(), BuildOptions::default()] {
        let (pairs, stats) = scenes::answer(&scene, &options);
        assert!(pairs.is_empty());
        assert_eq!(stats.volumes_blended, 2, "one root for each body");
        assert_eq!(stats.node_tests, 1);
        assert_eq!((stats.triangle_tests, stats.vertices_blended), (0, 0));
    }
}

#[test]
fn a_few_percent_of_the_nodes_are_blended_when_bodies_barely_touch() {
    let scene = pass_through(42);
    let model = std::sync::Arc::new(scene.meshes[0].to_model().unwrap());
    let nodes = 2 * morph_collision::MorphBvh::build(model, &BuildOptions::paper())
        .unwrap()
        .node_count() as u64;
    let (pairs, stats) = scenes::answer(&scene, &BuildOptions::paper());
    assert!(!pairs.is_empty());
    assert!(
        stats.volumes_blended * 25 < nodes,
        "{} of {nodes} nodes",
        stats.volumes_blended
    );
    assert!(
        stats.vertices_blended * 50 < 2 * 10242,
        "{} vertices",
        stats.vertices_blended
    );
}

#[test]
fn a_node_is_blended_once_however_many_bodies_meet_it() {
    let scene = dolphins(200);
    let model = std::sync::Arc::new(scene.meshes[0].to_model().unwrap());
    let bvh = morph_collision::MorphBvh::build(model, &BuildOptions::paper()).unwrap();
    let (_, stats) = scenes::answer(&scene, &BuildOptions::paper());
    assert!(stats.volumes_blended < 12 * bvh.node_count() as u64);
    assert!(stats.vertices_blended <= 12 * bvh.model().vertex_count() as u64);
}
