//! What this crate keeps for each surface.

use avian3d::collision::contact_types::ContactId;
use avian3d::prelude::RigidBody;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_morph_physics::MorphSurfaceVelocity;
use bevy_morph_physics::engine::PhysicsSurface;

use crate::push::Pushing;

/// The engine.
#[derive(Debug)]
pub struct Avian;

/// A surface in Avian's physics.
pub(crate) type AvianSurface = PhysicsSurface<Avian>;

/// Reads how fast surfaces move, which is the velocity at which they carry bodies; see [`MorphSurfaceVelocity`].
///
/// For character controllers that [`MorphAvianCarry`](crate::MorphAvianCarry) does not fit:
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_avian::prelude::*;
/// use avian3d::prelude::*;
///
/// fn what_carries_me(space: SpatialQuery, mut surfaces: MorphAvianVelocity, players: Query<&Transform, With<Name>>) {
///     for player in &players {
///         let feet = player.translation - Vec3::Y;
///         if let Some(hit) = space.cast_ray(feet, Dir3::NEG_Y, 0.1, true, &SpatialQueryFilter::DEFAULT) {
///             let velocity = surfaces.surface_velocity(hit.entity, feet - Vec3::Y * hit.distance);
///             println!("the ground moves at {velocity:?}");
///         }
///     }
/// }
/// # bevy::ecs::system::assert_is_system(what_carries_me);
/// ```
pub type MorphAvianVelocity<'w, 's> = MorphSurfaceVelocity<'w, 's, Avian>;

/// A collider that touches parts of a surface.
#[derive(Clone, Copy)]
pub(crate) struct Touch {
    pub(crate) body: Option<Entity>,
    /// One of its contacts with parts, which stands for all of them.
    pub(crate) contact: ContactId,
}

/// The state of a surface.
#[allow(missing_debug_implementations)]
pub struct AvianState {
    pub(crate) pushing: Pushing,
    /// The colliders that its parts touch.
    pub(crate) touching: HashMap<Entity, Touch>,
    /// Whether contacts are made with the whole surface. Its collider stores the same.
    pub(crate) has_contacts: bool,
}

impl AvianState {
    pub(crate) fn new(pushing: Pushing) -> Self {
        Self {
            pushing,
            touching: HashMap::default(),
            has_contacts: false,
        }
    }
}

/// Computes the mass of a new surface at once if a dynamic body needs it.
pub(crate) fn need_mass(
    added: On<Add<AvianSurface>>,
    surfaces: Query<&AvianSurface, Allow<Disabled>>,
    bodies: Query<&RigidBody>,
    parents: Query<&ChildOf>,
) {
    // The collider's body, which Avian determines when it has got the collider and its mass.
    let ancestors = std::iter::once(added.entity).chain(parents.iter_ancestors(added.entity));
    let body = ancestors.filter_map(|entity| bodies.get(entity).ok()).next();
    if body == Some(&RigidBody::Dynamic)
        && let Ok(surface) = surfaces.get(added.entity)
    {
        surface.moving.surface.lock().need_mass();
    }
}
