//! What a frame cost, and on what.

use std::time::Duration;

use bevy::prelude::*;
use morph_collision::QueryStats;

/// What the plugin did in its last run. Counts are of that frame alone.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphCollisionDiagnostics {
    /// Colliders that took part.
    pub colliders: u64,
    /// Pairs of colliders of different bodies whose world bounds overlapped.
    pub candidate_pairs: u64,
    /// Pairs of colliders that touched.
    pub touching_pairs: u64,
    /// Triangle pairs listed in [`MorphCollisions`](crate::MorphCollisions).
    pub triangle_pairs: u64,
    /// Tree nodes of all colliders that took part: what `stats.volumes_blended` is a share of.
    pub nodes_total: u64,
    /// What broad and narrow phase had to do. Nothing is blended again while weights stay as they are.
    #[reflect(ignore)]
    pub stats: QueryStats,
    /// Time spent in the plugin's systems, but for building trees.
    pub duration: Duration,
}

pub(crate) fn begin_frame(mut diagnostics: ResMut<MorphCollisionDiagnostics>) {
    *diagnostics = MorphCollisionDiagnostics::default();
}
