//! The chunks of skinned meshes' trees.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use morph_collision_models::generated::{degenerate, random};
use morph_collision_models::mesh::MorphMesh;

use super::budget::{Budget, run_to_end};
use super::build::{Splits, build_over};
use super::chunks::MAX_TRIANGLES;
use super::*;
use crate::bounds::Aabb;
use crate::joints::JointMatrices;
use crate::model::{BLOCK, Influences, MorphModel};
use crate::pose::Pose;
use crate::{Body, WorldFromModel};

/// A mesh whose vertices follow two joints.
fn skinned(mesh: &MorphMesh) -> Arc<MorphModel> {
    let influences = Influences {
        joints: &vec![[0, 1, 0, 0]; mesh.positions.len()],
        weights: &vec![[0.75, 0.25, 0.0, 0.0]; mesh.positions.len()],
    };
    Arc::new(MorphModel::skinned(&mesh.positions, &mesh.triangles, &mesh.targets, 2, &[influences]).unwrap())
}

/// Splits one triangle off each node.
struct Skewed;

impl Splits for Skewed {
    async fn split(&mut self, triangles: &mut [u32], _: usize, _: &Budget) -> Option<Vec<usize>> {
        (triangles.len() > 1).then(|| vec![1, triangles.len() - 1])
    }
}

fn skewed(mesh: &MorphMesh) -> MorphBvh {
    let (model, triangles) = (skinned(mesh), (0..mesh.triangles.len() as u32).collect());
    let (options, budget) = (BuildOptions::default().with_leaf_size(1).unwrap(), Budget::unlimited());
    run_to_end(build_over(model, &options, triangles, Skewed, &budget))
}

/// Walks over the tree, and fails if a node is not in the chunk where it belongs. Returns the numbers of chunks and of those that are leaves.
fn check(bvh: &MorphBvh) -> [usize; 2] {
    let (topology, skin) = (&bvh.topology, bvh.skin.as_ref().unwrap());
    let chunks = &skin.chunks;
    let (mut outer, mut count, mut leaf_chunks) = (Vec::new(), 0, 0);
    let mut rest = vec![Child::group(0)];
    while let Some(top) = rest.pop() {
        let mut groups = Vec::new();
        let mut leaves = Vec::new();
        match top.kind() {
            ChildKind::Leaf(leaf) => {
                leaves.push(leaf);
                leaf_chunks += 1;
            }
            ChildKind::Group(group) if group == 0 || topology.triangles_below(top).len() > MAX_TRIANGLES => {
                assert_eq!(chunks.source(group), Source::Outer(outer.len()));
                outer.push(group);
                rest.extend(topology.group(group).children().iter().rev());
                continue;
            }
            ChildKind::Group(group) => {
                let mut below = vec![group];
                while let Some(group) = below.pop() {
                    groups.push(group);
                    for child in topology.group(group).children().iter().rev() {
                        match child.kind() {
                            ChildKind::Group(group) => below.push(group),
                            ChildKind::Leaf(leaf) => leaves.push(leaf),
                        }
                    }
                }
                groups.sort_unstable();
            }
        }
        let range = chunks.chunk(count).groups();
        assert!(range.clone().eq(groups.iter().copied()), "{range:?} are not {groups:?}");
        assert!(groups.iter().all(|&group| chunks.source(group) == Source::Chunk(count)));
        assert!(leaves.iter().all(|&leaf| chunks.of_leaf(leaf) == count));
        let vertices = leaves.iter().flat_map(|&leaf| topology.leaf_vertices(leaf));
        let mut blocks: Vec<u32> = vertices.map(|vertex| vertex / BLOCK as u32).collect();
        blocks.sort_unstable();
        blocks.dedup();
        assert_eq!(chunks.blocks(count), blocks);
        count += 1;
    }
    assert_eq!(chunks.len(), count);
    assert!(chunks.outer_groups().eq(outer.iter().copied()));
    assert_eq!(skin.outer.group_count(), outer.len());
    for (index, &group) in outer.iter().enumerate() {
        let children = skin.outer.group(index).children().count();
        // The box of a root whose children have outer boxes is their hull.
        let is_hull = group == 0 && outer.len() > 1;
        assert_eq!(
            children,
            if is_hull {
                0
            } else {
                topology.group(group).children().len()
            }
        );
    }
    [count, leaf_chunks]
}

/// Fails if a vertex is outside the box of a node. Returns the number of nodes.
fn check_boxes(bvh: MorphBvh, turn: f32) -> usize {
    let mut pose = Pose::new(Arc::new(bvh));
    let joints = [0.0, turn].map(|turn| Affine3A::from_translation(Vec3::splat(9.0)) * Affine3A::from_rotation_y(turn));
    pose.set_joints(&JointMatrices::new(&joints).unwrap()).unwrap();
    let mut boxes: Vec<(Aabb, WorldFromModel, Vec<u32>)> = Vec::new();
    pose.visit_nodes(|node| {
        let place = node.world_from_bounds.unwrap();
        boxes.push((node.bounds, place, node.triangles.to_vec()));
        true
    });
    let count = boxes.len();
    let place = WorldFromModel::IDENTITY;
    let mut body = Body::new(&mut pose, &place);
    for (bounds, place, triangles) in boxes {
        assert!(bounds.size().is_finite());
        for corner in triangles
            .into_iter()
            .flat_map(|triangle| body.triangle(triangle).unwrap())
        {
            // The boxes above the chunks hold exact vertices; these are rounded.
            let (point, error) = (corner - place.translation(), 1e-13);
            let is_in = (point + error).cmpge(bounds.min.as_dvec3()) & (point - error).cmple(bounds.max.as_dvec3());
            assert!(is_in.all(), "{point} outside {bounds:?}");
        }
    }
    count
}

#[test]
fn every_node_is_in_one_chunk_or_above_them() {
    let meshes = [
        random::random_blob(2, 5, 1, 0.5),
        random::triangle_soup(3, 12 * MAX_TRIANGLES, 0),
        random::triangle_soup(4, MAX_TRIANGLES + 1, 0),
        random::triangle_soup(5, MAX_TRIANGLES, 0),
        degenerate::all_equal(5000),
    ];
    for mesh in &meshes {
        for leaf_size in [1, 8, 255] {
            let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
            let bvh = MorphBvh::build(skinned(mesh), &options);
            let [count, leaf_chunks] = check(&bvh);
            let triangles = mesh.triangles.len();
            assert!(
                count >= triangles.div_ceil(MAX_TRIANGLES.max(leaf_size)),
                "{count} for {triangles}"
            );
            assert_eq!(count == 1, triangles <= MAX_TRIANGLES.max(leaf_size));
            println!(
                "{} with {leaf_size}: {count} chunks, {leaf_chunks} are leaves",
                mesh.name
            );
            let nodes = bvh.node_count();
            assert_eq!(check_boxes(bvh, 0.5), nodes);
        }
    }
}

#[test]
fn single_leaves_are_chunks_of_their_own() {
    // One leaf, which is the root.
    let bvh = MorphBvh::build(skinned(&random::triangle_soup(6, 5, 0)), &BuildOptions::default());
    assert_eq!(check(&bvh), [1, 1]);
    assert_eq!(check_boxes(bvh, 0.5), 1);
    // All children of the root are leaves.
    let options = BuildOptions::default().with_leaf_size(255).unwrap();
    let bvh = MorphBvh::build(skinned(&random::triangle_soup(7, 1000, 0)), &options);
    let [count, leaf_chunks] = check(&bvh);
    assert!(count > 3 && count == leaf_chunks, "{count}, {leaf_chunks}");
    assert_eq!(check_boxes(bvh, 0.5), count + 1);
}

#[test]
fn trees_of_any_depth_are_cut() {
    let triangles = MAX_TRIANGLES + 88;
    let bvh = skewed(&random::triangle_soup(8, triangles, 0));
    assert_eq!(bvh.depth(), triangles - 1);
    // Each of the 88 groups above the last chunk has one leaf and the next group.
    assert_eq!(check(&bvh), [89, 88]);
    assert_eq!(check_boxes(bvh, 0.5), 2 * triangles - 1);
}
