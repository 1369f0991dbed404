//! More separating axes: the same pairs from fewer nodes.

use glam::{Affine3A, Quat, Vec3};
use morph_collision::{BuildOptions, PairQuery, QueryStats, SeparatingAxes, VolumeKind};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::{dolphin, random, rigid};

use crate::bodies::{Placed, odd_places};

/// The sorted pairs with and without the cross axes, and the work of each.
fn both(a: &mut Placed, b: &mut Placed) -> [QueryStats; 2] {
    let mut answers = [SeparatingAxes::Lite, SeparatingAxes::Full].map(|axes| {
        let mut pairs = Vec::new();
        let mut query = PairQuery::new().with_axes(axes);
        let stats = query.all(a.body(), b.body(), &mut pairs);
        pairs.sort_unstable();
        (pairs, stats)
    });
    let name = format!("{} and {}", a.name, b.name);
    assert_eq!(answers[0].0, answers[1].0, "{name}");
    answers.each_mut().map(|answer| answer.1)
}

#[test]
fn the_pairs_are_the_same_in_odd_places_and_for_every_kind_of_volume() {
    let blob = random::random_blob(7, 2, 6, 0.5);
    let soup = random::triangle_soup(11, 120, 3);
    for kind in VolumeKind::ALL {
        for other in [kind, VolumeKind::Aabb] {
            for (name, place) in odd_places() {
                let (of_a, of_b) = (
                    BuildOptions::default().with_volume(kind),
                    BuildOptions::default().with_volume(other),
                );
                let weights = [0.3, -0.2, 0.9, 0.0, 2.5, 0.1];
                let turned = place * Affine3A::from_quat(Quat::from_rotation_y(0.7));
                let mut a = Placed::new(name, &blob, &weights, Affine3A::from_rotation_x(0.3), &of_a);
                let mut b = Placed::new(name, &soup, &[-1.0, 0.5, 0.25], turned, &of_b);
                let [lite, full] = both(&mut a, &mut b);
                assert!(full.node_tests <= lite.node_tests && full.triangle_tests <= lite.triangle_tests);
                let [lite, full] = both(&mut b, &mut a);
                assert!(full.node_tests <= lite.node_tests && full.triangle_tests <= lite.triangle_tests);
            }
        }
    }
}

/// Work over a few poses of two bodies close to each other.
fn total(mesh: &MorphMesh, weights: &[f32], step: Vec3) -> [QueryStats; 2] {
    let mut totals = [QueryStats::default(); 2];
    for i in 0..12 {
        let i = i as f32;
        let turn = Quat::from_rotation_y(0.5 * i) * Quat::from_rotation_x(0.3 * i + 0.4) * Quat::from_rotation_z(0.2);
        let place = Affine3A::from_rotation_translation(turn, step * (0.3 + 0.05 * i));
        let options = BuildOptions::default();
        let mut a = Placed::new("a", mesh, weights, Affine3A::IDENTITY, &options);
        let mut b = Placed::new("b", mesh, weights, place, &options);
        let stats = both(&mut a, &mut b);
        totals[0] += stats[0];
        totals[1] += stats[1];
    }
    totals
}

#[test]
fn fewer_nodes_and_triangles_are_tested() {
    let sheet = rigid::grid(2.0, 40);
    for (name, [lite, full]) in [
        ("dolphins", total(&dolphin(1), &[0.2, 0.6], Vec3::new(0.3, 0.5, 0.1))),
        (
            "blobs",
            total(
                &random::random_blob(5, 4, 2, 0.3),
                &[0.4, 0.2],
                Vec3::new(2.2, 0.3, 0.5),
            ),
        ),
        ("sheets", total(&sheet, &[], Vec3::new(0.1, 0.4, 0.2))),
    ] {
        let saved = |a: u64, b: u64| 100.0 * (1.0 - b as f64 / a as f64);
        println!(
            "{name}: node tests {} to {} ({:.1} % fewer), triangle tests {} to {} ({:.1} % fewer)",
            lite.node_tests,
            full.node_tests,
            saved(lite.node_tests, full.node_tests),
            lite.triangle_tests,
            full.triangle_tests,
            saved(lite.triangle_tests, full.triangle_tests)
        );
        assert!(full.node_tests < lite.node_tests, "{name}");
        assert!(full.triangle_tests < lite.triangle_tests, "{name}");
    }
}
