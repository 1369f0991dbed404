//! Work and time of frames.

use std::time::Duration;

use bevy::prelude::*;
use bevy_morph_collision::morph_collision::QueryStats;
use bevy_morph_collision::prelude::*;
use serde::Serialize;

/// A kind of work, and how many nanoseconds one of it takes. The numbers were fitted to the times of 24,000 frames. The frames with the most work took about half
/// as long as their counts say. Quiet frames take longer than that: whatever the plugin does in every frame is not counted.
type Unit = (fn(&QueryStats) -> u64, f64);

const UNITS: [Unit; 9] = [
    (|stats| stats.node_tests, 30.0),
    (|stats| stats.triangle_tests, 15.0),
    (|stats| stats.undecided_by_filter, 5_000.0),
    (|stats| stats.feature_tests, 1_300.0),
    (|stats| stats.feature_tests_at_ends, 3_000.0),
    (|stats| stats.exact_feature_tests, 30_000.0),
    (|stats| stats.exact_bits, 0.0),
    (|stats| stats.nodes_blended, 200.0),
    (|stats| stats.vertices_blended, 100.0),
];

/// The most that a frame may take, by its work.
const LIMIT_NS: f64 = 20e6;

/// Frame times are counted in steps of 2 %, so that hours of them take no more memory than a second.
const STEPS_PER_OCTAVE: f64 = 35.0;

/// The work and the times of all frames.
pub(crate) struct Work {
    report: WorkReport,
    estimated_ns: f64,
    measured_ns: f64,
    /// From 1 microsecond.
    times: [u64; 1024],
}

/// What is printed of it.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct WorkReport {
    /// The most work of a frame, in milliseconds.
    pub(crate) largest_ms: f64,
    /// The frame with the most work.
    pub(crate) at_frame: u64,
    /// Its counts.
    pub(crate) triangle_tests: u64,
    pub(crate) node_tests: u64,
    pub(crate) nodes_blended: u64,
    pub(crate) feature_tests: u64,
    pub(crate) undecided_by_filter: u64,
    pub(crate) exact_feature_tests: u64,
    /// The most pairs of triangles listed in a frame.
    pub(crate) most_triangle_pairs: u64,
    /// The time that the plugin took, as a share of that of its work.
    pub(crate) measured_share: f64,
    /// Times of whole frames, in milliseconds. They depend on what else the machine does, so they are not checked.
    pub(crate) mean_frame_ms: f64,
    pub(crate) frame_ms_99_9: f64,
    pub(crate) longest_frame_ms: f64,
}

impl Default for Work {
    fn default() -> Self {
        Self {
            report: WorkReport::default(),
            estimated_ns: 0.0,
            measured_ns: 0.0,
            times: [0; 1024],
        }
    }
}

impl Work {
    /// Counts a frame.
    pub(crate) fn add(&mut self, world: &World, took: Duration, frame: u64) -> Result<(), String> {
        let diagnostics = world.resource::<MorphCollisionDiagnostics>();
        let stats = &diagnostics.stats;
        let ns: f64 = UNITS.iter().map(|(count, ns)| count(stats) as f64 * ns).sum();
        self.estimated_ns += ns;
        self.measured_ns += diagnostics.duration.as_nanos() as f64;
        let report = &mut self.report;
        report.most_triangle_pairs = report.most_triangle_pairs.max(diagnostics.triangle_pairs);
        if ns > 1e6 * report.largest_ms {
            report.largest_ms = ns / 1e6;
            report.at_frame = frame;
            report.triangle_tests = stats.triangle_tests;
            report.node_tests = stats.node_tests;
            report.nodes_blended = stats.nodes_blended;
            report.feature_tests = stats.feature_tests;
            report.undecided_by_filter = stats.undecided_by_filter;
            report.exact_feature_tests = stats.exact_feature_tests;
        }
        let ms = took.as_secs_f64() * 1e3;
        report.longest_frame_ms = report.longest_frame_ms.max(ms);
        report.mean_frame_ms += ms;
        let step = ((1e3 * ms).log2() * STEPS_PER_OCTAVE) as usize;
        self.times[step.min(1023)] += 1;
        match ns > LIMIT_NS {
            true => Err(format!("{:.1} ms by its work: {stats:?}", ns / 1e6)),
            false => Ok(()),
        }
    }

    pub(crate) fn report(&self) -> WorkReport {
        let frames: u64 = self.times.iter().sum();
        let mut above = frames / 1000;
        let step = self.times.iter().rposition(|&count| {
            let is_here = count > above;
            above = above.saturating_sub(count);
            is_here
        });
        let us = ((step.unwrap_or_default() + 1) as f64 / STEPS_PER_OCTAVE).exp2();
        let hundredths = |x: f64| (x * 1e2).round() / 1e2;
        WorkReport {
            largest_ms: hundredths(self.report.largest_ms),
            measured_share: hundredths(self.measured_ns / self.estimated_ns.max(1.0)),
            mean_frame_ms: (1e3 * self.report.mean_frame_ms / frames.max(1) as f64).round() / 1e3,
            frame_ms_99_9: hundredths(us / 1e3),
            longest_frame_ms: hundredths(self.report.longest_frame_ms),
            ..self.report.clone()
        }
    }
}
