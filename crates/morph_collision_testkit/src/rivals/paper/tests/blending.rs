//! Blended volumes contain their vertices, and are tight.

use glam::{Affine3A, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::super::body::Body;
use super::super::slabs::Slabs;
use super::super::sphere::Sphere;
use super::super::volume::Volume;
use super::{below, meshes, volume, welded};
use morph_collision_models::generated::dolphin;

/// The posed vertices below a node.
fn posed<V: Volume>(body: &Body<V>, node: u32, weights: &[f32]) -> Vec<DVec3> {
    let references = body.references();
    let corners = below(body, node)
        .into_iter()
        .flat_map(|t| references.triangles[t as usize]);
    corners
        .map(|vertex| references.blend(vertex, weights).as_dvec3())
        .collect()
}

/// Weights of every kind: convex, of two neighbours, signed, with sums beyond 1, of 12 and far beyond.
fn weights(rng: &mut Pcg64Mcg, kind: usize, targets: usize) -> Vec<f32> {
    let mut random: Vec<f32> = (0..targets).map(|_| rng.random_range(0.0..1.0)).collect();
    let sum: f32 = random.iter().sum();
    let scale = |random: Vec<f32>, factor: f32| random.iter().map(|w| w * factor / sum).collect();
    match kind {
        0 => scale(random, 0.9),
        1 => {
            let (first, share) = (rng.random_range(0..targets), random[0]);
            random.fill(0.0);
            random[first] = share;
            random[(first + 1) % targets] = 1.0 - share;
            random
        }
        2 => random.iter().map(|w| -w).collect(),
        3 => random.iter().map(|w| 3.0 * w - 1.5).collect(),
        4 => scale(random, 1.0 + 1e-6),
        5 => scale(random, 12.0),
        _ => random.iter().map(|w| 2e4 * w - 1e4).collect(),
    }
}

fn volumes_hold_vertices<V: Volume>(in_betweens: bool) -> usize {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let mut judged = 0;
    for mesh in meshes() {
        let mut body = Body::<V>::new(&mesh, in_betweens);
        for round in 0..21 {
            let weights = weights(&mut rng, round % 7, mesh.target_count());
            body.set(&weights, &Affine3A::IDENTITY).unwrap();
            for node in 0..body.tree.node_count() as u32 {
                let volume = volume(&mut body, node);
                for vertex in posed(&body, node, &weights) {
                    assert!(
                        volume.contains(vertex),
                        "node {node} at {weights:?}: {vertex} is not in {volume:?}"
                    );
                    judged += 1;
                }
            }
        }
    }
    judged
}

#[test]
fn volumes_hold_all_posed_vertices_for_any_weights() {
    for in_betweens in [false, true] {
        let judged = [
            volumes_hold_vertices::<Slabs<3>>(in_betweens),
            volumes_hold_vertices::<Slabs<7>>(in_betweens),
            volumes_hold_vertices::<Slabs<9>>(in_betweens),
            volumes_hold_vertices::<Slabs<13>>(in_betweens),
            volumes_hold_vertices::<Sphere>(in_betweens),
        ];
        assert!(judged.iter().all(|&judged| judged > 50_000), "{judged:?}");
    }
}

/// The sum of Eq. 3 and Eq. 7, from volumes around whole reference models.
fn expected<V: Volume>(body: &Body<V>, node: u32, convex: &[f64]) -> V {
    let references = body.references();
    let mut blended = V::ZERO;
    for (reference, &weight) in (0..).zip(convex) {
        let corners = below(body, node)
            .into_iter()
            .flat_map(|t| references.triangles[t as usize]);
        let points: Vec<DVec3> = corners.map(|vertex| references.position(vertex, reference)).collect();
        blended.add(weight, &V::around(&points));
    }
    blended
}

fn assert_same_box<V: Volume>(one: &V, other: &V, tolerance: f64) {
    for (p, q) in one.aabb().into_iter().zip(other.aabb()) {
        assert!((p - q).abs().max_element() <= tolerance, "{one:?} is not {other:?}");
    }
}

fn convex_volumes_are_the_papers<V: Volume>() {
    let mesh = welded(&dolphin(0));
    let mut body = Body::<V>::new(&mesh, false);
    for [w1, w2] in [[0.0, 0.0], [1.0, 0.0], [0.25, 0.5], [0.0, 0.75], [0.5, 0.5]] {
        body.set(&[w1, w2], &Affine3A::IDENTITY).unwrap();
        let convex = [1.0 - f64::from(w1 + w2), f64::from(w1), f64::from(w2)];
        for node in 0..body.tree.node_count() as u32 {
            let blended = volume(&mut body, node);
            assert_same_box(&blended, &expected(&body, node, &convex), 1e-5);
        }
    }
}

#[test]
fn with_convex_weights_volumes_are_what_equations_3_and_7_say() {
    convex_volumes_are_the_papers::<Slabs<3>>();
    convex_volumes_are_the_papers::<Slabs<7>>();
    convex_volumes_are_the_papers::<Slabs<9>>();
    convex_volumes_are_the_papers::<Slabs<13>>();
    convex_volumes_are_the_papers::<Sphere>();
}

fn in_betweens_are_tight<V: Volume>() {
    let mesh = welded(&dolphin(0));
    let mut with = Body::<V>::new(&mesh, true);
    let mut without = Body::<V>::new(&mesh, false);
    let mut looser = 0;
    for weights in [[0.5, 0.0], [0.5, 0.5]] {
        with.set(&weights, &Affine3A::IDENTITY).unwrap();
        without.set(&weights, &Affine3A::IDENTITY).unwrap();
        for node in 0..with.tree.node_count() as u32 {
            let tight = V::around(&posed(&with, node, &weights));
            assert_same_box(&volume(&mut with, node), &tight, 1e-5);
            let [least, most] = volume(&mut without, node).aabb();
            let [tight_least, tight_most] = tight.aabb();
            looser += usize::from(((most - least) - (tight_most - tight_least)).max_element() > 1e-3);
        }
    }
    assert!(looser > 100, "only {looser} volumes have anything to gain");
}

#[test]
fn half_way_between_two_references_an_in_between_is_tight() {
    in_betweens_are_tight::<Slabs<3>>();
    in_betweens_are_tight::<Slabs<13>>();
    in_betweens_are_tight::<Sphere>();
}
