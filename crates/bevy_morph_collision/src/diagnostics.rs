//! Counts and times of a run.

use std::time::Duration;

use bevy::prelude::*;
use morph_collision::QueryStats;

/// What the plugin did in its last run. All counts are for that run only.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphCollisionDiagnostics {
    /// Colliders that took part.
    pub colliders: u64,
    /// Colliders that collisions saw in an earlier state because they have moved by at most their
    /// [tolerance](crate::MorphCollider::tolerance) since then.
    pub held_colliders: u64,
    /// Pairs of colliders whose world-space bounds overlap. Other pairs are apart and not counted.
    pub overlapping_pairs: u64,
    /// Overlapping pairs that are parts of one body.
    pub skipped_same_body: u64,
    /// Overlapping pairs excluded by [`MorphCollisionLayers`](crate::MorphCollisionLayers).
    pub skipped_layers: u64,
    /// Overlapping pairs of [passive](crate::MorphCollisionMode::Passive) colliders.
    pub skipped_passive: u64,
    /// Overlapping pairs of two [shapes](crate::MorphShape).
    pub skipped_rigid: u64,
    /// Overlapping pairs that remain: different bodies that may collide.
    pub candidate_pairs: u64,
    /// Candidate pairs that keep their last answer because neither collider changed, or only within its tolerance.
    pub skipped_unchanged: u64,
    /// Pairs that were compared on their way from the last run, because a collider is
    /// [continuous](crate::MorphCollider::continuous) and they did not touch then.
    pub swept_pairs: u64,
    /// Swept pairs that took so much work that it was cut short. What is reported about them is on the safe side: they count as touching
    /// ([`MorphFeatures::Undecided`](crate::MorphFeatures)), or as touching earlier than they do.
    pub limited_pairs: u64,
    /// Pairs of colliders that touched.
    pub touching_pairs: u64,
    /// Triangle pairs listed in [`MorphCollisions`](crate::MorphCollisions).
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
}

/// Time spent on updating colliders, scenes and anchors since the last run began. They are updated in every frame, even without a
/// run.
#[derive(Resource, Default)]
pub(crate) struct Preparation(pub(crate) Duration);

pub(crate) fn begin_run(mut diagnostics: ResMut<MorphCollisionDiagnostics>, mut preparation: ResMut<Preparation>) {
    *diagnostics = MorphCollisionDiagnostics {
        duration: std::mem::take(&mut preparation.0),
        ..default()
    };
}

#[cfg(feature = "diagnostics")]
pub use store::MorphCollisionDiagnosticsPlugin;

/// Publishes the same numbers in Bevy's diagnostics.
#[cfg(feature = "diagnostics")]
mod store {
    use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
    use bevy::prelude::*;

    use super::MorphCollisionDiagnostics;

    /// Writes [`MorphCollisionDiagnostics`] to Bevy's `DiagnosticsStore` every frame.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct MorphCollisionDiagnosticsPlugin;

    impl MorphCollisionDiagnosticsPlugin {
        /// Time spent in the plugin's systems, in milliseconds.
        pub const DURATION: DiagnosticPath = DiagnosticPath::const_new("morph_collision/duration");
        /// Candidate pairs.
        pub const CANDIDATE_PAIRS: DiagnosticPath = DiagnosticPath::const_new("morph_collision/candidate_pairs");
        /// Touching pairs.
        pub const TOUCHING_PAIRS: DiagnosticPath = DiagnosticPath::const_new("morph_collision/touching_pairs");
        /// Pairs of continuous colliders whose motion took more work than a frame may take.
        pub const LIMITED_PAIRS: DiagnosticPath = DiagnosticPath::const_new("morph_collision/limited_pairs");
        /// Tree nodes blended.
        pub const NODES_BLENDED: DiagnosticPath = DiagnosticPath::const_new("morph_collision/nodes_blended");
        /// Pairs of triangles compared.
        pub const TRIANGLE_TESTS: DiagnosticPath = DiagnosticPath::const_new("morph_collision/triangle_tests");
    }

    impl Plugin for MorphCollisionDiagnosticsPlugin {
        fn build(&self, app: &mut App) {
            for path in [
                Self::CANDIDATE_PAIRS,
                Self::TOUCHING_PAIRS,
                Self::LIMITED_PAIRS,
                Self::NODES_BLENDED,
                Self::TRIANGLE_TESTS,
            ] {
                app.register_diagnostic(Diagnostic::new(path));
            }
            app.register_diagnostic(Diagnostic::new(Self::DURATION).with_suffix(" ms"))
                .add_systems(Last, store);
        }
    }

    fn store(ours: Option<Res<MorphCollisionDiagnostics>>, mut theirs: Diagnostics) {
        use MorphCollisionDiagnosticsPlugin as Paths;
        let Some(ours) = ours else { return };
        theirs.add_measurement(&Paths::DURATION, || ours.duration.as_secs_f64() * 1e3);
        theirs.add_measurement(&Paths::CANDIDATE_PAIRS, || ours.candidate_pairs as f64);
        theirs.add_measurement(&Paths::TOUCHING_PAIRS, || ours.touching_pairs as f64);
        theirs.add_measurement(&Paths::LIMITED_PAIRS, || ours.limited_pairs as f64);
        theirs.add_measurement(&Paths::NODES_BLENDED, || ours.stats.nodes_blended as f64);
        theirs.add_measurement(&Paths::TRIANGLE_TESTS, || ours.stats.triangle_tests as f64);
    }
}
