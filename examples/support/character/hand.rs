//! Detects where the hand touches the face.

use std::sync::Arc;

use bevy::ecs::entity::EntityHashMap;
use bevy::math::Affine3A;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::morph_collision::{JointMatrices, Pose, SelfQuery};
use bevy_morph_collision::prelude::*;

/// The intersecting pairs of triangles of a hand and the face.
#[derive(Component, Clone, Debug, Default)]
pub struct HandOnFace(pub Vec<TrianglePair>);

/// The part of the body that a triangle belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Hand,
    Face,
    Elsewhere,
}

/// A pose of the character's tree, and the part that each triangle belongs to.
pub(super) struct Kept {
    pose: Pose,
    places: Vec<Place>,
}

/// The plugin compares bodies with each other. To compare a body with itself, this asks the core library, with a pose
/// of the same tree.
pub(super) fn feel(
    mut skins: Query<(
        Entity,
        &Mesh3d,
        &SkinnedMesh,
        Option<&MeshMorphWeights>,
        &mut HandOnFace,
    )>,
    shared: Query<&MorphWeights>,
    joints: Query<(&GlobalTransform, Option<&Name>)>,
    bind_poses: Res<Assets<SkinnedMeshInverseBindposes>>,
    meshes: Res<Assets<Mesh>>,
    trees: Res<MorphTrees>,
    mut kept: Local<EntityHashMap<Kept>>,
    mut query: Local<SelfQuery>,
) {
    for (entity, mesh, skin, weights, mut touching) in &mut skins {
        let (Some(tree), Some(shown)) = (trees.shown_with(mesh, None, Some(skin)), meshes.get(mesh)) else {
            continue;
        };
        let is_known = kept.get(&entity).is_some_and(|kept| Arc::ptr_eq(kept.pose.bvh(), tree));
        if !is_known {
            let name = |joint: u16| {
                let joint = skin.joints.get(usize::from(joint))?;
                joints.get(*joint).ok()?.1.map(Name::as_str)
            };
            let places = places(shown, name);
            let pose = Pose::new(tree.clone());
            kept.insert(entity, Kept { pose, places });
        }
        let Some(Kept { pose, places }) = kept.get_mut(&entity) else {
            continue;
        };
        let matrices = skin.joints.iter().zip(
            bind_poses
                .get(&skin.inverse_bindposes)
                .into_iter()
                .flat_map(|b| b.iter()),
        );
        let matrices: Vec<Affine3A> = matrices
            .filter_map(|(joint, bind_pose)| {
                Some(joints.get(*joint).ok()?.0.affine() * Affine3A::from_mat4(*bind_pose))
            })
            .collect();
        let weights = match weights {
            Some(MeshMorphWeights::Value { weights }) => weights.as_slice(),
            Some(MeshMorphWeights::Reference(source)) => shared.get(*source).map_or(&[][..], MorphWeights::weights),
            None => &[],
        };
        // If something does not fit yet, the pose stays as it was.
        let _posed = (
            pose.set_weights(weights),
            JointMatrices::new(&matrices).map(|matrices| pose.set_joints(&matrices)),
        );
        touching.0.clear();
        query.all(pose, &mut touching.0);
        let of = |triangle: u32| places.get(triangle as usize).copied().unwrap_or(Place::Elsewhere);
        touching.0.retain(|pair| {
            let both = [of(pair.triangle_a), of(pair.triangle_b)];
            both.contains(&Place::Hand) && both.contains(&Place::Face)
        });
    }
}

/// The part of each triangle: that of the strongest joint of its first corner.
fn places<'n>(mesh: &Mesh, name_of: impl Fn(u16) -> Option<&'n str>) -> Vec<Place> {
    let joints: Vec<[u16; 4]> = match mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX) {
        Some(VertexAttributeValues::Uint16x4(joints)) => joints.clone(),
        Some(VertexAttributeValues::Uint8x4(joints)) => joints.iter().map(|joints| joints.map(u16::from)).collect(),
        _ => return Vec::new(),
    };
    let Some(VertexAttributeValues::Float32x4(weights)) = mesh.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT) else {
        return Vec::new();
    };
    let Some(indices) = mesh.indices() else {
        return Vec::new();
    };
    let place = |vertex: usize| {
        let (joints, weights) = (joints.get(vertex)?, weights.get(vertex)?);
        let strongest = (0..4).max_by(|&a, &b| weights[a].total_cmp(&weights[b]))?;
        let name = name_of(joints[strongest])?;
        let fingers = ["hand_", "index_", "middle_", "ring_", "pinky_", "thumb_"];
        Some(if fingers.iter().any(|finger| name.starts_with(finger)) {
            Place::Hand
        } else if name == "head" {
            Place::Face
        } else {
            Place::Elsewhere
        })
    };
    let first = indices.iter().step_by(3);
    first.map(|vertex| place(vertex).unwrap_or(Place::Elsewhere)).collect()
}
