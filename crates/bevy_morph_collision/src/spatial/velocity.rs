//! How fast surfaces move.

use bevy::math::DVec3;
use bevy::prelude::*;

use super::query::body;
use super::{MorphProjection, MorphRayHit, MorphSpatialQuery};

impl MorphSpatialQuery<'_, '_> {
    /// The velocity of a point of a collider's surface, in world units per second: what morph targets, joints and the entity's own motion add up
    /// to.
    ///
    /// The distance that the point moved between the plugin's last two runs, divided by the time between them
    /// ([`Time`] of the schedule that the plugin runs in). Teleporting counts as motion. While collisions are paused, it stays that of the last run. `None` if there is no such
    /// collider or triangle, if it took no part in the run before or had another mesh then, or if no time has passed.
    ///
    /// Costs six vertices, three of them blended anew with each call. Where nobody asks, it costs a copy of each collider's weights per run.
    #[must_use]
    pub fn surface_velocity(&mut self, collider: Entity, triangle: u32, barycentrics: Vec3) -> Option<Vec3> {
        let seconds = self.times.as_ref()?.between?.as_secs_f64();
        let (_, mut state) = self.colliders.get_mut(collider).ok()?;
        let before = state.before.place.as_ref()?;
        let same_mesh = state.pose.as_ref().is_some_and(|pose| state.before.shape.is_of(pose));
        let before = state.before.shape.triangle(triangle, before).filter(|_| same_mesh)?;
        let now = body(&mut state)?.triangle(triangle)?;
        let shares = barycentrics.as_dvec3().to_array();
        let way = (0..3).map(|corner| (now[corner] - before[corner]) * shares[corner]);
        (seconds > 0.0).then(|| (way.sum::<DVec3>() / seconds).as_vec3())
    }
}

impl MorphRayHit {
    /// The velocity of the surface where the ray hit it, in world units per second; see [`MorphSpatialQuery::surface_velocity`].
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::prelude::*;
    /// fn how_fast(mut spatial: MorphSpatialQuery) -> Result {
    ///     let hit = spatial.cast_ray(Vec3::Y, Dir3::NEG_Y, 10.0, &MorphQueryFilter::default())?;
    ///     if let Some(velocity) = hit.and_then(|hit| hit.velocity(&mut spatial)) {
    ///         println!("the surface moves at {} units per second", velocity.length());
    ///     }
    ///     Ok(())
    /// }
    /// # App::new().add_systems(Update, how_fast);
    /// ```
    #[must_use]
    pub fn velocity(&self, spatial: &mut MorphSpatialQuery) -> Option<Vec3> {
        spatial.surface_velocity(self.entity, self.triangle, self.barycentrics)
    }
}

impl MorphProjection {
    /// The velocity of the surface at the closest point, in world units per second; see [`MorphSpatialQuery::surface_velocity`].
    #[must_use]
    pub fn velocity(&self, spatial: &mut MorphSpatialQuery) -> Option<Vec3> {
        spatial.surface_velocity(self.entity, self.triangle, self.barycentrics)
    }
}
