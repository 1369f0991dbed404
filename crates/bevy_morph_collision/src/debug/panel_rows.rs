//! What the panel says.

use std::time::Duration;

use crate::app::{MorphCollisionSystems, Names};
use crate::state::{MorphCollisionDiagnostics, MorphPairCosts, MorphStageTimes};

/// A part of the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Section {
    Counts,
    Times,
    Pairs,
}

impl Section {
    /// The names and the values of its rows, a line each.
    pub(super) fn columns(
        self,
        diagnostics: &MorphCollisionDiagnostics,
        costs: &MorphPairCosts,
        names: &Names,
    ) -> [String; 2] {
        let rows = match self {
            Self::Counts => counts(diagnostics),
            Self::Times => times(diagnostics),
            Self::Pairs => pairs(costs, names),
        };
        let (names, values): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        [names.join("\n"), values.join("\n")]
    }
}

fn counts(run: &MorphCollisionDiagnostics) -> Vec<(String, String)> {
    let compared = run.candidate_pairs.saturating_sub(run.skipped_unchanged);
    let rows = [
        ("colliders", run.colliders),
        ("pairs with overlapping boxes", run.overlapping_pairs),
        ("pairs compared", compared),
        ("pairs unchanged", run.skipped_unchanged),
        ("pairs touching", run.touching_pairs),
        ("triangle pairs", run.triangle_pairs),
        ("boxes refitted", run.stats.nodes_blended),
        ("triangle tests", run.stats.triangle_tests),
        ("exact tests", run.stats.undecided_by_filter),
    ];
    rows.map(|(name, count)| (name.to_owned(), count.to_string())).into()
}

fn times(run: &MorphCollisionDiagnostics) -> Vec<(String, String)> {
    let milliseconds = |time: Duration| format!("{:.3} ms", time.as_secs_f64() * 1e3);
    let name = |stage| match stage {
        MorphCollisionSystems::Import => "import",
        MorphCollisionSystems::Weights => "weights",
        MorphCollisionSystems::BroadPhase => "broad phase",
        MorphCollisionSystems::NarrowPhase => "narrow phase",
        MorphCollisionSystems::Events => "events",
        MorphCollisionSystems::Casters => "casters",
        MorphCollisionSystems::Anchors => "anchors",
    };
    let stages = MorphStageTimes::STAGES.map(|stage| (name(stage), run.times.of(stage)));
    let rows = stages.into_iter().chain([("all", run.duration)]);
    rows.map(|(name, time)| (name.to_owned(), milliseconds(time))).collect()
}

fn pairs(costs: &MorphPairCosts, names: &Names) -> Vec<(String, String)> {
    let heading = ("costliest pairs".to_owned(), "tests".to_owned());
    let rows = costs.pairs().iter().map(|pair| {
        let [one, other] = [pair.collider1, pair.collider2].map(|collider| names.entity(collider));
        (format!("{one}, {other}"), pair.tests.to_string())
    });
    std::iter::once(heading).chain(rows).collect()
}
