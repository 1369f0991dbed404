//! Colliders that morph and wander, and where their vertices are by brute force.

use bevy::math::{Affine3A, DVec3};
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::random::random_blob;
use morph_collision_models::mesh::{InfluenceSet, MorphMesh};
use morph_collision_testkit::oracle::{posed_vertices, skinned_vertices, world_vertices};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::support::{Edits, add_mesh, bevy_mesh};

pub(crate) struct Actor {
    pub(crate) entity: Entity,
    pub(crate) mesh: MorphMesh,
    pub(crate) collider: MorphCollider,
    /// The joints and the influences, for a skinned mesh.
    pub(crate) skin: Option<([Entity; 2], InfluenceSet)>,
}

impl Actor {
    /// Its vertices in the world, as they are now; `None` if it takes no part.
    pub(crate) fn vertices(&self, world: &World) -> Option<Vec<DVec3>> {
        if world.get::<MorphColliderDisabled>(self.entity).is_some() {
            return None;
        }
        let global = |entity: Entity| -> Affine3A { world.get::<GlobalTransform>(entity).unwrap().affine() };
        let weights = match world.get::<MeshMorphWeights>(self.entity) {
            Some(MeshMorphWeights::Value { weights }) => weights.clone(),
            _ => vec![0.0; self.mesh.targets.len()],
        };
        let posed = posed_vertices(&self.mesh.positions, &self.mesh.targets, &weights);
        Some(match &self.skin {
            None => world_vertices(&posed, &global(self.entity)),
            Some((joints, set)) => skinned_vertices(&posed, std::slice::from_ref(set), &joints.map(global)),
        })
    }
}

/// A blob of `20 * 4^level` triangles with four targets.
fn blob(seed: u64, level: u32) -> MorphMesh {
    random_blob(seed, level, 4, 0.4)
}

/// Blobs of a level, one for each of these colliders.
pub(crate) fn blobs(app: &mut App, level: u32, colliders: &[MorphCollider]) -> Vec<Actor> {
    let spawn = |(seed, &collider): (u64, &MorphCollider)| {
        let mesh = blob(seed, level);
        let handle = add_mesh(app, &mesh);
        let entity = (Mesh3d(handle), Transform::default(), collider);
        Actor {
            entity: app.spawn(entity),
            mesh,
            collider,
            skin: None,
        }
    };
    (0..).zip(colliders).map(spawn).collect()
}

/// A blob that two joints share.
pub(crate) fn skinned_blob(app: &mut App, (seed, level): (u64, u32), collider: MorphCollider) -> Actor {
    let mesh = blob(seed, level);
    let share = |p: &Vec3| (0.5 + p.x).clamp(0.0, 1.0);
    let set = InfluenceSet {
        joints: vec![[0, 1, 0, 0]; mesh.positions.len()],
        weights: mesh
            .positions
            .iter()
            .map(|p| [1.0 - share(p), share(p), 0.0, 0.0])
            .collect(),
    };
    let skinned = bevy_mesh(&mesh)
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_JOINT_INDEX,
            VertexAttributeValues::Uint16x4(set.joints.clone()),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, set.weights.clone());
    let world = app.world_mut();
    let skinned = world.resource_mut::<Assets<Mesh>>().add(skinned);
    let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]);
    let inverse_bindposes = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    let joints = [(); 2].map(|()| world.spawn(Transform::default()).id());
    let skin = SkinnedMesh {
        inverse_bindposes,
        joints: joints.to_vec(),
    };
    let entity = world
        .spawn((Mesh3d(skinned), skin, Transform::default(), collider))
        .id();
    Actor {
        entity,
        mesh,
        collider,
        skin: Some((joints, set)),
    }
}

/// Puts actors at random places, so that they are small for the way that they go in a frame. Some of them stay where they are.
pub(crate) fn scatter(app: &mut App, actors: &[Actor], rng: &mut Pcg64Mcg) {
    for actor in actors {
        if rng.random_bool(0.2) {
            continue;
        }
        let weights = actor.mesh.targets.iter().map(|_| rng.random_range(-0.3..0.6)).collect();
        let weights = MeshMorphWeights::Value { weights };
        let mut place = || {
            let at = Vec3::from_array(std::array::from_fn(|_| rng.random_range(-0.7..0.7)));
            let turn = Quat::from_rotation_y(rng.random_range(-1.0..1.0));
            Transform::from_translation(at)
                .with_rotation(turn)
                .with_scale(Vec3::splat(0.25))
        };
        let root = place();
        let mut entity = app.world_mut().entity_mut(actor.entity);
        entity.insert(weights);
        match &actor.skin {
            None => {
                entity.insert(root);
            }
            Some((joints, _)) => {
                for &joint in joints {
                    let near = root.translation + 0.1 * place().translation;
                    let joint_place = place().with_translation(near);
                    app.insert(joint, joint_place);
                }
            }
        }
    }
}

/// Weights and places in a frame at 60 Hz. Some of the colliders stand still now and then, or jump to another place for a few frames.
pub(crate) fn animate(app: &mut App, actors: &[Actor], frame: usize, rng: &mut Pcg64Mcg) {
    for (i, actor) in actors.iter().enumerate() {
        let phase = i as f32 * 1.7;
        let time = match (frame / 16 + i) % 5 {
            0 => (frame / 16 * 16) as f32 / 60.0,
            _ => frame as f32 / 60.0,
        };
        let weights = (0..actor.mesh.targets.len()).map(|k| 0.4 * (time * (1.0 + k as f32) + phase).sin());
        let weights = MeshMorphWeights::Value {
            weights: weights.collect(),
        };
        let at = Vec3::new(
            (0.9 * time + phase).sin(),
            (0.6 * time + 2.0 * phase).cos(),
            (phase * 3.0).sin(),
        ) * 1.1;
        let place = Transform::from_translation(at).with_rotation(Quat::from_rotation_y(0.5 * time + phase));
        app.insert(actor.entity, weights);
        if actor.skin.is_none() {
            let jump = if rng.random_bool(0.02) {
                Vec3::X * 3.0
            } else {
                Vec3::ZERO
            };
            app.insert(actor.entity, place.with_translation(at + jump));
        } else if let Some((joints, _)) = &actor.skin {
            for (k, &joint) in joints.iter().enumerate() {
                let turn = Quat::from_rotation_z(0.4 * (time * 2.0 + phase + k as f32).sin());
                let at = at + turn * Vec3::X * (k as f32 - 0.5) * 0.2;
                app.insert(joint, Transform::from_translation(at).with_rotation(turn));
            }
        }
    }
}
