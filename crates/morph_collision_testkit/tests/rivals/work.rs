//! The work of methods, by their own counts.

use morph_collision::QueryStats;
use morph_collision_testkit::moments;
use morph_collision_testkit::rivals::{MethodKind, MethodOptions, PaperOptions};

use crate::answer;

#[test]
fn the_work_is_what_each_method_is_known_for() {
    let moment = moments::pass_through(42);
    let work = |kind| answer(&moment, kind, &MethodOptions::default()).1;
    let morph = work(MethodKind::Morph);
    let (bottom_up, hybrid) = (work(MethodKind::BottomUpScalar), work(MethodKind::HybridScalar));
    assert_eq!(bottom_up.vertices_blended, 2 * 10242, "all vertices of both bodies");
    assert_eq!(hybrid.vertices_blended, bottom_up.vertices_blended);
    assert!(morph.vertices_blended * 20 < bottom_up.vertices_blended);
    assert!(hybrid.nodes_blended * 4 < bottom_up.nodes_blended);
    assert!(morph.nodes_blended < hybrid.nodes_blended * 4);
    // With our code, the corners of leaves are blended again where the walk tests triangles, as in ours.
    let [strong_bottom_up, strong_hybrid] = [work(MethodKind::BottomUp), work(MethodKind::Hybrid)];
    for strong in [strong_bottom_up, strong_hybrid] {
        let of_walk = strong.vertices_blended - bottom_up.vertices_blended;
        assert!((1..=morph.vertices_blended).contains(&of_walk), "{of_walk}");
        assert!(
            strong.node_tests <= morph.node_tests,
            "tight boxes: {strong:?}, {morph:?}"
        );
        assert!(strong.triangle_tests <= morph.triangle_tests, "{strong:?}, {morph:?}");
    }
    assert!(strong_hybrid.nodes_blended * 4 < strong_bottom_up.nodes_blended);
    for options in PaperOptions::all() {
        let paper = work(MethodKind::Paper(options));
        assert!(
            paper.vertices_blended * 20 < bottom_up.vertices_blended,
            "{options:?}: {paper:?}"
        );
        // Its trees have more nodes than triangles.
        assert!(paper.nodes_blended * 10 < 2 * 20480, "{options:?}: {paper:?}");
    }
}

/// The floor is the same tree over a mesh that never moved, with tight boxes. It visits only what has to be
/// visited.
#[test]
fn blended_boxes_visit_little_more_than_tight_ones() {
    for (moment, most) in [
        (moments::pass_through(42), 1.55),
        // Only one target has a weight, so its boxes are tight.
        (moments::pass_through(200), 1.0),
        (moments::dolphins(100), 1.02),
        (moments::dolphins(200), 1.05),
    ] {
        let work = |kind| answer(&moment, kind, &MethodOptions::default()).1;
        let (morph, floor) = (work(MethodKind::Morph), work(MethodKind::RigidFloor));
        for (what, of) in [
            ("node tests", (|work| work.node_tests) as fn(QueryStats) -> u64),
            ("nodes blended", |work| work.nodes_blended),
            ("vertices blended", |work| work.vertices_blended),
            ("triangle tests", |work| work.triangle_tests),
        ] {
            let (ours, least) = (of(morph), of(floor));
            let ratio = ours as f64 / least as f64;
            assert!(
                least > 0 && ratio <= most,
                "{}: {what}, {ours} for {least}, {ratio} times",
                moment.name
            );
        }
    }
}

#[test]
fn a_body_with_the_weights_that_it_had_costs_nothing_again() {
    let moment = moments::dolphins(100);
    for kind in [
        MethodKind::BottomUp,
        MethodKind::Hybrid,
        MethodKind::BottomUpScalar,
        MethodKind::HybridScalar,
        MethodKind::ParryTriMesh,
    ] {
        let mut method = kind.set_up(&moment.meshes, &[0], &MethodOptions::default()).unwrap();
        let (_, weights, place) = &moment.bodies[0];
        method.set_body(0, weights, place).unwrap();
        let before = method.work();
        assert!(before.nodes_blended > 0);
        method.set_body(0, weights, place).unwrap();
        assert_eq!(method.work(), before, "{kind}");
    }
}
