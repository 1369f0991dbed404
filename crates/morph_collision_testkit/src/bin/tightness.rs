//! `tightness`: how much larger the boxes of skinned models are than the smallest ones in the same spaces, for their clips and
//! for random poses.
//!
//! It compares the cost of a walk by the surface-area heuristic: the sum over nodes of a box's area times the number of children
//! or triangles below the node.
//!
//! - `leaves tight` uses the smallest boxes for leaves on both sides, `all` uses every box as it is.
//! - `/ morph` is the sum over all boxes divided by that of `morph`, whose boxes are in joint spaces. The boxes of `joint-boxes`
//!   and `joint-union` are along the world's axes, over a tree of their own with leaves of the same size.
//!
//! With joints that scale unevenly (`Scaled`) it says little, because areas in stretched spaces are compared with areas in the
//! world.

use std::collections::BTreeMap;
use std::error::Error;
use std::sync::Arc;

use glam::{Affine3A, DMat3, DVec3};
use morph_collision::{Body, BuildOptions, JointMatrices, MorphBvh, Pose, WorldFromModel};
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::rigs::{self, PoseKind};
use morph_collision_testkit::moments::find_real_model;
use morph_collision_testkit::rivals::JointNodes;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const MODELS: [&str; 4] = [
    "mh_character.glb",
    "mh_character_low.glb",
    "RobotExpressive.glb",
    "Fox.glb",
];

/// Frames per clip, and poses per kind.
const FRAMES: usize = 12;

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "{:24} {:16} {:12} {:>12} {:>8} {:>8}",
        "model", "poses", "method", "leaves tight", "all", "/ morph"
    );
    let mut meshes = Vec::new();
    for model in MODELS {
        match find_real_model(model) {
            Ok(path) => meshes.extend(read_meshes(&path)?.into_iter().filter(|mesh| mesh.skin.is_some())),
            Err(missing) => println!("{model}: skipped: {missing}"),
        }
    }
    meshes.push(rigs::tube(1, 12, 4, 3));
    meshes.push(rigs::branching(2, 24, 4, 3));
    for mesh in &meshes {
        of_mesh(mesh)?;
    }
    Ok(())
}

fn of_mesh(mesh: &MorphMesh) -> Result<(), Box<dyn Error>> {
    let Some(skin) = &mesh.skin else { return Ok(()) };
    let options = BuildOptions::default();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &options)));
    let rivals = [false, true].map(|union| JointNodes::new(mesh, union, &options.into()));
    let [joint_boxes, joint_union] = rivals;
    let rivals = [joint_boxes?, joint_union?];
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut sums: BTreeMap<String, [Costs; 3]> = BTreeMap::new();
    let mut add = |poses: String, joints: &[Affine3A]| -> Result<(), Box<dyn Error>> {
        let weights = weights(&mut rng, mesh.targets.len());
        pose.set_joints(&JointMatrices::new(joints)?)?;
        pose.set_weights(&weights)?;
        let corners = corners(&mut pose);
        let sums = sums.entry(poses).or_default();
        sums[0].add(&costs(&nodes(&mut pose), &corners));
        for (sum, rival) in sums[1..].iter_mut().zip(&rivals) {
            sum.add(&costs(&nodes_of(rival, &weights, joints), &corners));
        }
        Ok(())
    };
    for clip in &skin.skeleton.clips {
        for frame in 0..FRAMES {
            let seconds = clip.duration() * frame as f32 / FRAMES as f32;
            add("clips".to_owned(), &skin.skeleton.world_from_mesh(Some(clip), seconds))?;
        }
    }
    for kind in [PoseKind::Gentle, PoseKind::Turned, PoseKind::Scaled] {
        for seed in 0..FRAMES as u64 {
            add(format!("{kind:?}"), &kind.draw(&skin.skeleton, seed))?;
        }
    }
    for (poses, of_methods) in sums {
        for (method, costs) in ["morph", "joint-boxes", "joint-union"].iter().zip(&of_methods) {
            let [leaves_tight, all] = [costs.leaves_tight, costs.bounded].map(|cost| cost / costs.tight);
            let ratio = costs.bounded / of_methods[0].bounded;
            println!(
                "{:24} {poses:16} {method:12} {leaves_tight:12.3} {all:8.3} {ratio:8.3}",
                mesh.name
            );
        }
    }
    Ok(())
}

/// Weights like those of faces: three quarters of the targets active, with a sum of at most 12, and a quarter of them negative.
fn weights(rng: &mut Pcg64Mcg, targets: usize) -> Vec<f32> {
    let mut one = |_| match rng.random_range(0..16) {
        0..4 => 0.0,
        4..7 => rng.random_range(-0.3..0.0),
        _ => rng.random_range(0.0..0.5),
    };
    (0..targets).map(&mut one).collect()
}

#[derive(Default)]
struct Costs {
    tight: f64,
    leaves_tight: f64,
    bounded: f64,
}

impl Costs {
    fn add(&mut self, other: &Self) {
        self.tight += other.tight;
        self.leaves_tight += other.leaves_tight;
        self.bounded += other.bounded;
    }
}

/// A visited node.
struct Node {
    is_leaf: bool,
    min: DVec3,
    max: DVec3,
    place: WorldFromModel,
    triangles: Vec<u32>,
    children: usize,
}

/// The nodes of our tree, each in the space of its box.
fn nodes(pose: &mut Pose) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::new();
    let mut path: Vec<usize> = Vec::new();
    pose.visit_nodes(|node| {
        path.truncate(node.depth);
        if let Some(&parent) = path.last() {
            nodes[parent].children += 1;
        }
        path.push(nodes.len());
        nodes.push(Node {
            is_leaf: node.is_leaf,
            min: node.bounds.min.as_dvec3(),
            max: node.bounds.max.as_dvec3(),
            place: node.world_from_bounds.unwrap_or_default(),
            triangles: node.triangles.to_vec(),
            children: 0,
        });
        true
    });
    nodes
}

/// The nodes of a rival's tree, in world space.
fn nodes_of(rival: &JointNodes, weights: &[f32], joints: &[Affine3A]) -> Vec<Node> {
    let mut nodes = Vec::new();
    rival.visit(weights, joints, |node| {
        nodes.push(Node {
            is_leaf: node.children == 0,
            min: node.bounds.min.as_dvec3(),
            max: node.bounds.max.as_dvec3(),
            place: WorldFromModel::IDENTITY,
            triangles: node.triangles.to_vec(),
            children: node.children,
        });
    });
    nodes
}

/// The corners of all triangles in world space.
fn corners(pose: &mut Pose) -> Vec<[DVec3; 3]> {
    let (count, place) = (pose.bvh().model().triangle_count() as u32, WorldFromModel::IDENTITY);
    let mut body = Body::new(pose, &place);
    (0..count).filter_map(|triangle| body.triangle(triangle)).collect()
}

fn costs(nodes: &[Node], corners: &[[DVec3; 3]]) -> Costs {
    let mut costs = Costs::default();
    for node in nodes {
        // A frame may be scaled, so areas are compared in the world's unit.
        let origin = node.place.transform_point(glam::Vec3::ZERO);
        let axis = |axis: glam::Vec3| node.place.transform_point(axis) - origin;
        let linear = DMat3::from_cols(axis(glam::Vec3::X), axis(glam::Vec3::Y), axis(glam::Vec3::Z));
        let (inverse, unit) = (linear.inverse(), linear.determinant().abs().powf(2.0 / 3.0));
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &triangle in &node.triangles {
            for corner in corners[triangle as usize] {
                let point = inverse * (corner - origin);
                (min, max) = (min.min(point), max.max(point));
            }
        }
        let below = if node.is_leaf {
            node.triangles.len()
        } else {
            node.children
        } as f64;
        let area = |size: DVec3| (size.x * size.y + size.y * size.z + size.z * size.x) * unit * below;
        let (tight, bounded) = (area(max - min), area(node.max - node.min));
        costs.tight += tight;
        costs.bounded += bounded;
        costs.leaves_tight += if node.is_leaf { tight } else { bounded };
    }
    costs
}
