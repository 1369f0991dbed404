//! Counts and times of a run.

use std::time::Duration;

use bevy::prelude::*;
use morph_collision::QueryStats;

use super::stage_times::MorphStageTimes;
use crate::app::MorphCollisionSystems;

/// What the plugin did in its last run. All counts are for that run only.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphCollisionDiagnostics {
    /// Colliders that took part.
    pub colliders: u64,
    /// Colliders that collisions saw in an earlier state because they have moved by at most their
    /// [tolerance](crate::components::MorphCollider::tolerance) since then.
    pub held_colliders: u64,
    /// Pairs of colliders whose world-space bounds overlap. Other pairs are apart and not counted.
    pub overlapping_pairs: u64,
    /// Overlapping pairs that are parts of one body.
    pub skipped_same_body: u64,
    /// Overlapping pairs excluded by [`MorphCollisionLayers`](crate::components::MorphCollisionLayers).
    pub skipped_layers: u64,
    /// Overlapping pairs of [passive](crate::components::MorphCollisionMode::Passive) colliders.
    pub skipped_passive: u64,
    /// Overlapping pairs of two [shapes](crate::components::MorphShape).
    pub skipped_rigid: u64,
    /// Overlapping pairs that [hooks](crate::hooks::MorphCollisionHooks) refuse.
    pub skipped_hooks: u64,
    /// Overlapping pairs that remain: different bodies that may collide.
    pub candidate_pairs: u64,
    /// Candidate pairs that keep their last answer because neither collider changed, or only within its tolerance.
    pub skipped_unchanged: u64,
    /// Pairs that were compared on their way from the last run, because a collider is
    /// [continuous](crate::components::MorphCollider::continuous) and they did not touch then.
    pub swept_pairs: u64,
    /// Swept pairs that took so much work that it was cut short. What is reported about them is on the safe side: they count as touching
    /// ([`MorphImpactFeatures::Undecided`](crate::contacts::MorphImpactFeatures)), or as touching earlier than they do.
    pub limited_pairs: u64,
    /// Pairs of colliders that touched.
    pub touching_pairs: u64,
    /// Triangle pairs listed in [`MorphCollisions`](crate::contacts::MorphCollisions).
    pub triangle_pairs: u64,
    /// Tree nodes of all colliders that took part. Compare `stats.nodes_blended` with this.
    pub nodes_total: u64,
    /// Work done by the broad and narrow phases. Nothing is blended again while weights stay the same.
    #[reflect(ignore)]
    pub stats: QueryStats,
    /// The part of this work that was spent on `swept_pairs`.
    #[reflect(ignore)]
    pub swept_stats: QueryStats,
    /// Time spent in the plugin's systems, without building trees.
    pub duration: Duration,
    /// The same time by stage.
    pub times: MorphStageTimes,
}

impl MorphCollisionDiagnostics {
    /// Adds the time of a system.
    pub(crate) fn spend(&mut self, stage: MorphCollisionSystems, time: Duration) {
        self.duration += time;
        *self.times.of_mut(stage) += time;
    }
}

/// Time spent on updating colliders, scenes and anchors since the last run began. They are updated in every frame, even without a
/// run.
#[derive(Resource, Default)]
pub(crate) struct Preparation {
    pub(crate) import: Duration,
    pub(crate) anchors: Duration,
}

pub(crate) fn begin_run(mut diagnostics: ResMut<MorphCollisionDiagnostics>, mut preparation: ResMut<Preparation>) {
    let Preparation { import, anchors } = std::mem::take(&mut *preparation);
    *diagnostics = MorphCollisionDiagnostics::default();
    diagnostics.spend(MorphCollisionSystems::Import, import);
    diagnostics.spend(MorphCollisionSystems::Anchors, anchors);
}
