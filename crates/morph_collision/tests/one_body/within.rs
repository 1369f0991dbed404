//! Triangles closer than a distance, of one body and of two, checked against every pair of triangles.

use std::ops::ControlFlow;

use glam::{Affine3A, Vec3};
use morph_collision::{Body, DistanceQuery, SelfDistanceQuery, WorldFromModel};
use morph_collision_models::generated::{degenerate, dolphin, random};

use crate::bodies::{self, Case};
use crate::reference::{Corners, touch, triangles as triangle_distance};

fn distance(a: &Corners, b: &Corners) -> f64 {
    if touch(a, b) { 0.0 } else { triangle_distance(a, b) }
}

/// The pairs within a distance, and the smallest difference of any pair's distance from it.
fn truth(pairs: impl Iterator<Item = ([u32; 2], f64)>, limit: f64) -> (Vec<[u32; 2]>, f64) {
    let (mut near, mut margin) = (Vec::new(), f64::INFINITY);
    for (pair, distance) in pairs {
        margin = margin.min((distance - limit).abs());
        if distance <= limit {
            near.push(pair);
        }
    }
    near.sort_unstable();
    (near, margin)
}

fn own_pairs(case: &Case, limit: f64) -> usize {
    let corners = case.world_triangles();
    let count = corners.len() as u32;
    let model = case.mesh.to_model().unwrap();
    let share = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|triangle| model.triangle(triangle).unwrap());
        a.iter().any(|vertex| b.contains(vertex))
    };
    let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    let apart = all.filter(|&[a, b]| !share(a, b));
    let measured = apart.map(|[a, b]| ([a, b], distance(&corners[a as usize], &corners[b as usize])));
    let (near, margin) = truth(measured, limit);
    assert!(margin > 1e-12, "{}: choose another distance than {limit}", case.name);
    for mut pose in case.poses() {
        let mut found = Vec::new();
        let mut query = SelfDistanceQuery::new();
        let within = query.within(&mut pose, limit, |pair| {
            let [a, b] = [pair.triangles.triangle_a, pair.triangles.triangle_b];
            let expected = distance(&corners[a as usize], &corners[b as usize]);
            assert!(
                (pair.distance - expected).abs() <= 1e-10 * (1.0 + expected),
                "{}: {pair:?}",
                case.name
            );
            assert_eq!(pair.distance == 0.0, expected == 0.0, "{}: {pair:?}", case.name);
            found.push([a, b]);
            ControlFlow::Continue(())
        });
        within.unwrap();
        found.sort_unstable();
        assert_eq!(found, near, "{} within {limit}", case.name);
        assert!(query.stats().triangle_tests >= near.len() as u64);
        let mut calls = 0;
        let one = query.within(&mut pose, limit, |_| {
            calls += 1;
            ControlFlow::Break(())
        });
        one.unwrap();
        assert_eq!(calls, near.len().min(1), "it stops when the visitor breaks");
        let error = query
            .within(&mut pose, -1.0, |_| ControlFlow::Continue(()))
            .unwrap_err();
        assert_eq!(error.to_string(), "max_distance is -1, it must be 0 or more");
    }
    near.len()
}

#[test]
fn close_triangles_of_one_body_agree_with_brute_force() {
    let at = |name, mesh, weights| Case::new(name, mesh, weights, Affine3A::IDENTITY);
    let blob = at(
        "blob",
        random::random_blob(4, 2, 5, 0.6),
        vec![-3.0, 4.0, 2.0, -5.0, 3.0],
    );
    assert!(own_pairs(&blob, 0.0123) < own_pairs(&blob, 0.345));
    assert!(own_pairs(&at("soup", random::triangle_soup(5, 80, 2), vec![0.5, -1.0]), 0.2345) > 0);
    own_pairs(&at("dolphin", dolphin(0), vec![0.3, 0.4]), 0.0345);
    own_pairs(&at("slivers", degenerate::slivers(1, 40), vec![0.5]), 0.0567);
}

#[test]
fn close_triangles_of_two_bodies_agree_with_brute_force() {
    let case = |mesh: u64, world_from_model| {
        let blob = random::random_blob(mesh, 1, 3, 0.3);
        Case::new("blob", blob, vec![0.4, -0.7, 1.2], world_from_model)
    };
    let near = case(5, Affine3A::IDENTITY);
    let triangles_a = near.world_triangles();
    let mut sizes = Vec::new();
    for (name, world_from_model) in bodies::odd_places() {
        for (shift, limit) in [(0.0, 0.0789), (2.2, 0.789), (1e8, 1e8)] {
            let other = case(6, Affine3A::from_translation(Vec3::X * shift) * world_from_model);
            let triangles_b = other.world_triangles();
            let all = (0..triangles_a.len()).flat_map(|a| (0..triangles_b.len()).map(move |b| [a, b]));
            let measured = all.map(|[a, b]| ([a as u32, b as u32], distance(&triangles_a[a], &triangles_b[b])));
            let (expected, margin) = truth(measured, limit);
            assert!(
                margin > 1e-15 * shift as f64,
                "{name}: choose another distance than {limit}"
            );
            let place_b = other.world_from_model();
            for (mut pose_a, mut pose_b) in near.poses().into_iter().zip(other.poses()) {
                let mut found = Vec::new();
                let bodies = [
                    Body::new(&mut pose_a, &WorldFromModel::IDENTITY),
                    Body::new(&mut pose_b, &place_b),
                ];
                let [a, b] = bodies;
                let within = DistanceQuery::new().within(a, b, limit, |pair| {
                    found.push([pair.triangles.triangle_a, pair.triangles.triangle_b]);
                    ControlFlow::Continue(())
                });
                within.unwrap();
                found.sort_unstable();
                assert_eq!(found, expected, "{name}, {shift} away, within {limit}");
            }
            sizes.push(expected.len());
        }
    }
    assert!(sizes.iter().filter(|size| **size > 0).count() > 10, "{sizes:?}");
}
