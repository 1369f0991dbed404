//! Velocities of surfaces.

use bevy::math::DVec3;
use bevy::prelude::*;

use super::{MorphProjection, MorphRayHit, MorphSpatialQuery};

impl MorphSpatialQuery<'_, '_> {
    /// The velocity of a point of a collider's surface, in world units per second, from morph targets, joints and the entity's
    /// own motion together.
    ///
    /// It is the distance that the point moved between the plugin's last two runs, divided by the time between them ([`Time`] of
    /// the plugin's schedule). Teleporting counts as motion. While collision detection is paused, the velocity stays that of the
    /// last run. `None` if the collider or triangle does not exist, if the collider took no part in the run before or had another
    /// mesh then, or if no time has passed.
    ///
    /// Costs six vertices, three of them blended again with each call. Without any calls, it costs one copy of each collider's
    /// weights per run.
    #[must_use]
    pub fn surface_velocity(&self, collider: Entity, triangle: u32, barycentrics: Vec3) -> Option<Vec3> {
        let seconds = self.times.as_ref()?.between?.as_secs_f64();
        let before = &self.state(collider)?.previous;
        let (before, now) = self.with_mesh(collider, |mut body| {
            let was_shown = before.shape.is_of(body.pose);
            let world_from_model = before.world_from_model.as_ref().filter(|_| was_shown)?;
            Some((
                before.shape.triangle(triangle, world_from_model)?,
                body.triangle(triangle)?,
            ))
        })?;
        let shares = barycentrics.as_dvec3().to_array();
        let way = (0..3).map(|corner| (now[corner] - before[corner]) * shares[corner]);
        (seconds > 0.0).then(|| (way.sum::<DVec3>() / seconds).as_vec3())
    }
}

impl MorphRayHit {
    /// The velocity of the surface at the hit point, in world units per second; see [`MorphSpatialQuery::surface_velocity`].
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::prelude::*;
    /// fn how_fast(spatial: MorphSpatialQuery) {
    ///     let hit = spatial.cast_ray(Vec3::Y, Dir3::NEG_Y, 10.0, &MorphQueryFilter::default());
    ///     if let Some(velocity) = hit.and_then(|hit| hit.velocity(&spatial)) {
    ///         println!("the surface moves at {} units per second", velocity.length());
    ///     }
    /// }
    /// # App::new().add_systems(Update, how_fast);
    /// ```
    #[must_use]
    pub fn velocity(&self, spatial: &MorphSpatialQuery) -> Option<Vec3> {
        spatial.surface_velocity(self.entity, self.triangle, self.barycentrics)
    }
}

impl MorphProjection {
    /// The velocity of the surface at the closest point, in world units per second; see [`MorphSpatialQuery::surface_velocity`].
    #[must_use]
    pub fn velocity(&self, spatial: &MorphSpatialQuery) -> Option<Vec3> {
        spatial.surface_velocity(self.entity, self.triangle, self.barycentrics)
    }
}
