//! Gives meshes their surface in physics, and removes it.

use std::sync::Arc;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::plugin::context::RapierContextEntityLink;
use bevy_rapier3d::prelude::{Collider, ColliderDisabled, RapierColliderHandle};
use bevy_rapier3d::rapier::geometry::{Collider as RapierCollider, ColliderHandle, ColliderSet};
use morph_collision::{MorphBvh, Pose};

use super::MorphRapierCollider;
use super::push::Pushing;
use super::step::{Contexts, world};
use crate::components::{MorphCollider, MorphShape, MorphTreeOptions};
use crate::import::MorphTrees;
use crate::physics::follow::Following;
use crate::physics::layout::MeshLayouts;
use crate::physics::surface::MorphSurface;
use crate::physics::teleport::PhysicsSurface;
use crate::posing::take_weights;

/// The plugin's state of one surface.
#[derive(Component)]
pub(crate) struct RapierSurface {
    pub(super) following: Following,
    pub(super) pushing: Pushing,
    bvh: Arc<MorphBvh>,
    /// The physics world that contains the surface.
    pub(super) context: Option<Entity>,
    /// Whether the plugin has switched its collider off. Also true for a new surface, whose collider may have belonged to
    /// another.
    off: bool,
    /// Why its position or size keeps it out of physics, so that this is logged once.
    pub(super) bad_place: Option<String>,
    /// Whether the log already says that it should be closed but is not.
    pub(super) told_open: bool,
}

impl RapierSurface {
    /// Switches the collider on or off. `ColliderDisabled` takes precedence.
    pub(super) fn switch(
        &mut self,
        off: bool,
        collider_disabled: bool,
        colliders: &mut ColliderSet,
        handle: ColliderHandle,
    ) {
        if off {
            // Movement of the surface while it is off does not count as motion.
            self.following.restart();
        }
        // Removing `ColliderDisabled` enables the collider even if something else keeps it off.
        let slipped = off && colliders.get(handle).is_some_and(RapierCollider::is_enabled);
        if (slipped || off != self.off)
            && let Some(collider) = colliders.get_mut(handle)
        {
            collider.set_enabled(!off && !collider_disabled);
        }
        self.off = off;
    }
}

impl PhysicsSurface for RapierSurface {
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
    Has<MorphRapierCollider>,
    Has<Disabled>,
);

/// Adds a surface to colliders whose mesh has a tree. Removes it when the collider, the mesh or its tree is gone.
///
/// It reads [`MorphTrees`] directly, so physics continues while collision detection is paused.
pub(super) fn attach_surfaces(
    mut commands: Commands,
    mut colliders: Query<
        (
            Entity,
            Shows,
            Option<&RapierSurface>,
            Option<&mut Collider>,
            Option<&RapierContextEntityLink>,
        ),
        (Allow<Disabled>, Or<(With<MorphRapierCollider>, With<RapierSurface>)>),
    >,
    shared: Query<&MorphWeights>,
    trees: Option<Res<MorphTrees>>,
    layouts: Res<MeshLayouts>,
    mut rest: Local<Vec<f32>>,
) {
    let Some(trees) = trees else { return };
    for (entity, shows, surface, mut collider, context) in &mut colliders {
        // The game's own collider takes precedence.
        let is_foreign = collider.as_deref().is_some_and(|collider| !is_surface(collider));
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
                let shape = SharedShape::new(following.surface.clone());
                let surface = RapierSurface {
                    following,
                    pushing: Pushing::new(entity, layout),
                    bvh: bvh.clone(),
                    context: None,
                    off: true,
                    bad_place: None,
                    told_open: false,
                };
                commands.entity(entity).try_insert((Collider::from(shape), surface));
            }
            (None, _) => {}
            (Some(_), None) => remove_surface(commands.entity(entity), collider.as_deref()),
            (Some(surface), Some(bvh)) => {
                let elsewhere = surface.context.is_some() && surface.context != context.map(|link| link.0);
                if !disabled && (elsewhere || collider.is_none() || !Arc::ptr_eq(&surface.bvh, bvh)) {
                    // Also removes its parts; the new surface is added next time.
                    commands.entity(entity).try_remove::<RapierSurface>();
                }
                if surface.following.surface.lock().take_weighed()
                    && let Some(collider) = &mut collider
                {
                    // Makes Rapier's plugin read the mass back.
                    collider.set_changed();
                }
            }
        }
    }
}

/// Whether a collider is a mesh's surface and not the game's own.
fn is_surface(collider: &Collider) -> bool {
    collider.raw.as_shape::<MorphSurface>().is_some()
}

/// Removes a surface permanently. A collider of the game's own stays.
///
/// Its handle is removed too. Otherwise Rapier would keep its internal collider, which a surface may have switched off or taken
/// out of the solver, and use it for the next shape.
fn remove_surface(mut entity: EntityCommands, collider: Option<&Collider>) {
    entity.try_remove::<(RapierSurface, RapierColliderHandle)>();
    if collider.is_some_and(is_surface) {
        entity.try_remove::<Collider>();
    }
}

/// Removes a surface from physics immediately when [`MorphRapierCollider`] is removed.
pub(super) fn detach_surface(
    removed: On<Remove<MorphRapierCollider>>,
    surfaces: Query<Option<&Collider>, (With<RapierSurface>, Allow<Disabled>)>,
    mut commands: Commands,
) {
    if let Ok(collider) = surfaces.get(removed.entity) {
        remove_surface(commands.entity(removed.entity), collider);
    }
}

/// Removes the parts of a surface that is being removed.
pub(super) fn take_parts_along(
    removed: On<Remove<RapierSurface>>,
    mut surfaces: Query<&mut RapierSurface, Allow<Disabled>>,
    mut contexts: Contexts,
) {
    let Ok(mut surface) = surfaces.get_mut(removed.entity) else {
        return;
    };
    let Some(context) = surface.context else { return };
    if let Ok((_, mut simulation, mut colliders, mut joints, mut bodies, ..)) = contexts.get_mut(context) {
        let RapierSurface { following, pushing, .. } = &mut *surface;
        pushing.finish(&following.surface, &mut bodies.bodies, &mut colliders.colliders);
        let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
        pushing.stop(&mut world);
    }
}

/// Takes surfaces out of physics if their entity is disabled or Rapier no longer has a collider for them.
pub(super) fn stop_absent(
    mut surfaces: Query<
        (
            &mut RapierSurface,
            Option<&RapierColliderHandle>,
            Has<Disabled>,
            Has<ColliderDisabled>,
        ),
        (
            Allow<Disabled>,
            Or<(With<Disabled>, Without<RapierColliderHandle>, Without<Collider>)>,
        ),
    >,
    mut contexts: Contexts,
) {
    for (mut surface, handle, disabled, collider_disabled) in &mut surfaces {
        let Some(context) = surface.context else { continue };
        let Ok((_, mut simulation, mut colliders, mut joints, mut bodies, ..)) = contexts.get_mut(context) else {
            continue;
        };
        let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
        if !surface.pushing.is_idle() {
            surface.pushing.stop(&mut world);
        }
        if disabled && let Some(handle) = handle {
            surface.switch(true, collider_disabled, world.colliders, handle.0);
        }
    }
}
