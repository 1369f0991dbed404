//! A skinned model from a file that plays a clip, and its true vertices.

use std::path::Path;

use bevy::gltf::Gltf;
use bevy::math::{Affine3A, DVec3};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, skinned_vertices};

use super::settle;
use crate::app::{load_gltf, update_until};
use crate::error::ExampleError;

/// A model with one skinned mesh.
#[derive(Debug)]
pub struct Player {
    /// Its mesh, as in the file.
    pub mesh: MorphMesh,
    /// The entity with the mesh.
    pub surface: Entity,
    joints: Vec<Entity>,
}

/// Whether the scene is spawned.
#[derive(Resource, Default)]
struct Ready(bool);

impl Player {
    /// Spawns the model at this scale, waits until it is in physics, and plays a clip. `collider` is for the entity with the mesh.
    ///
    /// # Errors
    /// The file cannot be loaded, or has no skinned mesh or no such clip.
    pub fn spawn(
        app: &mut App,
        file: &Path,
        clip: &str,
        scale: f32,
        collider: impl Bundle,
    ) -> Result<Self, ExampleError> {
        let lacks = |reason: &str| ExampleError::Load {
            path: file.into(),
            reason: reason.into(),
        };
        let meshes = read_meshes(file).map_err(|error| lacks(&error.to_string()))?;
        let mesh = meshes.into_iter().next().ok_or_else(|| lacks("it has no mesh"))?;
        let gltf = load_gltf(app, file)?;
        let (scene, clip) = {
            let gltf = app.world().resource::<Assets<Gltf>>().get(&gltf);
            let parts =
                gltf.and_then(|gltf| Some((gltf.scenes.first()?.clone(), gltf.named_animations.get(clip)?.clone())));
            parts.ok_or_else(|| lacks("it has no such clip"))?
        };
        app.init_resource::<Ready>();
        app.world_mut()
            .add_observer(|_: On<WorldInstanceReady>, mut ready: ResMut<Ready>| ready.0 = true);
        let size = Transform::from_scale(Vec3::splat(scale));
        app.world_mut()
            .spawn((WorldAssetRoot(scene), Visibility::default(), size));
        update_until(app, file, |world| Ok(world.resource::<Ready>().0))?;
        let world = app.world_mut();
        let mut skinned = world.query::<(Entity, &SkinnedMesh)>();
        let (surface, skin) = skinned
            .single(world)
            .map_err(|_| lacks("it must have one skinned mesh"))?;
        let joints = skin.joints.clone();
        world.entity_mut(surface).insert(collider);
        let (graph, node) = AnimationGraph::from_clip(clip);
        let graph = world.resource_mut::<Assets<AnimationGraph>>().add(graph);
        let mut players = world.query_filtered::<Entity, With<AnimationPlayer>>();
        let players: Vec<Entity> = players.iter(world).collect();
        for &player in &players {
            world.entity_mut(player).insert(AnimationGraphHandle(graph.clone()));
        }
        settle(app);
        for &player in &players {
            if let Some(mut player) = app.world_mut().get_mut::<AnimationPlayer>(player) {
                player.play(node).repeat();
            }
        }
        Ok(Self { mesh, surface, joints })
    }

    /// The current positions of its vertices, in the file's order, morphed and skinned by brute force.
    #[must_use]
    pub fn vertices(&self, app: &App) -> Vec<DVec3> {
        let Some(skin) = &self.mesh.skin else {
            return Vec::new();
        };
        let weights = vec![0.0; self.mesh.targets.len()];
        let posed = posed_vertices(&self.mesh.positions, &self.mesh.targets, &weights);
        let joints = self.joints.iter().zip(&skin.skeleton.joints);
        let matrices: Vec<Affine3A> = joints
            .map(|(&entity, joint)| {
                let global = app.world().get::<GlobalTransform>(entity).copied().unwrap_or_default();
                Affine3A::from_mat4(Mat4::from(global.affine()) * joint.inverse_bind)
            })
            .collect();
        skinned_vertices(&posed, &skin.sets, &matrices)
    }

    /// Its highest vertex.
    #[must_use]
    pub fn top(&self, app: &App) -> Vec3 {
        let vertices = self.vertices(app);
        let highest = vertices.iter().max_by(|a, b| a.y.total_cmp(&b.y));
        highest.copied().unwrap_or_default().as_vec3()
    }
}
