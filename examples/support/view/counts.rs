//! What a show counts in a frame, for the panel and for a page.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

/// A name and a value in each line.
pub(super) type Lines = Vec<(&'static str, String)>;

/// Work done and skipped in this frame: the same on every machine.
pub(super) fn work(diagnostics: &MorphCollisionDiagnostics) -> Lines {
    let stats = &diagnostics.stats;
    let share = 100.0 * stats.nodes_blended as f64 / diagnostics.nodes_total.max(1) as f64;
    let skipped = [
        diagnostics.skipped_same_body,
        diagnostics.skipped_layers,
        diagnostics.skipped_passive,
        diagnostics.skipped_hooks,
        diagnostics.skipped_rigid,
    ];
    vec![
        ("colliders", diagnostics.colliders.to_string()),
        ("boxes overlap", format!("{} pairs", diagnostics.overlapping_pairs)),
        ("skipped by rule", format!("{} pairs", skipped.iter().sum::<u64>())),
        ("skipped, unchanged", format!("{} pairs", diagnostics.skipped_unchanged)),
        ("touching", format!("{} pairs", diagnostics.touching_pairs)),
        (
            "nodes refitted",
            format!("{} of {} ({share:.1} %)", stats.nodes_blended, diagnostics.nodes_total),
        ),
        ("vertices blended", stats.vertices_blended.to_string()),
        ("exact tests", stats.triangle_tests.to_string()),
        ("touching triangles", format!("{} pairs", diagnostics.triangle_pairs)),
    ]
}

/// How long the plugin's part of the frame took, and the whole frame.
pub(super) fn times(diagnostics: &MorphCollisionDiagnostics, real: &Time<Real>) -> Lines {
    let (collision, frame) = (diagnostics.duration.as_secs_f64(), real.delta_secs_f64());
    vec![
        ("collision time", format!("{:.2} ms", 1e3 * collision)),
        ("frame time", format!("{:.1} ms", 1e3 * frame)),
    ]
}
