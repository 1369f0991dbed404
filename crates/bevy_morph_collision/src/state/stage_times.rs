//! How long the stages of a run took.

use std::time::Duration;

use bevy::prelude::*;

use crate::app::MorphCollisionSystems;

/// How long each stage of a run took, as in [`MorphCollisionSystems`]. Hooks count as part of the narrow phase.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Debug, Default, Clone, PartialEq)]
pub struct MorphStageTimes {
    /// Finding new colliders, without building trees. All frames since the run before.
    pub import: Duration,
    /// Reading weights and joints.
    pub weights: Duration,
    /// Placing colliders, and finding pairs whose boxes overlap.
    pub broad_phase: Duration,
    /// Finding triangles that intersect, also of meshes with themselves.
    pub narrow_phase: Duration,
    /// Reporting what started and ended.
    pub events: Duration,
    /// Casting rays and shapes of casters.
    pub casters: Duration,
    /// Moving anchored entities. All frames since the run before.
    pub anchors: Duration,
}

impl MorphStageTimes {
    /// The stages, in order.
    pub const STAGES: [MorphCollisionSystems; 7] = [
        MorphCollisionSystems::Import,
        MorphCollisionSystems::Weights,
        MorphCollisionSystems::BroadPhase,
        MorphCollisionSystems::NarrowPhase,
        MorphCollisionSystems::Events,
        MorphCollisionSystems::Casters,
        MorphCollisionSystems::Anchors,
    ];

    /// The time of a stage.
    #[must_use]
    pub fn of(mut self, stage: MorphCollisionSystems) -> Duration {
        *self.of_mut(stage)
    }

    pub(super) fn of_mut(&mut self, stage: MorphCollisionSystems) -> &mut Duration {
        match stage {
            MorphCollisionSystems::Import => &mut self.import,
            MorphCollisionSystems::Weights => &mut self.weights,
            MorphCollisionSystems::BroadPhase => &mut self.broad_phase,
            MorphCollisionSystems::NarrowPhase => &mut self.narrow_phase,
            MorphCollisionSystems::Events => &mut self.events,
            MorphCollisionSystems::Casters => &mut self.casters,
            MorphCollisionSystems::Anchors => &mut self.anchors,
        }
    }
}
