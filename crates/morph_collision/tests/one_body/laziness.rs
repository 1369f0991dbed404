//! Counts the work of queries about one body. Walks that cull nothing would pass every other test.

use glam::{Affine3A, DVec3, Quat, Vec3};
use morph_collision::{Aabb, Body, ConvexRegion, DistanceQuery, Pose, QueryStats, Ray, RayQuery, ShapeQuery};
use morph_collision_models::generated::dolphin;

use crate::bodies::Case;

fn swimming(shift: f32) -> Case {
    let turned = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.3);
    let world_from_model = Affine3A::from_scale_rotation_translation(Vec3::new(2.0, 0.5, 1.0), turned, Vec3::X * shift);
    Case::new("dolphin", dolphin(2), vec![0.4, 0.0], world_from_model)
}

#[test]
fn a_query_blends_a_small_part_of_the_tree() {
    let case = swimming(0.0);
    let world_from_model = case.world_from_model();
    let center = world_from_model.transform_point(Vec3::ZERO);
    let fresh = || -> Pose { case.poses().swap_remove(0) };
    let nodes = fresh().bvh().node_count() as u64;
    let small = |stats: QueryStats, what: &str| {
        assert!(stats.nodes_blended * 12 < nodes, "{what}: {stats:?} of {nodes} nodes");
        assert!(
            stats.vertices_blended > 0 && stats.triangle_tests < 400,
            "{what}: {stats:?}"
        );
        assert!(stats.node_tests >= stats.nodes_blended, "{what}: {stats:?}");
    };
    let ray = Ray::new(center + DVec3::new(0.1, 5.0, 0.0), DVec3::NEG_Y, f64::INFINITY).unwrap();
    let mut rays = RayQuery::new();
    assert!(rays.closest(Body::new(&mut fresh(), &world_from_model), &ray).is_some());
    small(rays.stats(), "closest hit");
    assert!(rays.any(Body::new(&mut fresh(), &world_from_model), &ray));
    small(rays.stats(), "any hit");
    let point = center + DVec3::new(0.2, 0.4, 0.1);
    let mut shapes = ShapeQuery::new();
    let closest = shapes.closest_point(Body::new(&mut fresh(), &world_from_model), point, f64::INFINITY);
    assert!(closest.unwrap().is_some());
    small(shapes.stats(), "closest point");
    let middle = (center + DVec3::new(0.4, 0.0, -0.3)).as_vec3();
    let region = ConvexRegion::from_aabb(&Aabb {
        min: middle - 0.05,
        max: middle + 0.05,
    });
    let mut triangles = Vec::new();
    shapes.all_in_region(
        Body::new(&mut fresh(), &world_from_model),
        &region.unwrap(),
        &mut triangles,
    );
    let stats = shapes.stats();
    assert!(stats.nodes_blended * 5 < nodes, "region: {stats:?} of {nodes} nodes");
}

#[test]
fn a_miss_looks_at_the_root_only() {
    let case = swimming(0.0);
    let world_from_model = case.world_from_model();
    let mut pose = case.poses().swap_remove(0);
    let past = Ray::new(DVec3::new(0.0, 9.0, 0.0), DVec3::Y, f64::INFINITY).unwrap();
    let mut rays = RayQuery::new();
    let hit = rays.closest(Body::new(&mut pose, &world_from_model), &past);
    let stats = rays.stats();
    assert_eq!((hit, stats.node_tests, stats.vertices_blended), (None, 1, 0));
    let mut shapes = ShapeQuery::new();
    let closest = shapes
        .closest_point(Body::new(&mut pose, &world_from_model), DVec3::splat(50.0), 1.0)
        .unwrap();
    let stats = shapes.stats();
    assert_eq!((closest, stats.node_tests, stats.vertices_blended), (None, 1, 0));
}

#[test]
fn a_distance_looks_at_a_small_part_of_both_trees() {
    let (a, b) = (swimming(0.0), swimming(5.0));
    let (place_a, place_b) = (a.world_from_model(), b.world_from_model());
    let (mut pose_a, mut pose_b) = (a.poses().swap_remove(0), b.poses().swap_remove(0));
    let nodes = 2 * pose_a.bvh().node_count() as u64;
    let mut query = DistanceQuery::new();
    let bodies = (Body::new(&mut pose_a, &place_a), Body::new(&mut pose_b, &place_b));
    assert!(query.closest(bodies.0, bodies.1, f64::INFINITY).unwrap().is_some());
    let stats = query.stats();
    assert!(stats.nodes_blended * 8 < nodes, "{stats:?} of {nodes} nodes");
    let bodies = (Body::new(&mut pose_a, &place_a), Body::new(&mut pose_b, &place_b));
    assert_eq!(query.closest(bodies.0, bodies.1, 0.01).unwrap(), None);
    let stats = query.stats();
    assert!(stats.node_tests < 10 && stats.triangle_tests == 0, "{stats:?}");
}

/// Every kind of query reuses the boxes that earlier queries blended, so that in the end each box was blended exactly once. Vertices
/// are blended only for the leaves that a query reads.
#[test]
fn the_boxes_that_one_query_blends_the_next_one_finds() {
    type Ask<'a> = Box<dyn Fn(Body<'_>) -> QueryStats + 'a>;
    let case = swimming(0.0);
    let world_from_model = case.world_from_model();
    let center = world_from_model.transform_point(Vec3::ZERO);
    let ray = Ray::new(center + DVec3::new(0.1, 5.0, 0.0), DVec3::NEG_Y, f64::INFINITY).unwrap();
    let point = center + DVec3::new(0.2, 0.4, 0.1);
    let everywhere = ConvexRegion::from_half_spaces(&[]).unwrap();
    let asks: [(&str, Ask<'_>); 4] = [
        (
            "ray",
            Box::new(|body| {
                let mut query = RayQuery::new();
                query.closest(body, &ray);
                query.stats()
            }),
        ),
        (
            "all hits",
            Box::new(|body| {
                let mut query = RayQuery::new();
                query.all(body, &ray, &mut Vec::new());
                query.stats()
            }),
        ),
        (
            "closest point",
            Box::new(|body| {
                let mut query = ShapeQuery::new();
                query.closest_point(body, point, f64::INFINITY).unwrap();
                query.stats()
            }),
        ),
        (
            "region",
            Box::new(|body| {
                let mut query = ShapeQuery::new();
                query.all_in_region(body, &everywhere, &mut Vec::new());
                query.stats()
            }),
        ),
    ];
    for mut pose in case.poses() {
        let bvh = pose.bvh().clone();
        let mut of_root = 0;
        pose.clone().visit_nodes(|node| {
            of_root += u64::from(node.depth == 1);
            node.depth == 0
        });
        // Queries blend the body's bounds, which come from the root's children, before they start to count.
        pose.bounds();
        let mut total = QueryStats {
            nodes_blended: of_root,
            ..QueryStats::default()
        };
        for (what, query) in &asks {
            let first = query(Body::new(&mut pose, &world_from_model));
            let again = query(Body::new(&mut pose, &world_from_model));
            assert!(
                again.triangle_tests > 0 && again.node_tests == first.node_tests,
                "{what}: {again:?}"
            );
            assert_eq!(again.nodes_blended, 0, "{what}");
            for stats in [first, again] {
                // Eight vertices are blended at once.
                assert!(
                    stats.vertices_blended <= 8 * 3 * stats.triangle_tests,
                    "{what}: {stats:?}"
                );
            }
            total += first;
        }
        assert_eq!(total.nodes_blended, bvh.node_count() as u64);
        assert!(total.vertices_blended >= bvh.model().vertex_count() as u64);
    }
}
