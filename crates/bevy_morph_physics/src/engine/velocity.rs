//! Velocities of surfaces in physics.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use morph_collision::ShapeQuery;

use super::interface::Engine;
use super::surface::PhysicsSurface;
use crate::components::MorphPhysicsCollider;
use crate::moving::MovingSurface;

/// Reads how fast surfaces with a [`MorphPhysicsCollider`] move in an engine, which is the velocity at which they carry bodies.
///
/// The crates of engines have a name for each: `MorphRapierVelocity` and `MorphAvianVelocity`. Use it in your own character
/// controllers: cast a ray or a shape down with the engine's queries, which return the entity and the point that was hit, and ask this
/// parameter. Velocities are those of the engine's last step, in world units per second. They combine morphing, joints and the
/// motion of the entity and its kinematic body. Call it before or after a step, not within. For velocities between rendered frames of any
/// [`MorphCollider`](bevy_morph_collision::components::MorphCollider), use
/// [`MorphSpatialQuery::surface_velocity`](bevy_morph_collision::spatial::MorphSpatialQuery::surface_velocity).
///
/// Systems with this parameter do not run in parallel with each other.
#[derive(SystemParam)]
pub struct MorphSurfaceVelocity<'w, 's, E: Engine> {
    surfaces: Query<'w, 's, &'static mut PhysicsSurface<E>, With<MorphPhysicsCollider>>,
    query: Local<'s, ShapeQuery>,
}

impl<E: Engine> MorphSurfaceVelocity<'_, '_, E> {
    /// The velocity of a point of a surface, given by a triangle, as numbered in the mesh, and barycentric coordinates.
    ///
    /// `None` if the entity has no surface, if the surface was on a dynamic body in the last step (read the velocity of the body instead), or if the
    /// triangle does not exist. Zero while the surface is switched off, and in the first step of a jump (see
    /// [`MorphPhysicsCollider::max_acceleration`]). Costs nine vertices.
    #[must_use]
    pub fn velocity_at(&mut self, surface: Entity, triangle: u32, barycentrics: Vec3) -> Option<Vec3> {
        let (moving, _) = self.moving(surface)?;
        moving.velocity_in(triangle, barycentrics)
    }

    /// The velocity of a surface at its point closest to `point`, which is in world space. `None` in the cases of
    /// [`velocity_at`](Self::velocity_at), and if the point is not finite.
    #[must_use]
    pub fn surface_velocity(&mut self, surface: Entity, point: Vec3) -> Option<Vec3> {
        let (moving, query) = self.moving(surface)?;
        moving.velocity_near(point, query)
    }

    fn moving(&mut self, surface: Entity) -> Option<(&mut MovingSurface, &mut ShapeQuery)> {
        let surface = self.surfaces.get_mut(surface).ok()?.into_inner();
        (!surface.moving.on_dynamic).then_some((&mut surface.moving, &mut self.query))
    }
}
