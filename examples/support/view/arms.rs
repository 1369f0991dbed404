//! A ball with an arm that a morph target extends, and the same arm with joints instead.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use morph_collision_models::generated::pass_through_body_at;
use morph_collision_models::mesh::MorphMesh;

use super::models::with_normals;

/// The ball's radius.
pub const RADIUS: f32 = 0.45;

/// The length of the arm at weight 1. Joints extend it as far if the second one is moved by so much.
pub const REACH: f32 = 4.0;

/// A ball with one target, which extends an arm along `-X`.
#[must_use]
pub fn morphing() -> Mesh {
    with_normals(&arm())
}

/// The same ball without the target. Its second joint extends the arm.
#[must_use]
pub fn skinned() -> Mesh {
    let mut rigid = arm();
    rigid.targets.clear();
    let share = |p: &Vec3| {
        let pulled = (-p.x / RADIUS).max(0.0).powi(8);
        [1.0 - pulled, pulled, 0.0, 0.0]
    };
    let weights: Vec<[f32; 4]> = rigid.positions.iter().map(share).collect();
    let joints = vec![[0_u16, 1, 0, 0]; weights.len()];
    with_normals(&rigid)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints))
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
}

fn arm() -> MorphMesh {
    let mut mesh = pass_through_body_at(4);
    let directions: Vec<Vec3> = mesh.positions.iter().map(|p| p.normalize_or_zero()).collect();
    mesh.targets = vec![
        directions
            .iter()
            .map(|n| Vec3::NEG_X * REACH * (-n.x).max(0.0).powi(8))
            .collect(),
    ];
    mesh.target_names = vec!["reach".into()];
    mesh.positions = directions.iter().map(|n| RADIUS * *n).collect();
    mesh
}
