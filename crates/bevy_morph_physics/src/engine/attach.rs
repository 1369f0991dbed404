//! Gives meshes their surface in physics, and removes it.

use std::sync::Arc;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::{Allow, QueryData};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::components::{MorphCollider, MorphShape, MorphTreeOptions};
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::physics_api::take_weights;
use morph_collision::{MorphBvh, Pose};

use super::interface::Engine;
use super::surface::PhysicsSurface;
use crate::components::MorphPhysicsCollider;
use crate::moving::MovingSurface;
use crate::shape::MeshLayouts;

/// The components that decide whether an entity has a surface, and which.
#[derive(QueryData)]
pub struct AttachComponents {
    mesh: Option<&'static Mesh3d>,
    settings: Option<&'static MorphTreeOptions>,
    skin: Option<&'static SkinnedMesh>,
    weights: Option<&'static MeshMorphWeights>,
    has_shape: Has<MorphShape>,
    collides: Has<MorphCollider>,
    in_physics: Has<MorphPhysicsCollider>,
    is_disabled: Has<Disabled>,
}

impl AttachComponentsItem<'_, '_> {
    /// The tree of the surface that the entity should have.
    fn tree<'a>(&self, trees: &'a MorphTrees) -> Option<&'a Arc<MorphBvh>> {
        // A shape collides in place of the mesh.
        let mesh = self
            .mesh
            .filter(|_| self.collides && self.in_physics && !self.has_shape)?;
        trees.shown_with(mesh, self.settings, self.skin)
    }
}

/// Adds a surface to colliders whose mesh has a tree. Removes it when the collider, the mesh or its tree is gone.
///
/// This reads [`MorphTrees`] directly, so physics continues while collision detection is paused.
pub fn attach_surfaces<E: Engine>(
    mut commands: Commands,
    colliders: Query<
        (
            Entity,
            AttachComponents,
            Option<&PhysicsSurface<E>>,
            Option<&E::Collider>,
        ),
        (
            Allow<Disabled>,
            Or<(With<MorphPhysicsCollider>, With<PhysicsSurface<E>>)>,
        ),
    >,
    shared: Query<&MorphWeights>,
    trees: Option<Res<MorphTrees>>,
    layouts: Option<Res<MeshLayouts>>,
    mut rest: Local<Vec<f32>>,
) {
    let (Some(trees), Some(layouts)) = (trees, layouts) else {
        return;
    };
    for (entity, components, surface, collider) in &colliders {
        // The game's own collider takes precedence.
        let is_foreign = collider.is_some_and(|collider| !E::is_surface(collider));
        let is_disabled = components.is_disabled;
        match (surface, components.tree(&trees).filter(|_| !is_foreign)) {
            (None, Some(bvh)) if !is_disabled => {
                let mut pose = Pose::new(bvh.clone());
                // Bad weights are logged in the surface's first step.
                let _logged_later = take_weights(&mut pose, components.weights, &shared, &mut rest);
                let Some(layout) = layouts.of(bvh) else { continue };
                let moving = MovingSurface::new(entity, bvh, pose.weights(), &layout);
                let mut entity_commands = commands.entity(entity);
                E::attach(&mut entity_commands, &moving.surface);
                let state = E::new_state(entity, layout);
                entity_commands.try_insert(PhysicsSurface::<E>::new(moving, state, bvh.clone()));
            }
            (None, _) => {}
            (Some(_), None) => remove::<E>(commands.entity(entity), is_foreign, false),
            (Some(surface), Some(bvh)) => {
                if !is_disabled && !Arc::ptr_eq(&surface.bvh, bvh) {
                    // Also removes its parts; the new surface is added next time.
                    remove::<E>(commands.entity(entity), is_foreign, true);
                }
            }
        }
    }
}

/// Removes a surface. A collider of the game's own stays.
fn remove<E: Engine>(mut entity: EntityCommands, is_foreign: bool, replaced: bool) {
    entity.try_remove::<PhysicsSurface<E>>();
    E::detach(&mut entity, replaced);
    if !is_foreign && !replaced {
        entity.try_remove::<E::Collider>();
    }
}

/// Removes a surface from physics immediately when [`MorphPhysicsCollider`] is removed.
pub fn detach_surface<E: Engine>(
    removed: On<Remove<MorphPhysicsCollider>>,
    surfaces: Query<Option<&E::Collider>, (With<PhysicsSurface<E>>, Allow<Disabled>)>,
    mut commands: Commands,
) {
    if let Ok(collider) = surfaces.get(removed.entity) {
        let is_foreign = collider.is_some_and(|collider| !E::is_surface(collider));
        remove::<E>(commands.entity(removed.entity), is_foreign, false);
    }
}
