//! Times as JSON and as tables.

use std::fmt::Write;

use morph_collision::Kernel;
use morph_collision_models::text::Printable;
use morph_collision_models::text::number;
use morph_collision_testkit::bench::{Entrant, Row};
use morph_collision_testkit::machine;
use serde::Serialize;

use super::{Measured, Mode};

/// The JSON of `bench`.
#[derive(Debug, Serialize)]
pub(super) struct BenchReport {
    cpu: String,
    /// The vector instructions that morph uses.
    kernel: &'static str,
    rounds: usize,
    scenes: Vec<SceneReport>,
}

#[derive(Debug, Serialize)]
struct SceneReport {
    name: String,
    mode: &'static str,
    bodies: usize,
    /// Per body.
    triangles: usize,
    /// Number of frames.
    steps: usize,
    methods: Vec<MethodReport>,
}

/// Times are microseconds per frame.
#[derive(Debug, Serialize)]
struct MethodReport {
    name: String,
    #[serde(serialize_with = "number")]
    blend_us: f64,
    #[serde(serialize_with = "number")]
    refit_us: f64,
    #[serde(serialize_with = "number")]
    query_us: f64,
    #[serde(serialize_with = "number")]
    total_us: f64,
    /// Sum over all frames. In mode `first` it counts touching pairs of bodies; for rays it counts
    /// rays that hit.
    pairs: u64,
    /// Total time divided by morph's.
    #[serde(serialize_with = "number")]
    ratio: f64,
}

impl MethodReport {
    fn new(row: &Row) -> Self {
        let parts = row.parts.unwrap_or_default();
        let micros = |seconds: f64| seconds * 1e6;
        Self {
            name: row.name.clone(),
            blend_us: micros(parts.blend),
            refit_us: micros(parts.refit),
            query_us: micros(parts.query),
            total_us: micros(row.time),
            pairs: row.pairs(),
            ratio: row.ratio,
        }
    }

    fn is_floor(&self) -> bool {
        Entrant::ALL
            .iter()
            .any(|entrant| entrant.name == self.name && entrant.is_floor())
    }
}

impl BenchReport {
    pub(super) fn new(measured: &[Measured<'_>], rounds: usize) -> Self {
        let scene = |measured: &Measured<'_>| SceneReport {
            name: measured.scene.experiment.name.clone(),
            mode: match measured.mode {
                _ if !measured.scene.experiment.rays.is_empty() => "rays",
                Mode::All => "all",
                Mode::First => "first",
            },
            bodies: measured.scene.experiment.bodies,
            triangles: measured.scene.experiment.mesh.triangles.len(),
            steps: measured.scene.experiment.frames.len(),
            methods: measured.rows.iter().map(MethodReport::new).collect(),
        };
        Self {
            cpu: machine::cpu(),
            kernel: Kernel::default().name(),
            rounds,
            scenes: measured.iter().map(scene).collect(),
        }
    }

    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, text: &mut String) -> std::fmt::Result {
        writeln!(
            text,
            "{}, {} kernel; microseconds per frame, medians of {} rounds",
            self.cpu, self.kernel, self.rounds
        )?;
        for scene in &self.scenes {
            scene.write_text(text)?;
        }
        Ok(())
    }
}

impl SceneReport {
    fn write_text(&self, text: &mut String) -> std::fmt::Result {
        let pairs = self.methods.first().map_or(0, |morph| morph.pairs);
        let what = match self.mode {
            "all" => "pairs of triangles",
            "rays" => "rays that hit",
            _ => "touching pairs of bodies",
        };
        writeln!(
            text,
            "\n{}, {}: {} bodies of {} triangles, {} frames, {pairs} {what}",
            Printable(&self.name),
            self.mode,
            self.bodies,
            self.triangles,
            self.steps
        )?;
        writeln!(
            text,
            "{:14} {:>10} {:>10} {:>10} {:>10} {:>8}",
            "method", "blend", "refit", "query", "total", "/ morph"
        )?;
        for row in &self.methods {
            writeln!(
                text,
                "{:14} {:10.1} {:10.1} {:10.1} {:10.1} {:8.2}",
                row.name, row.blend_us, row.refit_us, row.query_us, row.total_us, row.ratio
            )?;
        }
        for row in self.methods.iter().skip(1) {
            if row.is_floor() {
                writeln!(
                    text,
                    "the same bodies without morphing would take {:.2} of the time",
                    row.ratio
                )?;
            } else if row.ratio < 1.0 {
                writeln!(text, "morph is slower than {} here: {:.2}", row.name, row.ratio)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_are_told_in_words_but_the_floor_is_no_rival() {
        let method = |name: &str, ratio: f64| MethodReport {
            name: name.to_owned(),
            blend_us: 1.0,
            refit_us: 2.0,
            query_us: 3.0,
            total_us: 6.0,
            pairs: 4,
            ratio,
        };
        let report = BenchReport {
            cpu: "a processor".to_owned(),
            kernel: "scalar",
            rounds: 5,
            scenes: vec![SceneReport {
                name: "s".to_owned(),
                mode: "all",
                bodies: 2,
                triangles: 3,
                steps: 1,
                methods: vec![
                    method("morph", 1.0),
                    method("rigid-floor", 0.5),
                    method("hybrid", 0.94),
                    method("bottom-up", 7.0),
                ],
            }],
        };
        let text = report.text();
        assert!(text.contains("morph is slower than hybrid here: 0.94\n"), "{text}");
        assert_eq!(text.matches("slower").count(), 1, "{text}");
        assert!(text.contains("without morphing would take 0.50"), "{text}");
    }
}
