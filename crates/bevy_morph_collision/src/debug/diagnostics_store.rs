//! Publishes the counts of a run in Bevy's diagnostics.

use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;

use crate::state::MorphCollisionDiagnostics;

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
