//! Totals of a run.

use std::fmt;
use std::time::Duration;

use bevy_morph_collision::state::MorphCollisionDiagnostics;
use serde::Serialize;

use crate::instances::Instances;
use crate::touching::Changes;

/// Totals over all frames of a run.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// Number of frames.
    pub frames: usize,
    /// Instances of the model.
    pub bodies: usize,
    /// Triangles of each.
    pub triangles_per_body: usize,
    /// Morph targets.
    pub targets: usize,
    /// How often two bodies started touching.
    pub events_started: u64,
    /// How often two bodies stopped touching.
    pub events_ended: u64,
    /// Intersecting pairs of triangles.
    pub triangle_pairs: u64,
    /// Touching pairs of bodies.
    pub body_pairs: u64,
    /// Nodes of all bodies' trees.
    pub nodes_total: u64,
    /// Nodes that were refitted.
    pub nodes_blended: u64,
    /// Exact tests of two triangles.
    pub triangle_tests: u64,
    /// Time taken by the plugin.
    pub us_per_frame: Times,
    #[serde(skip)]
    durations: Vec<Duration>,
}

/// Microseconds per frame.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Times {
    /// Half of the frames took less.
    pub median: f64,
    /// The average.
    pub mean: f64,
    /// The longest frame.
    pub worst: f64,
}

impl Report {
    /// A report without any frames yet.
    #[must_use]
    pub fn of(instances: &Instances) -> Self {
        Self {
            bodies: instances.roots.len(),
            triangles_per_body: instances.triangles,
            targets: instances.targets,
            ..Self::default()
        }
    }

    /// Counts one frame.
    pub fn add(&mut self, diagnostics: &MorphCollisionDiagnostics, changes: &Changes, body_pairs: usize) {
        self.frames += 1;
        self.events_started += changes.started.len() as u64;
        self.events_ended += changes.ended.len() as u64;
        self.triangle_pairs += diagnostics.triangle_pairs;
        self.body_pairs += body_pairs as u64;
        self.nodes_total += diagnostics.nodes_total;
        self.nodes_blended += diagnostics.stats.nodes_blended;
        self.triangle_tests += diagnostics.stats.triangle_tests;
        self.durations.push(diagnostics.duration);
    }

    /// Computes the times from the counted frames.
    pub fn finish(&mut self) {
        let mut times: Vec<f64> = self.durations.iter().map(|d| d.as_secs_f64() * 1e6).collect();
        times.sort_by(f64::total_cmp);
        if let Some(&worst) = times.last() {
            let (low, high) = (times[(times.len() - 1) / 2], times[times.len() / 2]);
            let mean = times.iter().sum::<f64>() / times.len() as f64;
            let tenths = |us: f64| (us * 10.0).round() / 10.0;
            self.us_per_frame = Times {
                median: tenths(f64::midpoint(low, high)),
                mean: tenths(mean),
                worst: tenths(worst),
            };
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.nodes_blended as f64 / self.nodes_total.max(1) as f64;
        let Times { median, mean, worst } = self.us_per_frame;
        writeln!(
            f,
            "{} frames, {} bodies of {} triangles and {} morph targets",
            self.frames, self.bodies, self.triangles_per_body, self.targets
        )?;
        writeln!(
            f,
            "  collisions     {} started, {} ended",
            self.events_started, self.events_ended
        )?;
        writeln!(f, "  intersecting   {} triangle pairs", self.triangle_pairs)?;
        writeln!(
            f,
            "  refitted       {} of {} nodes ({share:.2} %)",
            self.nodes_blended, self.nodes_total
        )?;
        writeln!(f, "  exact tests    {} triangle pairs", self.triangle_tests)?;
        write!(
            f,
            "  per frame      {median:.1} us median, {mean:.1} us mean, {worst:.1} us worst"
        )
    }
}
