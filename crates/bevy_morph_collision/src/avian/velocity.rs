//! Velocities of surfaces in physics.

use avian3d::prelude::{ColliderOf, RigidBody};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use morph_collision::ShapeQuery;

use super::MorphAvianCollider;
use super::attach::AvianSurface;
use crate::physics::follow::Following;

/// Reads how fast surfaces with a [`MorphAvianCollider`] move, which is the velocity at which they carry bodies.
///
/// For character controllers that [`MorphAvianCarry`](super::MorphAvianCarry) does not fit: cast a ray or a shape with Avian's
/// `SpatialQuery`, which returns the entity and the point that was hit, and ask this parameter. Velocities are those of Avian's last
/// step, in world units per second.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
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
#[derive(SystemParam)]
pub struct MorphAvianVelocity<'w, 's> {
    surfaces: Query<'w, 's, (&'static mut AvianSurface, Option<&'static ColliderOf>), With<MorphAvianCollider>>,
    bodies: Query<'w, 's, &'static RigidBody>,
    query: Local<'s, ShapeQuery>,
}

impl std::fmt::Debug for MorphAvianVelocity<'_, '_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MorphAvianVelocity").finish_non_exhaustive()
    }
}

impl MorphAvianVelocity<'_, '_> {
    /// The velocity of a point of a surface, given by a triangle, as numbered in the mesh, and barycentric coordinates.
    ///
    /// `None` if the entity has no surface, if the surface is on a dynamic body (ask the body instead), or if the triangle does
    /// not exist. Zero while the surface is switched off, and in the first step of a jump (see
    /// [`MorphAvianCollider::max_acceleration`]).
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
        let (surface, of) = self.surfaces.get_mut(surface).ok()?;
        let body = of.and_then(|of| self.bodies.get(of.body).ok());
        if body == Some(&RigidBody::Dynamic) {
            return None;
        }
        Some((&mut surface.into_inner().following, &mut self.query))
    }
}
