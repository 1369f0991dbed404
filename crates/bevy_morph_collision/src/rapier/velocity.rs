//! Velocities of surfaces in physics.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierRigidBodySet};
use bevy_rapier3d::prelude::RapierColliderHandle;
use bevy_rapier3d::rapier::dynamics::RigidBody;
use morph_collision::ShapeQuery;

use super::MorphRapierCollider;
use super::attach::RapierSurface;
use crate::physics::follow::Following;

/// Reads how fast surfaces with a [`MorphRapierCollider`] move, which is the velocity at which they carry bodies.
///
/// Use it in your own character controllers: cast a ray or a shape down with Rapier, which returns the entity and, as sub-shape,
/// the triangle that was hit. Then ask this parameter. Velocities are those of Rapier's last step, in world units per second.
/// They combine morphing, joints and the motion of the entity and its kinematic body. Call it before
/// [`PhysicsSet::SyncBackend`](bevy_rapier3d::plugin::PhysicsSet::SyncBackend) or after
/// [`PhysicsSet::Writeback`](bevy_rapier3d::plugin::PhysicsSet::Writeback). For velocities between rendered frames of any
/// [`MorphCollider`](crate::components::MorphCollider), use
/// [`MorphSpatialQuery::surface_velocity`](crate::MorphSpatialQuery::surface_velocity).
///
/// Systems with this parameter do not run in parallel with each other.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
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
#[derive(SystemParam)]
pub struct MorphRapierVelocity<'w, 's> {
    surfaces: Query<'w, 's, (&'static mut RapierSurface, &'static RapierColliderHandle), With<MorphRapierCollider>>,
    contexts: Query<'w, 's, (&'static RapierContextColliders, &'static RapierRigidBodySet)>,
    query: Local<'s, ShapeQuery>,
}

impl std::fmt::Debug for MorphRapierVelocity<'_, '_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MorphRapierVelocity").finish_non_exhaustive()
    }
}

impl MorphRapierVelocity<'_, '_> {
    /// The velocity of a point of a surface, given by a triangle, as numbered in the mesh, and barycentric coordinates.
    ///
    /// `None` if the entity has no surface, if the surface is on a dynamic body (ask the body instead), or if the triangle does
    /// not exist. Zero while the surface is switched off, and in the first step of a jump (see
    /// [`MorphRapierCollider::max_acceleration`]). Costs nine vertices.
    #[must_use]
    pub fn velocity_at(&mut self, surface: Entity, triangle: u32, barycentrics: Vec3) -> Option<Vec3> {
        let (following, _) = self.following(surface)?;
        following.velocity_in(triangle, barycentrics)
    }

    /// The velocity of a surface at its point closest to `point`, which is in world space. `None` in the cases of
    /// [`velocity_at`](Self::velocity_at), and if the point is not finite.
    #[must_use]
    pub fn surface_velocity(&mut self, surface: Entity, point: Vec3) -> Option<Vec3> {
        let (following, query) = self.following(surface)?;
        following.velocity_near(point, query)
    }

    fn following(&mut self, surface: Entity) -> Option<(&mut Following, &mut ShapeQuery)> {
        let (surface, handle) = self.surfaces.get_mut(surface).ok()?;
        let (colliders, bodies) = self.contexts.get(surface.context?).ok()?;
        let body = colliders.colliders.get(handle.0)?.parent();
        let body = body.and_then(|body| bodies.bodies.get(body));
        if body.is_some_and(RigidBody::is_dynamic) {
            return None;
        }
        let following = &mut surface.into_inner().following;
        Some((following, &mut self.query))
    }
}
