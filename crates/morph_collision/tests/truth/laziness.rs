//! Counts the work of pair queries. A tree that answers correctly but visits everything would pass every other test.

use crate::scenes::{self, dolphins, pass_through};
use morph_collision::{Body, BuildOptions, ConvexRegion, PairQuery, QueryStats, ShapeQuery};

#[test]
fn only_the_children_of_the_roots_are_blended_when_they_are_apart() {
    let scene = pass_through(0);
    for options in [
        BuildOptions::default().with_leaf_size(1).unwrap(),
        BuildOptions::default(),
    ] {
        let (pairs, stats) = scenes::answer(&scene, &options);
        assert!(pairs.is_empty());
        assert_eq!(stats.nodes_blended, 16, "eight children of each root");
        assert_eq!(stats.node_tests, 1);
        assert_eq!((stats.triangle_tests, stats.vertices_blended), (0, 0));
    }
}

#[test]
fn a_few_percent_of_the_nodes_are_blended_when_bodies_barely_touch() {
    let scene = pass_through(42);
    let model = std::sync::Arc::new(scene.meshes[0].to_model().unwrap());
    let nodes = 2 * morph_collision::MorphBvh::build(model, &BuildOptions::default().with_leaf_size(1).unwrap())
        .node_count() as u64;
    let (pairs, stats) = scenes::answer(&scene, &BuildOptions::default().with_leaf_size(1).unwrap());
    assert!(!pairs.is_empty());
    assert!(
        stats.nodes_blended * 25 < nodes,
        "{} of {nodes} nodes",
        stats.nodes_blended
    );
    assert!(
        stats.vertices_blended * 50 < 2 * 10242,
        "{} vertices",
        stats.vertices_blended
    );
}

/// The nodes that pair queries blend, plus those that are still missing afterwards, are all nodes of every tree, each counted once.
#[test]
fn a_node_is_blended_once_however_many_bodies_meet_it() {
    let everywhere = ConvexRegion::from_half_spaces(&[]).unwrap();
    for scene in [dolphins(200), pass_through(200)] {
        for leaf_size in [1, 8] {
            let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
            let about = format!("{}, leaves of {leaf_size}", scene.name);
            let (mut poses, places) = scenes::poses(&scene, &options);
            let nodes: u64 = poses.iter().map(|pose| pose.bvh().node_count() as u64).sum();
            let mut query = PairQuery::new();
            let mut ask_all_pairs = || {
                let mut stats = QueryStats::default();
                for b in 0..places.len() {
                    for a in 0..b {
                        let [pose_a, pose_b] = poses.get_disjoint_mut([a, b]).unwrap();
                        let (a, b) = (Body::new(pose_a, &places[a]), Body::new(pose_b, &places[b]));
                        query.all(a, b, &mut Vec::new());
                        stats += query.stats();
                    }
                }
                stats
            };
            let (first, again) = (ask_all_pairs(), ask_all_pairs());
            assert!(
                first.nodes_blended > 0 && first.triangle_tests > 0,
                "{about}: {first:?}"
            );
            assert!(
                first.node_tests > 2 * first.nodes_blended,
                "{about}: nodes must be met more than once: {first:?}"
            );
            assert_eq!(again.node_tests, first.node_tests, "{about}");
            assert_eq!(again.nodes_blended, 0, "{about}: everything is there already");
            let missing: u64 = poses
                .iter_mut()
                .zip(&places)
                .map(|(pose, place)| {
                    let body = Body::new(pose, place);
                    let mut query = ShapeQuery::new();
                    query.all_in_region(body, &everywhere, &mut Vec::new());
                    query.stats().nodes_blended
                })
                .sum();
            assert_eq!(first.nodes_blended + missing, nodes, "{about}");
        }
    }
}

#[test]
fn a_first_pair_is_looked_for_where_bodies_reach_deepest_into_each_other() {
    use morph_collision::{MorphBvh, Pose, WorldFromModel};
    use std::ops::ControlFlow;

    let model = std::sync::Arc::new(pass_through(0).meshes[0].to_model().unwrap());
    let bvh = std::sync::Arc::new(MorphBvh::build(model, &BuildOptions::default()));
    let (mut first, mut in_order) = (QueryStats::default(), QueryStats::default());
    for frame in (60..340).step_by(20) {
        let scene = pass_through(frame);
        let place = |body: usize| WorldFromModel::new(scene.bodies[body].2).unwrap();
        let places = [place(0), place(1)];
        let mut query = PairQuery::new();
        let mut run = |deepest_first: bool| {
            let mut poses = [0, 1].map(|body: usize| {
                let mut pose = Pose::new(bvh.clone());
                pose.set_weights(&scene.bodies[body].1).unwrap();
                pose
            });
            let [a, b] = &mut poses;
            let (a, b) = (Body::new(a, &places[0]), Body::new(b, &places[1]));
            if deepest_first {
                let found = query.first(a, b);
                let stats = query.stats();
                (found.is_some(), stats)
            } else {
                let mut found = false;
                query.visit(a, b, |_| {
                    found = true;
                    ControlFlow::Break(())
                });
                (found, query.stats())
            }
        };
        let (one, other) = (run(true), run(false));
        assert_eq!(one.0, other.0, "frame {frame}");
        first += one.1;
        in_order += other.1;
    }
    let much_less = |less: u64, more: u64| less * 4 < more * 3;
    assert!(
        much_less(first.nodes_blended, in_order.nodes_blended)
            && much_less(first.triangle_tests, in_order.triangle_tests),
        "{first:?} and {in_order:?}"
    );
}
