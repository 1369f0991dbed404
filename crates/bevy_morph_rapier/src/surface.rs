//! What this crate keeps for each surface.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_morph_physics::MorphSurfaceVelocity;
use bevy_morph_physics::engine::PhysicsSurface;
use bevy_morph_physics::moving::MovingSurface;
use bevy_rapier3d::plugin::context::RapierContextEntityLink;
use bevy_rapier3d::prelude::{Collider, ColliderDisabled, RapierColliderHandle};
use bevy_rapier3d::rapier::geometry::{Collider as RapierCollider, ColliderHandle, ColliderSet};

use crate::push::{Contexts, Pushing, world};

/// The engine.
#[derive(Debug)]
pub struct Rapier;

/// A surface in Rapier's physics.
pub(crate) type RapierSurface = PhysicsSurface<Rapier>;

/// Reads how fast surfaces move, which is the velocity at which they carry bodies; see [`MorphSurfaceVelocity`].
///
/// Rapier's queries return, as sub-shape, the triangle that was hit. Call it before
/// [`PhysicsSet::SyncBackend`](bevy_rapier3d::plugin::PhysicsSet::SyncBackend) or after
/// [`PhysicsSet::Writeback`](bevy_rapier3d::plugin::PhysicsSet::Writeback).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_rapier::prelude::*;
/// use bevy_rapier3d::prelude::*;
///
/// fn what_carries_me(rapier: ReadRapierContext, mut surfaces: MorphRapierVelocity, players: Query<&Transform, With<Name>>) {
///     let Ok(rapier) = rapier.single() else { return };
///     for player in &players {
///         let feet = player.translation - Vec3::Y;
///         if let Some((ground, distance)) = rapier.cast_ray(feet, -Vec3::Y, 0.1, true, QueryFilter::default()) {
///             let velocity = surfaces.surface_velocity(ground, feet - Vec3::Y * distance);
///             println!("the ground moves at {velocity:?}");
///         }
///     }
/// }
/// # bevy::ecs::system::assert_is_system(what_carries_me);
/// ```
pub type MorphRapierVelocity<'w, 's> = MorphSurfaceVelocity<'w, 's, Rapier>;

/// The state of a surface.
#[allow(missing_debug_implementations)]
pub struct RapierState {
    pub(crate) pushing: Pushing,
    /// The physics world that contains the surface.
    pub(crate) context: Option<Entity>,
    /// Whether the plugin has switched its collider off. Also true for a new surface, whose collider may have belonged to
    /// another.
    off: bool,
}

impl RapierState {
    pub(crate) fn new(pushing: Pushing) -> Self {
        Self {
            pushing,
            context: None,
            off: true,
        }
    }

    /// Switches the collider on or off. `ColliderDisabled` takes precedence.
    pub(crate) fn switch(
        &mut self,
        off: bool,
        moving: &mut MovingSurface,
        is_collider_disabled: bool,
        colliders: &mut ColliderSet,
        handle: ColliderHandle,
    ) {
        if off {
            // Movement of the surface while it is off does not count as motion.
            moving.restart();
        }
        // Removing `ColliderDisabled` enables the collider even if something else keeps it off.
        let slipped = off && colliders.get(handle).is_some_and(RapierCollider::is_enabled);
        if (slipped || off != self.off)
            && let Some(collider) = colliders.get_mut(handle)
        {
            collider.set_enabled(!off && !is_collider_disabled);
        }
        self.off = off;
    }
}

/// Starts again with surfaces whose collider is gone or in another physics world, and makes Rapier's plugin read masses that have become
/// known.
pub(crate) fn refresh_surfaces(
    mut commands: Commands,
    mut surfaces: Query<(
        Entity,
        &RapierSurface,
        Option<&mut Collider>,
        Option<&RapierContextEntityLink>,
    )>,
) {
    for (entity, surface, collider, context) in &mut surfaces {
        let home = surface.state.context;
        if collider.is_none() || (home.is_some() && home != context.map(|link| link.0)) {
            // Also removes its parts; the new surface is added next time.
            commands.entity(entity).try_remove::<RapierSurface>();
        }
        if surface.moving.surface.lock().take_mass_changed()
            && let Some(mut collider) = collider
        {
            collider.set_changed();
        }
    }
}

/// Removes the parts of a surface that is being removed.
pub(crate) fn remove_parts(
    removed: On<Remove<RapierSurface>>,
    mut surfaces: Query<&mut RapierSurface, Allow<Disabled>>,
    mut contexts: Contexts,
) {
    let Ok(mut surface) = surfaces.get_mut(removed.entity) else {
        return;
    };
    let Some(context) = surface.state.context else { return };
    if let Ok((_, mut simulation, mut colliders, mut joints, mut bodies, ..)) = contexts.get_mut(context) {
        let RapierSurface { moving, state, .. } = &mut *surface;
        state
            .pushing
            .finish(&moving.surface, &mut bodies.bodies, &mut colliders.colliders);
        let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
        state.pushing.stop(&mut world);
    }
}

/// Takes surfaces out of physics if their entity is disabled or Rapier no longer has a collider for them.
pub(crate) fn stop_absent(
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
        let Some(context) = surface.state.context else { continue };
        let Ok((_, mut simulation, mut colliders, mut joints, mut bodies, ..)) = contexts.get_mut(context) else {
            continue;
        };
        let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
        let RapierSurface { moving, state, .. } = &mut *surface;
        if !state.pushing.is_idle() {
            state.pushing.stop(&mut world);
        }
        if disabled && let Some(handle) = handle {
            state.switch(true, moving, collider_disabled, world.colliders, handle.0);
        }
    }
}
