//! What the frames of a crowd cost.

use std::fmt;
use std::time::Duration;

use bevy_morph_collision::state::MorphCollisionDiagnostics;
use serde::Serialize;

/// Median costs of frames.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Report {
    /// Number of bodies.
    pub instances: usize,
    /// In world units.
    pub tolerance: f32,
    /// Nothing moves.
    pub idle: Cost,
    /// All move, apart from each other.
    pub apart: Cost,
    /// All move, in a dense crowd.
    pub dense: Cost,
}

/// What a frame of a crowd costs.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cost {
    /// The whole of `App::update`, in microseconds.
    pub frame_us: f64,
    /// Only the plugin's systems, in microseconds.
    pub plugin_us: f64,
    /// Bodies that touch.
    pub pairs: u64,
    /// Colliders that had moved by no more than the tolerance.
    pub held: u64,
}

/// The costs of frames, one by one.
#[derive(Clone, Debug, Default)]
pub struct Costs([Vec<f64>; 4]);

impl Costs {
    /// Adds a frame that took this long.
    pub fn add(&mut self, took: Duration, diagnostics: &MorphCollisionDiagnostics) {
        let costs = [
            took.as_secs_f64() * 1e6,
            diagnostics.duration.as_secs_f64() * 1e6,
            diagnostics.touching_pairs as f64,
            diagnostics.held_colliders as f64,
        ];
        for (all, cost) in self.0.iter_mut().zip(costs) {
            all.push(cost);
        }
    }

    /// Their medians.
    #[must_use]
    pub fn medians(self) -> Cost {
        let [frame_us, plugin_us, pairs, held] = self.0.map(median);
        Cost {
            frame_us,
            plugin_us,
            pairs: pairs as u64,
            held: held as u64,
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} morphing bodies, tolerance {}; medians per frame",
            self.instances, self.tolerance
        )?;
        writeln!(
            f,
            "{:8} {:>12} {:>12} {:>10} {:>10}",
            "", "frame, us", "plugin, us", "touching", "held"
        )?;
        for (name, cost) in [("idle", &self.idle), ("apart", &self.apart), ("dense", &self.dense)] {
            writeln!(
                f,
                "{name:8} {:12.0} {:12.1} {:10} {:10}",
                cost.frame_us, cost.plugin_us, cost.pairs, cost.held
            )?;
        }
        write!(
            f,
            "idle takes {:.2} % of dense",
            100.0 * self.idle.plugin_us / self.dense.plugin_us
        )
    }
}
