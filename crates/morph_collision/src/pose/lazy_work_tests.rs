//! What opening everything lazily costs, in any order, compared with a refit. docs/layout.md states the bound.

use std::sync::Arc;

use morph_collision_models::generated::{dolphin, random};
use morph_collision_models::mesh::MorphMesh;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::posed::Blended;
use super::{Pose, Posed};
use crate::bounds::with_simd;
use crate::model::{Influences, MorphModel};
use crate::tree::{BuildOptions, CornerLanes, Leaf, MorphBvh, OuterGroup, Topology};

/// The joints of [`skinned`].
const JOINTS: usize = 6;

fn unskinned(mesh: &MorphMesh) -> MorphModel {
    MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap()
}

/// Joints along an axis; two of them move each vertex.
fn skinned(mesh: &MorphMesh) -> MorphModel {
    let place = |x: f32| (x + 1.0).clamp(0.0, 2.0) * 0.5 * (JOINTS - 2) as f32;
    let of = |x: f32| [place(x) as u16, place(x) as u16 + 1, 0, 0];
    let weights = |x: f32| [1.0 - place(x).fract(), place(x).fract(), 0.0, 0.0];
    let influences = Influences {
        joints: &mesh.positions.iter().map(|at| of(at.x)).collect::<Vec<_>>(),
        weights: &mesh.positions.iter().map(|at| weights(at.x)).collect::<Vec<_>>(),
    };
    MorphModel::skinned(&mesh.positions, &mesh.triangles, &mesh.targets, JOINTS, &[influences]).unwrap()
}

fn pose(model: MorphModel, leaf_size: usize) -> Pose {
    let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &options)))
}

/// Models whose triangles use all vertices: with leaves that are blended side by side or gathered, and with joints.
fn poses(leaf_size: usize) -> Vec<Pose> {
    let (dolphin, soup) = (dolphin(1), random::triangle_soup(2, 700, 3));
    let [dense, sparse] = [0.0, 0.85].map(|sparsity| random::random_blob(7, 4, 40, sparsity));
    let mut poses: Vec<Pose> = [&dolphin, &soup, &dense, &sparse]
        .map(|mesh| pose(unskinned(mesh), leaf_size))
        .into();
    poses.extend([&dolphin, &sparse].map(|mesh| pose(skinned(mesh), leaf_size)));
    poses
}

#[derive(Clone, Copy)]
enum Visit {
    Group(usize),
    Leaf(Leaf),
}

/// The order of visits. None of them opens the ancestors of a node first.
#[derive(Clone, Copy, Debug)]
enum Order {
    DeepestFirst,
    /// Successive visits are far apart.
    OnePerPart,
    /// All leaves before all groups.
    LeavesFirst,
    Random,
}

fn visits(order: Order, topology: &Topology, rng: &mut Pcg64Mcg) -> Vec<Visit> {
    let groups = (0..topology.group_count()).map(Visit::Group);
    let leaves = (0..topology.leaf_count()).map(|leaf| Visit::Leaf(Leaf(leaf)));
    let mut all: Vec<Visit> = groups.rev().chain(leaves).collect();
    match order {
        // Groups are in preorder.
        Order::DeepestFirst => {}
        Order::OnePerPart => {
            let mut numbered: Vec<(u32, Visit)> = (0..).zip(all).collect();
            numbered.sort_by_key(|(number, _)| number.reverse_bits());
            all = numbered.into_iter().map(|(_, visit)| visit).collect();
        }
        Order::LeavesFirst => all.reverse(),
        Order::Random => all.shuffle(rng),
    }
    all
}

fn visit(posed: &mut Posed<'_>, at: Visit) {
    match at {
        Visit::Group(group) => {
            posed.open(group);
        }
        // Such leaves do not use posed vertices.
        Visit::Leaf(leaf) if posed.leaf_lanes.is_some() => {
            let topology = posed.topology;
            for &vertex in topology.leaf_vertices(leaf) {
                posed.world_vertex(vertex);
            }
        }
        Visit::Leaf(leaf) => {
            let mut corners = CornerLanes::default();
            for patch in 0..posed.topology.patches(leaf).len() {
                with_simd!(posed.level, simd => posed.box_corners(simd, leaf, patch, &mut corners));
            }
        }
    }
}

/// Runs the visits of all bodies in turns.
fn alternate(poses: &mut [Pose], visits: &[Vec<Visit>]) {
    let longest = visits.iter().map(Vec::len).max().unwrap_or(0);
    for turn in 0..longest {
        for (pose, visits) in poses.iter_mut().zip(visits) {
            if let Some(&at) = visits.get(turn) {
                visit(&mut pose.posed(), at);
            }
        }
    }
}

fn blended_since(pose: &mut Pose, before: Blended) -> Blended {
    let now = pose.posed().blended();
    Blended {
        volumes: now.volumes - before.volumes,
        vertices: now.vertices - before.vertices,
    }
}

/// The numbers of boxes and vertices of a mesh.
fn whole(posed: &Posed<'_>) -> Blended {
    Blended {
        volumes: posed.topology.node_count() as u64,
        vertices: posed.model.vertex_count() as u64,
    }
}

/// Steps of fitting all boxes: two for each coordinate of a vertex of a leaf or of the box of a child.
fn fitting(posed: &Posed<'_>) -> u64 {
    let leaves = (0..posed.topology.leaf_count()).map(Leaf);
    let vertices = leaves.map(|leaf| posed.topology.leaf_vertices(leaf).len());
    6 * (vertices.sum::<usize>() + posed.topology.node_count()) as u64
}

/// Steps of blending one number: the base, and each active target.
fn blending(posed: &Posed<'_>) -> u64 {
    1 + posed.weights.active().len() as u64
}

/// Steps of a refit, without what joints add to a vertex.
fn steps_of_refit(posed: &Posed<'_>) -> u64 {
    3 * whole(posed).vertices * blending(posed) + fitting(posed)
}

/// Steps of blending boxes and vertices lazily. The boxes of a skinned mesh are fitted, but those above its chunks are blended part by part.
fn steps(posed: &Posed<'_>, of: Blended) -> u64 {
    let vertices = 3 * of.vertices * blending(posed);
    let Some((tables, _)) = &posed.skin else {
        return vertices + 6 * of.volumes * blending(posed);
    };
    let groups = (0..tables.outer.group_count()).map(|group| tables.outer.group(group));
    let parts = groups.flat_map(OuterGroup::children).map(|(parts, _)| parts.len());
    vertices + fitting(posed) + 6 * parts.sum::<usize>() as u64 * blending(posed)
}

/// All weights, a few of them, or none.
fn weights(share: f64, targets: usize, rng: &mut Pcg64Mcg) -> Vec<f32> {
    let mut weight = || {
        if rng.random_bool(share) {
            rng.random_range(0.1..1.0)
        } else {
            0.0
        }
    };
    (0..targets).map(|_| weight()).collect()
}

fn set(poses: &mut [Pose], share: f64, rng: &mut Pcg64Mcg) -> Vec<Blended> {
    let mut before = Vec::new();
    for pose in poses {
        let weights = weights(share, pose.weights().len(), rng);
        pose.set_weights(&vec![9.0; weights.len()]).unwrap();
        pose.set_weights(&weights).unwrap();
        before.push(pose.posed().blended());
    }
    before
}

#[test]
fn opening_everything_lazily_takes_at_most_twice_the_work_of_a_refit() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut poses = poses(BuildOptions::default().leaf_size());
    let mut most = 0.0_f64;
    for share in [1.0, 0.08, 0.0] {
        for order in [
            Order::DeepestFirst,
            Order::OnePerPart,
            Order::LeavesFirst,
            Order::Random,
            Order::Random,
        ] {
            let before = set(&mut poses, share, &mut rng);
            // Everything twice, in two orders.
            for order in [order, Order::Random] {
                let all: Vec<_> = poses
                    .iter()
                    .map(|pose| visits(order, &pose.bvh.topology, &mut rng))
                    .collect();
                alternate(&mut poses, &all);
            }
            for (body, (pose, before)) in poses.iter_mut().zip(before).enumerate() {
                let blended = blended_since(pose, before);
                let posed = pose.posed();
                assert_eq!(blended, whole(&posed), "{order:?}, body {body}: once each");
                let ratio = steps(&posed, blended) as f64 / steps_of_refit(&posed) as f64;
                assert!(ratio <= 2.0, "{order:?}, body {body}: {ratio}");
                most = most.max(ratio);
            }
        }
    }
    println!("at most {most:.3} times the work of a refit");
    assert!(most > 1.5, "{most}: the bound is far from reached");
}

#[test]
fn a_refit_poses_only_what_is_not_posed_yet() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    for leaf_size in [1, 8, 20] {
        let mut poses = poses(leaf_size);
        for share in [0.0, 0.3, 0.9] {
            let before = set(&mut poses, 1.0, &mut rng);
            let some = |pose: &Pose, rng: &mut Pcg64Mcg| {
                let mut all = visits(Order::Random, &pose.bvh.topology, rng);
                all.truncate((share * all.len() as f64) as usize);
                all
            };
            let first: Vec<_> = poses.iter().map(|pose| some(pose, &mut rng)).collect();
            alternate(&mut poses, &first);
            let lazily: Vec<Blended> = poses
                .iter_mut()
                .zip(&before)
                .map(|(pose, &before)| blended_since(pose, before))
                .collect();
            poses.iter_mut().for_each(Pose::refit);
            // Nothing is left to do after that.
            let all: Vec<_> = poses
                .iter()
                .map(|pose| visits(Order::Random, &pose.bvh.topology, &mut rng))
                .collect();
            alternate(&mut poses, &all);
            for ((pose, before), lazily) in poses.iter_mut().zip(before).zip(lazily) {
                let blended = blended_since(pose, before);
                let whole = whole(&pose.posed());
                assert_eq!(blended.vertices, whole.vertices);
                assert_eq!(blended.volumes, lazily.volumes + whole.volumes);
            }
        }
    }
}
