//! Computes the state in which collisions see a collider with a tolerance, independently of the plugin by the documented rule,
//! and how far its vertices really are from that state.

use bevy::math::DVec3;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::morph_collision::{Body, JointMatrices, Pose, WorldFromModel};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::drawn::{self, Part};

/// The state in which collisions see one collider.
pub(crate) struct Follower {
    seen: (Pose, WorldFromModel),
    vertices: Vec<DVec3>,
}

/// A collider's current state.
pub(crate) struct Now {
    pose: Pose,
    place: WorldFromModel,
    vertices: Vec<DVec3>,
}

impl Now {
    pub(crate) fn new(world: &World, part: &Part, meshes: &[MorphMesh]) -> Option<Self> {
        let entity = part.entity;
        let skin = world.get::<SkinnedMesh>(entity);
        let trees = world.resource::<MorphTrees>();
        let tree = trees.shown_with(world.get::<Mesh3d>(entity)?, None, skin)?;
        let mut pose = Pose::new(tree.clone());
        pose.set_weights(&drawn::weights(world, entity)).ok()?;
        let global = |entity: Entity| Some(world.get::<GlobalTransform>(entity)?.affine());
        if let Some(skin) = skin {
            let poses = world.resource::<Assets<SkinnedMeshInverseBindposes>>();
            let poses = poses.get(&skin.inverse_bindposes)?;
            let joints = skin.joints.iter().zip(poses.iter());
            let joints: Option<Vec<_>> = joints
                .map(|(&joint, &inverse)| Some(bevy::math::Affine3A::from_mat4(Mat4::from(global(joint)?) * inverse)))
                .collect();
            pose.set_joints(&JointMatrices::new(&joints?).ok()?).ok()?;
        }
        let all = drawn::vertices(world, &meshes[part.mesh], entity);
        let mut used: Vec<u32> = part.triangles(meshes).as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        Some(Self {
            pose,
            place: WorldFromModel::new(global(entity)?).ok()?,
            vertices: used.iter().map(|&vertex| all[vertex as usize]).collect(),
        })
    }
}

impl Follower {
    pub(crate) fn new(now: &Now) -> Self {
        Self {
            seen: (now.pose.clone(), now.place),
            vertices: now.vertices.clone(),
        }
    }

    /// Compares with the collider now, with a tolerance in world units, and returns the largest distance of a vertex from where collisions see it,
    /// and the bound on that distance.
    pub(crate) fn update(&mut self, now: &mut Now, tolerance: f64) -> (f64, f64) {
        let (pose, place) = &mut self.seen;
        let bound = Body::new(&mut now.pose, &now.place).displacement_from(Body::new(pose, place));
        let moved = self.vertices.iter().zip(&now.vertices).map(|(a, b)| a.distance(*b));
        let moved = moved.fold(0.0, f64::max);
        if bound > tolerance {
            *self = Self::new(now);
            return (0.0, 0.0);
        }
        (moved, bound)
    }
}
