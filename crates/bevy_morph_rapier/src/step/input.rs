//! The components of surfaces, and the clocks of physics.

use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_morph_collision::components::MorphColliderDisabled;
use bevy_morph_physics::MorphPhysicsCollider;
use bevy_morph_physics::time::{InFixedLoop, SurfaceComponents};
use bevy_rapier3d::plugin::context::{RapierContextEntityLink, SimulationToRenderTime};
use bevy_rapier3d::plugin::{RapierConfiguration, TimestepMode};
use bevy_rapier3d::prelude::{ColliderDisabled, RapierColliderHandle, SolverGroups};

use crate::surface::RapierSurface;
use crate::timestep::{is_between_steps, time_ahead};

/// A surface, and Rapier's components on its collider.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Surface {
    pub(super) entity: Entity,
    pub(super) settings: &'static MorphPhysicsCollider,
    pub(super) surface: &'static mut RapierSurface,
    pub(super) handle: &'static RapierColliderHandle,
    pub(super) link: &'static RapierContextEntityLink,
    pub(super) drawn_with: SurfaceComponents,
    pub(super) solver_groups: Option<&'static SolverGroups>,
    pub(super) is_morph_disabled: Has<MorphColliderDisabled>,
    pub(super) is_collider_disabled: Has<ColliderDisabled>,
}

/// The clocks of physics.
#[derive(SystemParam)]
pub(crate) struct Clocks<'w> {
    pub(super) mode: Res<'w, TimestepMode>,
    pub(super) time: Res<'w, Time>,
    pub(super) inside: Res<'w, InFixedLoop>,
}

impl Clocks<'_> {
    /// Whether a physics world steps again, but not in this frame.
    pub(super) fn is_waiting(&self, configuration: &RapierConfiguration, behind: &SimulationToRenderTime) -> bool {
        let dt = time_ahead(&self.mode, &self.time, behind.diff).0;
        configuration.physics_pipeline_active && dt <= 0.0 && is_between_steps(&self.mode, &self.time)
    }
}
