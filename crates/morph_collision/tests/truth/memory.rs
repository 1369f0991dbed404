use std::f32::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use morph_collision::{
    Body, BuildOptions, MorphBvh, PairMemory, PairQuery, Pose, QueryStats, Remember, TrianglePair, VolumeKind,
    WorldFromModel,
};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::{dolphin, random};
use morph_collision_testkit::scenes::dolphins;

const SEPARATION: Remember = Remember {
    separation: true,
    front: false,
    witness: false,
};
const FRONT: Remember = Remember {
    separation: false,
    front: true,
    witness: false,
};
const WITNESS: Remember = Remember {
    separation: false,
    front: false,
    witness: true,
};
const ALL: Remember = Remember {
    separation: true,
    front: true,
    witness: true,
};

/// Frames of two bodies of a mesh: weights and place of each.
type Frames = Vec<[(Vec<f32>, Affine3A); 2]>;

/// Two dolphins swimming side by side, the second put a little aside.
fn swimming(aside: f32) -> (MorphMesh, Frames) {
    let frames = (0..200)
        .map(|frame| {
            [0, 1].map(|i| {
                let mut place = dolphins::placement(i, 12, frame, 400);
                place.translation.y += aside * i as f32;
                (dolphins::weights(i, frame, 400).to_vec(), place)
            })
        })
        .collect();
    (dolphin(0), frames)
}

/// Blobs that turn, jump and change their weights wildly.
fn jumping() -> (MorphMesh, Frames) {
    let frames = (0..200)
        .map(|frame| {
            [0, 1].map(|i| {
                let t = (frame * (i + 1)) as f32;
                let weights = (0..4).map(|k| (t * 0.37 + k as f32).sin() * if frame % 7 == 0 { 3.0 } else { 0.5 });
                let stretch = Vec3::new(1.0, 1.0 + 0.3 * (t * 0.21).sin(), -1.0);
                let place = Affine3A::from_scale_rotation_translation(
                    stretch,
                    Quat::from_rotation_z(t * 0.01),
                    Vec3::X * (2.6 * i as f32 + 0.4 * (t * 0.13).cos()),
                );
                (weights.collect(), place)
            })
        })
        .collect();
    (random::random_blob(3, 1, 4, 0.3), frames)
}

/// The pairs of every frame, sorted, and the work they took.
fn replay(
    mesh: &MorphMesh,
    frames: &Frames,
    volume: VolumeKind,
    memory: Option<&mut PairMemory>,
    first_only: bool,
) -> (Vec<Vec<TrianglePair>>, QueryStats) {
    let options = BuildOptions::default().with_volume(volume);
    let bvh = Arc::new(MorphBvh::build(Arc::new(mesh.to_model().unwrap()), &options).unwrap());
    let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
    let (mut query, mut stats, mut memory) = (PairQuery::new(), QueryStats::default(), memory);
    let pairs = frames.iter().map(|[of_a, of_b]| {
        a.set_weights(&of_a.0).unwrap();
        b.set_weights(&of_b.0).unwrap();
        let places = [of_a.1, of_b.1].map(|place| WorldFromModel::new(place).unwrap());
        let (body_a, body_b) = (Body::new(&mut a, &places[0]), Body::new(&mut b, &places[1]));
        let mut pairs = Vec::new();
        let visitor = |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        };
        let (first, work) = match (&mut memory, first_only) {
            (Some(memory), true) => query.first_with(memory, body_a, body_b),
            (None, true) => query.first(body_a, body_b),
            (Some(memory), false) => (None, query.visit_with(memory, body_a, body_b, visitor)),
            (None, false) => (None, query.visit(body_a, body_b, visitor)),
        };
        pairs.extend(first);
        stats += work;
        pairs.sort_unstable();
        pairs
    });
    (pairs.collect(), stats)
}

#[test]
fn what_is_remembered_changes_no_answer() {
    for (mesh, frames) in [swimming(0.0), swimming(0.3), jumping()] {
        for volume in VolumeKind::ALL {
            let (plain, _) = replay(&mesh, &frames, volume, None, false);
            assert!(plain.iter().any(|pairs| !pairs.is_empty()), "nothing to find");
            assert!(plain.iter().any(Vec::is_empty), "nothing to skip");
            for remember in [SEPARATION, FRONT, WITNESS, ALL] {
                let mut memory = PairMemory::new(remember);
                let (with, _) = replay(&mesh, &frames, volume, Some(&mut memory), false);
                assert!(with == plain, "{volume} remembering {remember:?}");
                let mut memory = PairMemory::new(remember);
                let (first, _) = replay(&mesh, &frames, volume, Some(&mut memory), true);
                for (frame, (first, all)) in first.iter().zip(&plain).enumerate() {
                    assert_eq!(first.is_empty(), all.is_empty(), "{volume}, frame {frame}");
                    assert!(first.iter().all(|pair| all.contains(pair)));
                }
            }
        }
    }
}

#[test]
fn a_pair_that_stays_apart_is_seldom_looked_at() {
    let (mesh, frames) = swimming(3.0);
    let (plain, stats) = replay(&mesh, &frames, VolumeKind::Aabb, None, false);
    assert!(plain.iter().all(Vec::is_empty));
    let mut memory = PairMemory::new(SEPARATION);
    let (_, remembering) = replay(&mesh, &frames, VolumeKind::Aabb, Some(&mut memory), false);
    assert!(
        memory.skipped() * 2 > frames.len() as u64,
        "{} of {}",
        memory.skipped(),
        frames.len()
    );
    assert!(remembering.node_tests < stats.node_tests);
}

#[test]
fn a_pair_that_goes_on_touching_is_found_where_it_touched() {
    let (mesh, frames) = swimming(0.0);
    let (plain, stats) = replay(&mesh, &frames, VolumeKind::Aabb, None, true);
    let mut memory = PairMemory::new(WITNESS);
    let (with, remembering) = replay(&mesh, &frames, VolumeKind::Aabb, Some(&mut memory), true);
    let touching = |pairs: &[Vec<TrianglePair>]| pairs.iter().map(|pairs| !pairs.is_empty()).collect::<Vec<_>>();
    assert_eq!(touching(&with), touching(&plain));
    assert!(remembering.node_tests < stats.node_tests, "{remembering:?}, {stats:?}");
}

#[test]
fn another_tree_is_noticed() {
    let (mesh, frames) = swimming(3.0);
    let mut memory = PairMemory::new(ALL);
    replay(&mesh, &frames[..5].to_vec(), VolumeKind::Aabb, Some(&mut memory), false);
    // The same memory, but other trees and bodies that touch.
    let (mesh, frames) = jumping();
    let (plain, _) = replay(&mesh, &frames, VolumeKind::Aabb, None, false);
    let (with, _) = replay(&mesh, &frames, VolumeKind::Aabb, Some(&mut memory), false);
    assert!(with == plain);
}

/// Frames of two blobs of which one thing alone brings the second to the first, in steps that are small against their distance.
fn approaches() -> Vec<(&'static str, MorphMesh, Frames)> {
    // The first target moves the whole mesh, the second bends it a little.
    let mut blob = random::random_blob(3, 2, 2, 0.1);
    blob.targets[0].fill(Vec3::X);
    let rest = vec![0.0, 0.3];
    let at = |x: f32, scale: f32| {
        let turned = Quat::from_rotation_y(0.7) * Quat::from_rotation_z(0.4);
        Affine3A::from_scale_rotation_translation(Vec3::splat(scale), turned, Vec3::new(x, 0.3, 0.2))
    };
    let start = Affine3A::from_rotation_z(0.2);
    let way = |frame: usize| 0.02 * frame as f32;
    let frames = |pair: &dyn Fn(f32) -> [(Vec<f32>, Affine3A); 2]| (0..150).map(|frame| pair(way(frame))).collect();
    vec![
        (
            "by its place",
            blob.clone(),
            frames(&|way| [(rest.clone(), start), (rest.clone(), at(4.0 - way, 1.0))]),
        ),
        (
            "small, by its place",
            blob.clone(),
            frames(&|way| [(rest.clone(), start), (rest.clone(), at(3.0 - way, 0.1))]),
        ),
        (
            "the first morphs",
            blob.clone(),
            frames(&|way| [(vec![way, 0.3], start), (rest.clone(), at(4.0, 1.0))]),
        ),
        (
            "large, morphs",
            blob.clone(),
            frames(&|way| {
                let towards = Affine3A::from_scale_rotation_translation(
                    Vec3::splat(4.0),
                    Quat::from_rotation_y(PI),
                    Vec3::new(8.0, 0.3, 0.2),
                );
                [(rest.clone(), start), (vec![way, 0.3], towards)]
            }),
        ),
    ]
}

#[test]
fn a_separation_ends_when_either_body_moves_or_morphs_as_far() {
    for (how, mesh, frames) in approaches() {
        for volume in VolumeKind::ALL {
            let (plain, _) = replay(&mesh, &frames, volume, None, false);
            let first = plain.iter().position(|pairs| !pairs.is_empty());
            assert!(first.is_some_and(|frame| frame > 20), "{how}: {first:?}");
            let mut memory = PairMemory::new(SEPARATION);
            let (with, _) = replay(&mesh, &frames, volume, Some(&mut memory), false);
            assert!(with == plain, "{how}, {volume}");
            assert!(memory.skipped() > 5, "{how}, {volume}: {} skipped", memory.skipped());
        }
    }
}

#[test]
fn a_memory_of_small_trees_says_nothing_about_large_ones() {
    // In the same places with the same weights, but five times as large: now they touch.
    let small = random::random_blob(3, 1, 2, 0.1);
    let mut large = random::random_blob(3, 2, 2, 0.1);
    large.positions.iter_mut().for_each(|p| *p *= 5.0);
    let apart = |_| [0.0, 4.0].map(|x| (vec![0.1, 0.2], Affine3A::from_translation(Vec3::X * x)));
    let frames: Frames = (0..3).map(apart).collect();
    for remember in [SEPARATION, FRONT, WITNESS, ALL] {
        let mut memory = PairMemory::new(remember);
        let (before, _) = replay(&small, &frames, VolumeKind::Aabb, Some(&mut memory), false);
        assert!(before.iter().all(Vec::is_empty));
        let (plain, _) = replay(&large, &frames, VolumeKind::Aabb, None, false);
        let (with, _) = replay(&large, &frames, VolumeKind::Aabb, Some(&mut memory), false);
        assert!(!plain[0].is_empty() && with == plain, "{remember:?}");
    }
}

#[test]
fn a_front_becomes_short_again_some_time_after_bodies_part() {
    let blob = random::random_blob(3, 2, 2, 0.1);
    let at = |frame: usize| {
        let x = if frame < 4 { 0.5 } else { 9.0 };
        [0.0, x].map(|x| (vec![0.1, 0.2], Affine3A::from_translation(Vec3::X * x)))
    };
    let mut memory = PairMemory::new(FRONT);
    let touching: Frames = (0..4).map(at).collect();
    let apart: Frames = (4..40).map(at).collect();
    let bvh = replay_keeping_trees(&blob, &touching, None, &mut memory);
    assert!(memory.front_len() > 20, "{}", memory.front_len());
    replay_keeping_trees(&blob, &apart, Some(bvh), &mut memory);
    assert!(memory.front_len() <= 1, "{}", memory.front_len());
}

/// All pairs of every frame with a memory, of bodies that keep the given tree, or get a new one; returns the tree.
fn replay_keeping_trees(
    mesh: &MorphMesh,
    frames: &Frames,
    bvh: Option<Arc<MorphBvh>>,
    memory: &mut PairMemory,
) -> Arc<MorphBvh> {
    let build = || MorphBvh::build(Arc::new(mesh.to_model().unwrap()), &BuildOptions::default()).unwrap();
    let bvh = bvh.unwrap_or_else(|| Arc::new(build()));
    let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh.clone()));
    for [of_a, of_b] in frames {
        a.set_weights(&of_a.0).unwrap();
        b.set_weights(&of_b.0).unwrap();
        let places = [of_a.1, of_b.1].map(|place| WorldFromModel::new(place).unwrap());
        let (a, b) = (Body::new(&mut a, &places[0]), Body::new(&mut b, &places[1]));
        PairQuery::new().visit_with(memory, a, b, |_| ControlFlow::Continue(()));
    }
    bvh
}
