//! Seeded rigs: known clips are found, and a rig without any is proved free.

use std::sync::Arc;

use glam::Vec3;
use morph_collision::proof::{Effort, SelfProof, WeightBox};
use morph_collision::{InputError, TrianglePair};
use morph_collision_models::generated::rigs::tube;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{prove, thorough, touching, tree, tree_of};

/// A sheet of `cells * cells * 2` triangles at height `z`, and flaps above it: each flap is a triangle of its own that one target lowers by
/// `lower` and all others by little or nothing.
struct Flaps {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    targets: Vec<Vec<Vec3>>,
    first_flap: u32,
}

fn flaps(lower: &[f32]) -> Flaps {
    const CELLS: u32 = 12;
    let point = |i: u32| Vec3::new((i % (CELLS + 1)) as f32, (i / (CELLS + 1)) as f32, 0.0);
    let mut positions: Vec<Vec3> = (0..(CELLS + 1) * (CELLS + 1)).map(point).collect();
    let corner = |x: u32, y: u32| y * (CELLS + 1) + x;
    let mut triangles = Vec::new();
    for (x, y) in (0..CELLS).flat_map(|y| (0..CELLS).map(move |x| (x, y))) {
        triangles.push([corner(x, y), corner(x + 1, y), corner(x, y + 1)]);
        triangles.push([corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)]);
    }
    let first_flap = triangles.len() as u32;
    let (sheet, mut rng) = (positions.len(), Pcg64Mcg::seed_from_u64(5));
    for flap in 0..lower.len() {
        let at = Vec3::new(0.3 + flap as f32 * 1.3, rng.random_range(1.0..9.0), 1.0);
        let first = positions.len() as u32;
        positions.extend([at, at + Vec3::new(0.7, 0.1, 0.0), at + Vec3::new(0.3, 0.2, 1.5)]);
        triangles.push([first, first + 1, first + 2]);
    }
    let target = |flap: usize| {
        let mut moved = vec![Vec3::ZERO; positions.len()];
        // The sheet stretches too, within its plane.
        for (i, moved) in moved.iter_mut().enumerate().take(sheet) {
            *moved = Vec3::new(0.002, 0.001, 0.0) * (i % 7) as f32;
        }
        moved[sheet + 3 * flap..][..3].fill(Vec3::NEG_Z * lower[flap]);
        moved
    };
    let targets = (0..lower.len()).map(target).collect();
    Flaps {
        positions,
        triangles,
        targets,
        first_flap,
    }
}

#[test]
fn a_rig_without_clips_is_proved_free_for_all_weights() {
    let rig = flaps(&[0.99; 8]);
    let bvh = tree(&rig.positions, &rig.triangles, &rig.targets);
    let outcome = prove(&bvh, &WeightBox::unit(8), Effort::default());
    assert!(
        outcome.is_free(),
        "{} touch, {} are undecided",
        outcome.touching,
        outcome.undecided
    );
    assert!(outcome.free_by_nodes > 5 * outcome.free_by_direction, "{outcome:?}");
}

#[test]
fn known_clips_are_found_and_nothing_else() {
    let lower: Vec<f32> = (0..8).map(|flap| if flap % 3 == 1 { 1.2 } else { 0.9 }).collect();
    let rig = flaps(&lower);
    let bvh = tree(&rig.positions, &rig.triangles, &rig.targets);
    let outcome = prove(&bvh, &WeightBox::unit(8), thorough(1000));
    assert_eq!(outcome.undecided, 0, "{:?}", outcome.undecided_pairs);
    let mut flaps: Vec<u32> = outcome
        .witnesses
        .iter()
        .map(|witness| witness.triangles.triangle_b - rig.first_flap)
        .collect();
    flaps.sort_unstable();
    flaps.dedup();
    assert_eq!(flaps, [1, 4, 7]);
    for witness in &outcome.witnesses {
        assert!(touching(&bvh, &witness.weights).contains(&witness.triangles));
    }
    // With a limit on its weight, the clip is gone.
    let (low, mut high) = ([0.0; 8], [1.0; 8]);
    for flap in [1, 4, 7] {
        high[flap] = 0.8;
    }
    assert!(prove(&bvh, &WeightBox::new(&low, &high).unwrap(), Effort::default()).is_free());
}

#[test]
fn two_targets_that_clip_only_together_are_found_in_the_corner_of_the_box() {
    let base = [Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0].map(|p| p - Vec3::ONE);
    let above = [Vec3::ZERO, Vec3::X, Vec3::new(0.2, 0.3, 1.0)];
    let lowered = |by: f32| [[Vec3::ZERO; 3], [Vec3::NEG_Z * by; 3]].concat();
    let bvh = tree(
        &[base, above].concat(),
        &[[0, 1, 2], [3, 4, 5]],
        &[lowered(0.6), lowered(0.6)],
    );
    let outcome = prove(&bvh, &WeightBox::unit(2), Effort::default());
    assert_eq!(
        (outcome.touching, outcome.witnesses[0].weights.clone()),
        (1, vec![1.0, 1.0])
    );
    assert_eq!(
        outcome.witnesses[0].triangles,
        TrianglePair {
            triangle_a: 0,
            triangle_b: 1
        }
    );
    let limited = WeightBox::new(&[0.0; 2], &[1.0, 0.66]).unwrap();
    assert!(prove(&bvh, &limited, Effort::default()).is_free());
}

#[test]
fn triangles_that_turn_are_proved_free_by_splitting() {
    // Two blades that turn about the z axis by a quarter turn, one above the other, with a gap that no fixed direction sees.
    let blade = [
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(4.0, 0.0, -0.5),
        Vec3::new(4.0, 0.0, 0.5),
    ];
    let other = blade.map(|p| Vec3::new(p.x, 0.4, p.z));
    let turned = |p: Vec3| Vec3::new(-p.y, p.x, p.z) - p;
    let turn: Vec<Vec3> = blade.into_iter().chain(other).map(turned).collect();
    let bvh = tree(&[blade, other].concat(), &[[0, 1, 2], [3, 4, 5]], &[turn]);
    let quick = prove(&bvh, &WeightBox::unit(1), thorough(1));
    assert_eq!((quick.touching, quick.undecided), (0, 1));
    let outcome = prove(&bvh, &WeightBox::unit(1), thorough(200));
    assert_eq!((outcome.free_by_splitting, outcome.is_free()), (1, true), "{outcome:?}");
}

#[test]
fn without_steps_everything_is_undecided() {
    let rig = flaps(&[0.5; 3]);
    let bvh = tree(&rig.positions, &rig.triangles, &rig.targets);
    let effort = Effort {
        steps: 0,
        ..Effort::default()
    };
    let outcome = prove(&bvh, &WeightBox::unit(3), effort);
    let triangles = rig.triangles.len() as u64;
    assert_eq!(
        (outcome.free(), outcome.undecided),
        (0, triangles * (triangles - 1) / 2)
    );
}

#[test]
fn bad_boxes_and_skinned_meshes_are_refused() {
    let bad = |low: f32, high: f32| WeightBox::new(&[0.0, low], &[1.0, high]).unwrap_err().to_string();
    assert!(
        bad(f32::NAN, 1.0).contains("lower end of weight 1"),
        "{}",
        bad(f32::NAN, 1.0)
    );
    assert!(bad(0.0, f32::INFINITY).contains("upper end of weight 1"));
    assert!(bad(0.5, 0.25).contains("at most the upper end"));
    assert!(matches!(
        WeightBox::new(&[0.0], &[]),
        Err(InputError::WrongCount {
            given: 0,
            expected: 1,
            ..
        })
    ));
    let rig = flaps(&[0.5; 3]);
    let bvh = tree(&rig.positions, &rig.triangles, &rig.targets);
    let wrong = SelfProof::new(&bvh, &WeightBox::unit(2), Effort::default()).unwrap_err();
    assert!(
        matches!(
            wrong,
            InputError::WrongCount {
                given: 2,
                expected: 3,
                ..
            }
        ),
        "{wrong}"
    );
    let skinned = tree_of(&tube(1, 4, 6, 2));
    let targets = skinned.model().target_count();
    let refused = SelfProof::new(&Arc::clone(&skinned), &WeightBox::unit(targets), Effort::default()).unwrap_err();
    assert!(matches!(refused, InputError::SkinnedMesh { .. }), "{refused}");
}
