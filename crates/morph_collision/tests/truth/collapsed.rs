//! Collapsed bodies: scaled to nothing or nearly so, or morphed into a point.

use std::sync::Arc;

use glam::{Affine3A, EulerRot, Mat3, Quat, Vec3};
use morph_collision::batch::{BatchQuery, PairTask, ThreadWorkers, Wanted, Workers};
use morph_collision::{
    Body, BuildOptions, ContactQuery, DistanceQuery, MorphBvh, PairMemory, PairQuery, Pose, QueryStats, SelfQuery,
    TrianglePair, WorldFromModel,
};
use morph_collision_models::generated::{dolphin, random};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{intersecting_pairs, point_distance, posed_vertices, world_vertices};

const SCALES: [f32; 14] = [
    0.0, 1e-40, 1e-30, 1e-20, 1e-17, 1e-16, 3e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6,
];

/// Offsets at which the two bodies are apart, but their boxes overlap.
const NEXT_TO_DOLPHIN: Vec3 = Vec3::new(0.6, 0.45, 0.3);
const NEXT_TO_BLOB: Vec3 = Vec3::new(1.4, 1.1, 0.9);

/// A small part of the 5,089,536 triangle pairs of two dolphins.
const FEW_TESTS: u64 = 50_000;

/// A mesh and a copy of it, moved aside.
fn neighbours(mesh: &MorphMesh, aside: Vec3) -> [MorphMesh; 2] {
    let mut other = mesh.clone();
    for position in &mut other.positions {
        *position += aside;
    }
    [mesh.clone(), other]
}

fn pose(mesh: &MorphMesh, leaf_size: usize) -> Pose {
    let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(mesh.to_model().unwrap()), &options)))
}

/// A transform that scales each axis.
fn place(scale: Vec3, is_turned: bool, far: f32) -> Affine3A {
    let turn = if is_turned {
        Mat3::from_quat(Quat::from_euler(EulerRot::XYZ, 0.6, 0.4, 0.9))
    } else {
        Mat3::IDENTITY
    };
    Affine3A::from_mat3_translation(turn * Mat3::from_diagonal(scale), Vec3::new(far, 0.7 * far, -0.3 * far))
}

fn truth(meshes: [&MorphMesh; 2], weights: &[f32], places: [Affine3A; 2]) -> Vec<TrianglePair> {
    let [a, b] = [0, 1].map(|body: usize| {
        let mesh = meshes[body];
        world_vertices(&posed_vertices(&mesh.positions, &mesh.targets, weights), &places[body])
    });
    let pairs = intersecting_pairs(&a, &meshes[0].triangles, &b, &meshes[1].triangles);
    pairs
        .into_iter()
        .map(|(triangle_a, triangle_b)| TrianglePair { triangle_a, triangle_b })
        .collect()
}

/// Checks that every query about two bodies agrees with brute force.
fn agrees(name: &str, poses: [&mut Pose; 2], places: [Affine3A; 2], expected: &[TrianglePair]) {
    let [a, b] = poses;
    let [place_a, place_b] = places.map(|place| WorldFromModel::new(place).unwrap());
    let mut query = PairQuery::new();
    let mut all = Vec::new();
    query.all(Body::new(a, &place_a), Body::new(b, &place_b), &mut all);
    let in_order = all.clone();
    all.sort_unstable();
    assert!(
        all == expected,
        "{name}: {} pairs instead of {}",
        all.len(),
        expected.len()
    );

    let limit = expected.len() / 2;
    for (limit, is_truncated) in [(limit, limit < expected.len()), (expected.len(), false)] {
        let mut some = Vec::new();
        let cut = query.up_to(Body::new(a, &place_a), Body::new(b, &place_b), limit, &mut some);
        assert_eq!(
            (cut, &some[..]),
            (is_truncated, &in_order[..limit]),
            "{name}, up to {limit}"
        );
    }
    let first = query.first(Body::new(a, &place_a), Body::new(b, &place_b));
    let right = first.map_or(expected.is_empty(), |pair| expected.binary_search(&pair).is_ok());
    assert!(right, "{name}: first {first:?}");
    let mut memory = PairMemory::new();
    for _ in 0..3 {
        let first = query.first_with(&mut memory, Body::new(a, &place_a), Body::new(b, &place_b));
        assert_eq!(first.is_some(), !expected.is_empty(), "{name}, with a memory");
    }
    let closest = DistanceQuery::new()
        .closest(Body::new(a, &place_a), Body::new(b, &place_b), f64::INFINITY)
        .unwrap();
    let distance = closest.expect("they are somewhere").distance;
    assert_eq!(distance == 0.0, !expected.is_empty(), "{name}: {distance} apart");
}

#[test]
fn bodies_of_every_small_size_have_the_pairs_that_brute_force_finds() {
    let meshes = neighbours(&random::random_blob(3, 1, 0, 0.0), NEXT_TO_BLOB);
    let mut bodies = meshes.each_ref().map(|mesh| pose(mesh, 8));
    let (mut touching, mut apart) = (0, 0);
    for axes in [Vec3::ONE, Vec3::new(1.0, 1.0, 0.0), Vec3::Z] {
        for far in [0.0, 1.0, 1000.0] {
            for (i, small) in SCALES.into_iter().enumerate() {
                let scale = Vec3::select(axes.cmpgt(Vec3::ZERO), Vec3::splat(small), Vec3::ONE);
                let at = place(scale, i % 2 == 0, far);
                let [a, b] = &mut bodies;
                let expected = truth(meshes.each_ref(), &[], [at; 2]);
                agrees(&format!("{axes} by {small}, at {far}"), [a, b], [at; 2], &expected);
                (touching, apart) = if expected.is_empty() {
                    (touching, apart + 1)
                } else {
                    (touching + 1, apart)
                };
            }
        }
    }
    assert!(touching > 20 && apart > 20, "{touching} touch, {apart} are apart");
}

#[test]
fn small_bodies_have_the_same_pairs_in_every_tree() {
    let meshes = neighbours(&random::random_blob(4, 1, 0, 0.0), NEXT_TO_BLOB);
    for (small, far) in [(0.0, 1.0), (1e-16, 1.0), (3e-16, 1.0), (1e-15, 1.0), (3e-13, 1000.0)] {
        let at = place(Vec3::splat(small), true, far);
        let expected = truth(meshes.each_ref(), &[], [at; 2]);
        for leaf_size in [1, 3, 8, 255] {
            let mut bodies = meshes.each_ref().map(|mesh| pose(mesh, leaf_size));
            let [a, b] = &mut bodies;
            agrees(
                &format!("leaves of {leaf_size}, {small} at {far}"),
                [a, b],
                [at; 2],
                &expected,
            );
        }
    }
}

#[test]
fn bodies_of_every_small_size_are_decided_without_products_of_triangles() {
    let meshes = neighbours(&dolphin(1), NEXT_TO_DOLPHIN);
    let [mut a, mut b] = meshes.each_ref().map(|mesh| pose(mesh, 8));
    let mut query = PairQuery::new();
    let mut distance = DistanceQuery::new();
    let (mut touching, mut apart) = (0, 0);
    for far in [0.0, 1.0, 1000.0] {
        for (i, small) in SCALES.into_iter().enumerate() {
            for aside in [0.0, 0.001] {
                let at = place(Vec3::splat(small), i % 2 == 0, far);
                let place_a = WorldFromModel::new(at).unwrap();
                let place_b = WorldFromModel::new(Affine3A::from_translation(Vec3::splat(aside)) * at).unwrap();
                let name = format!("{small} at {far}, {aside} aside");

                let (body_a, body_b) = (Body::new(&mut a, &place_a), Body::new(&mut b, &place_b));
                let first = query.first(body_a, body_b);
                let stats = query.stats();
                few(&name, &stats);
                let (body_a, body_b) = (Body::new(&mut a, &place_a), Body::new(&mut b, &place_b));
                let mut listed = Vec::new();
                let is_truncated = query.up_to(body_a, body_b, 1000, &mut listed);
                let stats = query.stats();
                few(&name, &stats);
                assert_eq!(listed.is_empty(), first.is_none(), "{name}");
                assert!(!is_truncated || listed.len() == 1000, "{name}");
                let (body_a, body_b) = (Body::new(&mut a, &place_a), Body::new(&mut b, &place_b));
                let closest = distance.closest(body_a, body_b, f64::INFINITY).unwrap();
                let stats = distance.stats();
                few(&name, &stats);
                assert!(
                    first.is_none() || closest.is_some_and(|closest| closest.distance == 0.0),
                    "{name}"
                );
                (touching, apart) = if first.is_some() {
                    (touching + 1, apart)
                } else {
                    (touching, apart + 1)
                };
            }
        }
    }
    assert!(touching > 10 && apart > 40, "{touching} touch, {apart} are apart");
}

fn few(name: &str, stats: &QueryStats) {
    let tests = stats.triangle_tests;
    assert!(tests < FEW_TESTS, "{name}: {tests} triangle tests");
}

#[test]
fn flat_bodies_that_are_apart_are_decided_without_products_of_triangles() {
    let meshes = neighbours(&dolphin(1), NEXT_TO_DOLPHIN);
    let [mut a, mut b] = meshes.each_ref().map(|mesh| pose(mesh, 8));
    let mut query = PairQuery::new();
    for thin in [0.0, 1e-16, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8, 1e-7] {
        for is_turned in [false, true] {
            let at = place(Vec3::new(1.0, 1.0, thin), is_turned, 1.0);
            let place_a = WorldFromModel::new(at).unwrap();
            let place_b = WorldFromModel::new(Affine3A::from_translation(Vec3::splat(0.01)) * at).unwrap();
            let first = query.first(Body::new(&mut a, &place_a), Body::new(&mut b, &place_b));
            let stats = query.stats();
            assert_eq!(first, None);
            few(&format!("{thin}, turned: {is_turned}"), &stats);
        }
    }
}

#[test]
fn the_distance_of_bodies_on_parallel_lines_is_measured_without_products_of_triangles() {
    let mesh = dolphin(1);
    let [mut a, mut b] = [(); 2].map(|()| pose(&mesh, 8));
    let mut query = DistanceQuery::new();
    for is_turned in [false, true] {
        let line = place(Vec3::X, is_turned, 1.0);
        let aside = line.matrix3.x_axis.normalize().any_orthonormal_vector();
        for apart in [1e-3, 0.1, 10.0] {
            let place_a = WorldFromModel::new(line).unwrap();
            let place_b = WorldFromModel::new(Affine3A::from_translation((apart * aside).into()) * line).unwrap();
            let bodies = (Body::new(&mut a, &place_a), Body::new(&mut b, &place_b));
            let closest = query.closest(bodies.0, bodies.1, f64::INFINITY).unwrap();
            let stats = query.stats();
            let distance = closest.unwrap().distance;
            let [from, to] = [&place_a, &place_b].map(|place| place.transform_point(Vec3::ZERO));
            let along = (place_a.transform_point(Vec3::X) - from).normalize();
            let between = (to - from).cross(along).length();
            assert!((distance / between - 1.0).abs() < 2e-9, "{distance}, not {between}");
            few(&format!("{apart} apart, turned: {is_turned}"), &stats);
        }
    }
}

#[test]
fn the_distance_of_a_point_from_a_body_around_it_is_measured_without_products_of_triangles() {
    let mesh = random::random_blob(1, 3, 0, 0.0);
    let [mut around, mut point] = [pose(&mesh, 8), pose(&mesh, 8)];
    let (place, at) = (WorldFromModel::IDENTITY, place(Vec3::ZERO, false, 0.0));
    let point_place = WorldFromModel::new(at).unwrap();
    let mut query = DistanceQuery::new();
    let corners = world_vertices(&mesh.positions, &Affine3A::IDENTITY);
    let distances = mesh.triangles.iter().map(|triangle| {
        let corners = triangle.map(|corner| corners[corner as usize]);
        point_distance(at.translation.as_dvec3(), &corners)
    });
    let truth = distances.min_by(f64::total_cmp).unwrap();
    for turn in [false, true] {
        let (a, b) = (Body::new(&mut around, &place), Body::new(&mut point, &point_place));
        let (a, b) = if turn { (b, a) } else { (a, b) };
        let closest = query.closest(a, b, f64::INFINITY).unwrap().unwrap();
        assert!((closest.distance - truth).abs() < 1e-12, "{closest:?}, {truth}");
        // Of all triangles of the point, the first one.
        let of_point = if turn {
            closest.triangles.triangle_a
        } else {
            closest.triangles.triangle_b
        };
        assert_eq!(of_point, 0);
        few("a point", &query.stats());
    }
}

/// A dolphin with a target that moves every vertex to the same point, up to rounding.
fn shrinking() -> MorphMesh {
    let mut mesh = dolphin(1);
    let point = Vec3::new(0.3, 0.2, 0.1);
    mesh.targets = vec![mesh.positions.iter().map(|position| point - position).collect()];
    mesh.target_names = vec!["shrink".into()];
    mesh
}

#[test]
fn weights_that_collapse_a_mesh_are_decided_without_products_of_triangles() {
    let mesh = shrinking();
    let [mut a, mut b] = [(); 2].map(|()| pose(&mesh, 8));
    for pose in [&mut a, &mut b] {
        pose.set_weights(&[1.0]).unwrap();
    }
    let mut query = PairQuery::new();
    for aside in [0.0, 3e-8, 1e-7, 3e-7, 1e-6, 1e-5, 0.1] {
        let at = place(Vec3::ONE, true, 0.0);
        let places = [at, Affine3A::from_translation(Vec3::X * aside) * at];
        let [place_a, place_b] = places.map(|place| WorldFromModel::new(place).unwrap());
        let first = query.first(Body::new(&mut a, &place_a), Body::new(&mut b, &place_b));
        let stats = query.stats();
        few(&format!("{aside} aside"), &stats);
        let bodies = (Body::new(&mut a, &place_a), Body::new(&mut b, &place_b));
        let any = query.up_to(bodies.0, bodies.1, 1, &mut Vec::new());
        // Both bodies have the same points, moved by `aside`.
        assert!(aside > 0.0 || first.is_some() && any, "{aside}");
        assert!(aside < 1e-6 || first.is_none(), "{aside}");
    }
    let mut pairs = Vec::new();
    let mut query = SelfQuery::new();
    let is_truncated = query.up_to(&mut a, 1000, &mut pairs);
    let stats = query.stats();
    assert_eq!((is_truncated, pairs.len()), (true, 1000));
    few("with itself", &stats);
}

#[test]
fn collapsed_weights_have_the_pairs_that_brute_force_finds() {
    let mut mesh = random::random_blob(5, 1, 0, 0.0);
    let point = Vec3::new(0.3, 0.2, 0.1);
    mesh.targets = vec![mesh.positions.iter().map(|position| point - position).collect()];
    mesh.target_names = vec!["shrink".into()];
    let [mut a, mut b] = [(); 2].map(|()| pose(&mesh, 8));
    let mut counts = Vec::new();
    for weight in [1.0, 0.999_999_9, 0.999_999, 0.9999] {
        a.set_weights(&[weight]).unwrap();
        b.set_weights(&[weight]).unwrap();
        for aside in [0.0, 3e-8, 1e-7, 1e-6] {
            let at = place(Vec3::ONE, true, 0.0);
            let places = [at, Affine3A::from_translation(Vec3::X * aside) * at];
            let expected = truth([&mesh; 2], &[weight], places);
            agrees(
                &format!("weight {weight}, {aside} aside"),
                [&mut a, &mut b],
                places,
                &expected,
            );
            counts.push(expected.len());
        }
    }
    assert!(
        counts.contains(&0) && counts.iter().any(|&count| count > 1000),
        "{counts:?}"
    );
}

#[test]
fn a_list_is_cut_at_the_same_pair_by_any_number_of_workers() {
    let mesh = dolphin(1);
    let mut poses = [(); 2].map(|()| pose(&mesh, 8));
    let mut cut_in_parts = 0;
    // Bodies that overlap deeply, and collapsed bodies.
    for at in [place(Vec3::ONE, true, 0.0), place(Vec3::ZERO, true, 1.0)] {
        let places = [at, Affine3A::from_translation(Vec3::splat(0.02)) * at];
        let places = if at.matrix3.determinant() == 0.0 {
            [at; 2]
        } else {
            places
        };
        let places = places.map(|place| WorldFromModel::new(place).unwrap());
        let mut all = Vec::new();
        let [a, b] = &mut poses;
        PairQuery::new().up_to(Body::new(a, &places[0]), Body::new(b, &places[1]), 20_000, &mut all);
        assert!(all.len() > 500, "{}", all.len());
        for limit in [0, 1, 7, 100, all.len() - 1, all.len()] {
            let mut query = PairQuery::new();
            let mut expected = Vec::new();
            let [a, b] = &mut poses;
            let is_truncated = query.up_to(Body::new(a, &places[0]), Body::new(b, &places[1]), limit, &mut expected);
            assert_eq!(expected, all[..limit]);
            for threads in [1, 2, 8] {
                let threads = ThreadWorkers::new(threads);
                let workers: [&dyn Workers; 2] = [&threads, &ThreadWorkers::new(1)];
                for workers in workers {
                    let each = poses.iter_mut().zip(&places);
                    let mut bodies: Vec<_> = each.map(|(pose, place)| Body::new(pose, place)).collect();
                    let mut tasks = [
                        PairTask::new(0, 1, Wanted::UpTo(limit)),
                        PairTask::new(1, 0, Wanted::First),
                    ];
                    let mut batch = BatchQuery::new();
                    let answers = batch.run(&mut bodies, &mut tasks, workers);
                    assert_eq!(answers.get(0), expected, "up to {limit}, {} workers", workers.count());
                    assert_eq!(answers.is_truncated(0), is_truncated);
                    assert_eq!(answers.get(1).len(), 1);
                    assert!(!answers.is_truncated(1) && !answers.is_truncated(9));
                    // Collapsed bodies are not cut into parts.
                    let is_cut = workers.count() > 1 && is_truncated && at.matrix3.determinant() != 0.0;
                    cut_in_parts += u32::from(is_cut);
                }
            }
        }
    }
    assert!(cut_in_parts > 5, "{cut_in_parts}");
}

#[test]
fn a_limit_saves_the_parts_of_a_batch_that_nothing_is_listed_of() {
    let mesh = dolphin(1);
    let mut poses = [(); 2].map(|()| pose(&mesh, 8));
    let at = WorldFromModel::IDENTITY;
    let two = ThreadWorkers::new(2);
    let [all, some] = [Wanted::All, Wanted::UpTo(10)].map(|wanted| {
        let mut bodies: Vec<_> = poses.iter_mut().map(|pose| Body::new(pose, &at)).collect();
        let mut tasks = [PairTask::new(0, 1, wanted)];
        BatchQuery::new()
            .run(&mut bodies, &mut tasks, &two)
            .stats()
            .triangle_tests
    });
    assert!(10 * some < all, "{some} of {all} triangle tests");
}

#[test]
fn a_manifold_tells_that_it_was_made_from_some_of_the_pairs() {
    let mesh = dolphin(0);
    let [mut a, mut b] = [(); 2].map(|()| pose(&mesh, 8));
    let places = [Vec3::ZERO, Vec3::splat(0.05)].map(|by| WorldFromModel::new(Affine3A::from_translation(by)).unwrap());
    let mut query = ContactQuery::new();
    let mut manifold =
        |limit| query.manifold_up_to(Body::new(&mut a, &places[0]), Body::new(&mut b, &places[1]), limit);
    let whole = manifold(usize::MAX).expect("they touch");
    assert!(!whole.is_truncated);
    assert_eq!(manifold(whole.pair_count), Some(whole));
    let part = manifold(10).expect("they touch");
    assert_eq!((part.is_truncated, part.pair_count), (true, 10));
    assert_eq!(manifold(0), None);
    // Both bodies are a point: 318,096 pairs.
    let point = WorldFromModel::new(Affine3A::from_scale(Vec3::ZERO)).unwrap();
    let collapsed = query.manifold_up_to(Body::new(&mut a, &point), Body::new(&mut b, &point), 100);
    let stats = query.stats();
    let collapsed = collapsed.expect("they touch");
    assert_eq!((collapsed.is_truncated, collapsed.pair_count), (true, 100));
    few("a point", &stats);
}

#[test]
fn lists_of_shapes_are_cut_too() {
    use morph_collision::{PlacedShape, Shape, ShapeQuery};
    let mut body = pose(&dolphin(0), 8);
    let point = WorldFromModel::new(Affine3A::from_scale(Vec3::ZERO)).unwrap();
    let ball = PlacedShape::new(Shape::Ball { radius: 1.0 }, Quat::IDENTITY, Vec3::ZERO).unwrap();
    let mut query = ShapeQuery::new();
    for (limit, expected) in [(100, (true, 100)), (563, (true, 563)), (564, (false, 564))] {
        let mut triangles = Vec::new();
        let is_truncated = query.up_to(Body::new(&mut body, &point), &ball, limit, &mut triangles);
        assert_eq!((is_truncated, triangles.len()), expected);
        let mut contacts = Vec::new();
        let is_truncated = query
            .contacts_up_to(Body::new(&mut body, &point), &ball, 0.0, limit, &mut contacts)
            .unwrap();
        assert_eq!((is_truncated, contacts.len()), expected);
    }
}
