use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{Body, MorphBvh, PairMemory, PairQuery, Pose, TrianglePair, WorldFromModel};

use super::draw::Draw;
use crate::oracle;
use crate::verify::{check_containment, check_refitted_containment};
use morph_collision_models::mesh::MorphMesh;

/// Poses and places two small meshes a few times. Checks every way to ask for their pairs against the oracle, and every
/// vertex against the boxes above it.
///
/// # Panics
/// If an answer is wrong.
pub fn pairs(data: &[u8]) {
    let mut draw = Draw::new(data);
    let options = [draw.options(), draw.options()];
    let same = draw.flag();
    let mesh_a = draw.mesh();
    let mesh_b = if same { mesh_a.clone() } else { draw.mesh() };
    let meshes = [&mesh_a, &mesh_b];
    let mut poses = Vec::new();
    for (mesh, options) in meshes.into_iter().zip(&options) {
        let Ok(model) = mesh.to_model() else { return };
        poses.push(Pose::new(Arc::new(MorphBvh::build(Arc::new(model), options))));
    }
    let mut memory = PairMemory::new();
    let mut query = PairQuery::new();
    let mut is_refitted = [false; 2];
    for _ in 0..draw.among(1, 3) {
        let mut places = Vec::new();
        for (pose, is_refitted) in poses.iter_mut().zip(&mut is_refitted) {
            let place = draw.place();
            // A pose that refuses weights keeps its old ones and its boxes.
            let changed = pose.set_weights(&draw.weights(pose.weights().len())).unwrap_or(false);
            *is_refitted &= !changed;
            if draw.flag() {
                pose.refit();
                *is_refitted = true;
            }
            let Ok(checked) = WorldFromModel::new(place) else {
                return;
            };
            places.push((place, checked));
        }
        let [(place_a, world_from_a), (place_b, world_from_b)] = &places[..] else {
            return;
        };
        let truth = truth(meshes, &poses, [place_a, place_b]);
        let (before, after) = poses.split_at_mut(1);
        let (a, b) = (&mut before[0], &mut after[0]);

        assert_pairs(&mut query, &mut memory, [(a, world_from_a), (b, world_from_b)], &truth);
        for ((mesh, pose), is_refitted) in meshes.into_iter().zip([a, b]).zip(is_refitted) {
            let report = if is_refitted {
                check_refitted_containment(mesh, pose)
            } else {
                check_containment(mesh, pose)
            };
            assert_eq!(report.first, None, "weights {:?}", pose.weights());
        }
    }
}

/// Asks for all pairs and the first pair of two bodies in every way.
pub(super) fn assert_pairs(
    query: &mut PairQuery,
    memory: &mut PairMemory,
    [(a, world_from_a), (b, world_from_b)]: [(&mut Pose, &WorldFromModel); 2],
    truth: &[(u32, u32)],
) {
    let mut found = Vec::new();
    query.all(Body::new(a, world_from_a), Body::new(b, world_from_b), &mut found);
    assert_eq!(sorted(&found), truth, "all");
    // Asks twice. The second time there is a witness, if there is a pair.
    for _ in 0..2 {
        let (a, b) = (Body::new(a, world_from_a), Body::new(b, world_from_b));
        let first = query.first_with(memory, a, b);
        let first: Vec<_> = first.into_iter().collect();
        assert_eq!(first.is_empty(), truth.is_empty(), "first with a memory");
        assert!(
            sorted(&first).iter().all(|pair| truth.contains(pair)),
            "first with a memory"
        );
    }
    found.clear();
    query.all(Body::new(b, world_from_b), Body::new(a, world_from_a), &mut found);
    let mut swapped: Vec<_> = found.iter().map(|pair| (pair.triangle_b, pair.triangle_a)).collect();
    swapped.sort_unstable();
    assert_eq!(swapped, truth, "the other way round");
}

/// The oracle's pairs of two posed bodies, ascending.
pub(super) fn truth(meshes: [&MorphMesh; 2], poses: &[Pose], places: [&Affine3A; 2]) -> Vec<(u32, u32)> {
    let world = |i: usize| {
        let mesh = meshes[i];
        let posed = oracle::posed_vertices(&mesh.positions, &mesh.targets, poses[i].weights());
        oracle::world_vertices(&posed, places[i])
    };
    oracle::intersecting_pairs(&world(0), &meshes[0].triangles, &world(1), &meshes[1].triangles)
}

pub(super) fn sorted(pairs: &[TrianglePair]) -> Vec<(u32, u32)> {
    let mut sorted: Vec<_> = pairs.iter().map(|pair| (pair.triangle_a, pair.triangle_b)).collect();
    sorted.sort_unstable();
    sorted
}
