//! Gives meshes their surface in physics, and removes it.

use std::sync::Arc;

use avian3d::prelude::{Collider, RigidBody};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use morph_collision::{MorphBvh, Pose};

use super::MorphAvianCollider;
use super::push::Pushing;
use super::shape::WholeSurface;
use crate::components::{MorphCollider, MorphShape, MorphTreeOptions};
use crate::import::MorphTrees;
use crate::physics::follow::Following;
use crate::physics::layout::MeshLayouts;
use crate::physics::teleport::PhysicsSurface;
use crate::posing::take_weights;

/// The plugin's state of one surface.
#[derive(Component)]
pub(crate) struct AvianSurface {
    pub(super) following: Following,
    pub(super) pushing: Pushing,
    bvh: Arc<MorphBvh>,
    /// What its parts touch: colliders, with their bodies.
    pub(super) touching: HashMap<Entity, Option<Entity>>,
    /// Whether contacts are made with the whole surface. Its collider stores the same.
    pub(super) meets: bool,
    /// Why its position or size keeps it out of physics, so that this is logged once.
    pub(super) bad_place: Option<String>,
    /// Whether the log already says that it should be closed but is not.
    pub(super) told_open: bool,
}

impl PhysicsSurface for AvianSurface {
    fn following(&mut self) -> &mut Following {
        &mut self.following
    }
}

/// The components that decide whether an entity has a surface, and which.
type Shows<'w> = (
    Option<&'w Mesh3d>,
    Option<&'w MorphTreeOptions>,
    Option<&'w SkinnedMesh>,
    Option<&'w MeshMorphWeights>,
    Has<MorphShape>,
    Has<MorphCollider>,
    Has<MorphAvianCollider>,
    Has<Disabled>,
);

/// Adds a surface to colliders whose mesh has a tree. Removes it when the collider, the mesh or its tree is gone.
///
/// The first step gives it a shape. This reads [`MorphTrees`] directly, so physics continues while collision detection is paused.
pub(super) fn attach_surfaces(
    mut commands: Commands,
    colliders: Query<
        (Entity, Shows, Option<&AvianSurface>, Option<&Collider>),
        (Allow<Disabled>, Or<(With<MorphAvianCollider>, With<AvianSurface>)>),
    >,
    shared: Query<&MorphWeights>,
    (bodies, parents): (Query<&RigidBody>, Query<&ChildOf>),
    trees: Option<Res<MorphTrees>>,
    layouts: Res<MeshLayouts>,
    mut rest: Local<Vec<f32>>,
) {
    let Some(trees) = trees else { return };
    for (entity, shows, surface, collider) in &colliders {
        // The game's own collider takes precedence.
        let is_foreign = collider.is_some_and(|collider| !is_surface(collider));
        let (mesh, settings, skin, weights, has_shape, collides, wanted, disabled) = shows;
        // A shape collides in place of the mesh.
        let mesh = mesh.filter(|_| collides && wanted && !has_shape);
        let tree = mesh.and_then(|mesh| trees.shown_with(mesh, settings, skin));
        match (surface, tree.filter(|_| !is_foreign)) {
            (None, Some(bvh)) if !disabled => {
                let mut pose = Pose::new(bvh.clone());
                // Bad weights are logged in the surface's first step.
                let _logged_later = take_weights(&mut pose, weights, &shared, &mut rest);
                let Some(layout) = layouts.of(bvh) else { continue };
                let following = Following::new(entity, bvh, pose.weights(), &layout);
                // The collider's body, which Avian determines when it has got the collider and its mass.
                let body = std::iter::once(entity).chain(parents.iter_ancestors(entity));
                if body.filter_map(|entity| bodies.get(entity).ok()).next() == Some(&RigidBody::Dynamic) {
                    following.surface.lock().need_mass();
                }
                let surface = AvianSurface {
                    following,
                    pushing: Pushing::new(layout),
                    bvh: bvh.clone(),
                    touching: HashMap::default(),
                    meets: false,
                    bad_place: None,
                    told_open: false,
                };
                commands.entity(entity).try_insert(surface);
            }
            (None, _) => {}
            (Some(_), None) => remove_surface(commands.entity(entity), collider),
            (Some(surface), Some(bvh)) => {
                if !disabled && !Arc::ptr_eq(&surface.bvh, bvh) {
                    // Also removes its parts; the new surface is added next time.
                    remove_surface(commands.entity(entity), collider);
                }
            }
        }
    }
}

/// Whether a collider is a mesh's surface and not the game's own.
pub(super) fn is_surface(collider: &Collider) -> bool {
    collider.shape().as_shape::<WholeSurface>().is_some()
}

/// Removes a surface. A collider of the game's own stays.
fn remove_surface(mut entity: EntityCommands, collider: Option<&Collider>) {
    entity.try_remove::<AvianSurface>();
    if collider.is_some_and(is_surface) {
        entity.try_remove::<Collider>();
    }
}

/// Removes a surface from physics immediately when [`MorphAvianCollider`] is removed.
pub(super) fn detach_surface(
    removed: On<Remove<MorphAvianCollider>>,
    surfaces: Query<Option<&Collider>, (With<AvianSurface>, Allow<Disabled>)>,
    mut commands: Commands,
) {
    if let Ok(collider) = surfaces.get(removed.entity) {
        remove_surface(commands.entity(removed.entity), collider);
    }
}
