use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use morph_collision::{
    Body, BuildOptions, MorphBvh, PairMemory, PairQuery, Pose, QueryStats, TrianglePair, WorldFromModel,
};
use morph_collision_models::generated::{dolphin, random};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes::dolphins;

/// Frames of two bodies of one mesh: each body's weights and transform.
type Frames = Vec<[(Vec<f32>, Affine3A); 2]>;

/// Two dolphins swimming side by side, the second moved aside by `aside`.
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

/// Blobs that rotate, jump, and change their weights a lot from frame to frame.
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

/// The query that runs in every frame.
enum Ask<'a> {
    All,
    First,
    FirstWith(&'a mut PairMemory),
}

/// The pairs of every frame, sorted, and the work they took.
fn replay(mesh: &MorphMesh, frames: &Frames, mut ask: Ask<'_>) -> (Vec<Vec<TrianglePair>>, QueryStats) {
    let bvh = MorphBvh::build(Arc::new(mesh.to_model().unwrap()), &BuildOptions::default());
    let bvh = Arc::new(bvh);
    let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
    let (mut query, mut stats) = (PairQuery::new(), QueryStats::default());
    let pairs = frames.iter().map(|[of_a, of_b]| {
        a.set_weights(&of_a.0).unwrap();
        b.set_weights(&of_b.0).unwrap();
        let places = [of_a.1, of_b.1].map(|place| WorldFromModel::new(place).unwrap());
        let (body_a, body_b) = (Body::new(&mut a, &places[0]), Body::new(&mut b, &places[1]));
        let mut pairs = Vec::new();
        match &mut ask {
            Ask::All => query.all(body_a, body_b, &mut pairs),
            Ask::First => pairs.extend(query.first(body_a, body_b)),
            Ask::FirstWith(memory) => pairs.extend(query.first_with(memory, body_a, body_b)),
        }
        stats += query.stats();
        pairs.sort_unstable();
        pairs
    });
    (pairs.collect(), stats)
}

fn touching(pairs: &[Vec<TrianglePair>]) -> Vec<bool> {
    pairs.iter().map(|pairs| !pairs.is_empty()).collect()
}

#[test]
fn a_pair_is_remembered_only_while_it_intersects() {
    for (mesh, frames) in [swimming(0.0), swimming(0.3), jumping()] {
        let (all, _) = replay(&mesh, &frames, Ask::All);
        let touching = touching(&all);
        assert!(
            touching.contains(&true) && touching.contains(&false),
            "bodies come and go"
        );
        let (first, _) = replay(&mesh, &frames, Ask::FirstWith(&mut PairMemory::new()));
        for (frame, (first, all)) in first.iter().zip(&all).enumerate() {
            assert_eq!(first.is_empty(), all.is_empty(), "frame {frame}");
            assert!(first.iter().all(|pair| all.contains(pair)), "frame {frame}");
        }
    }
}

#[test]
fn a_pair_that_goes_on_touching_is_found_where_it_touched() {
    let (mesh, frames) = swimming(0.0);
    let (plain, stats) = replay(&mesh, &frames, Ask::First);
    let (with, remembering) = replay(&mesh, &frames, Ask::FirstWith(&mut PairMemory::new()));
    assert_eq!(touching(&with), touching(&plain));
    assert!(remembering.node_tests < stats.node_tests, "{remembering:?}, {stats:?}");
}

#[test]
fn a_memory_of_one_tree_says_nothing_about_another() {
    let touching_at = |x: f32| [0.0, x].map(|x| (vec![], Affine3A::from_translation(Vec3::X * x)));
    let mut memory = PairMemory::new();
    // The last triangles of a long row touch. A smaller tree has no such leaves.
    let row = |cubes: usize| {
        let mut mesh = random::random_blob(3, 1, 0, 0.0);
        let one = mesh.clone();
        for cube in 1..cubes as u32 {
            let first = mesh.positions.len() as u32;
            mesh.positions
                .extend(one.positions.iter().map(|p| *p + Vec3::X * 4.0 * cube as f32));
            mesh.triangles.extend(
                one.triangles
                    .iter()
                    .map(|triangle| triangle.map(|vertex| vertex + first)),
            );
        }
        mesh
    };
    let (long, short) = (row(20), row(1));
    let at_the_end = vec![touching_at(4.0 * 19.0 + 0.5)];
    let (before, _) = replay(&long, &at_the_end, Ask::FirstWith(&mut memory));
    assert!(!before[0].is_empty());
    let frames = vec![touching_at(0.5)];
    let (plain, _) = replay(&short, &frames, Ask::First);
    let (with, _) = replay(&short, &frames, Ask::FirstWith(&mut memory));
    assert!(!plain[0].is_empty() && with == plain);
}
