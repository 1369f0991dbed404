//! The result of a comparison, as JSON and as text.

use std::fmt::Write;
use std::path::PathBuf;

use glam::Affine3A;
use morph_collision_cli::shared::{Verdict, counted};
use morph_collision_models::text::Grouped;
use morph_collision_models::text::Printable;
use morph_collision_testkit::verify::{Counts, Finding, MotionCounts, Trouble, Verification};
use serde::Serialize;

/// The JSON of `verify`. Frames and pairs of triangles are counted once, everything else over all trees.
#[derive(Debug, Serialize)]
pub(super) struct VerifyReport {
    bodies: [WhichMesh; 2],
    seed: u64,
    #[serde(flatten)]
    total: CountsReport,
    trees: Vec<TreeReport>,
    motion: MotionReport,
    /// The smallest wrong answer found.
    reproduction: Option<ReproductionReport>,
}

/// A mesh of a file.
#[derive(Clone, Debug, Serialize)]
pub(super) struct WhichMesh {
    pub(super) model: PathBuf,
    pub(super) mesh: usize,
    /// The numbers of its triangles, if some are left out.
    #[serde(skip)]
    pub(super) kept: Option<Vec<u32>>,
}

impl WhichMesh {
    /// The number of a triangle in the file's mesh.
    fn triangle(&self, compared: u32) -> u32 {
        let kept = self.kept.as_ref();
        kept.and_then(|kept| kept.get(compared as usize).copied())
            .unwrap_or(compared)
    }
}

#[derive(Debug, Serialize)]
struct TreeReport {
    leaf_size: usize,
    #[serde(flatten)]
    counts: CountsReport,
}

/// Contacts during motions, over all trees.
#[derive(Debug, Serialize)]
struct MotionReport {
    steps: u64,
    contacts: u64,
    /// Pairs of features compared with exact arithmetic.
    pairs: u64,
    missed: u64,
    spurious: u64,
    wrong_times: u64,
    /// Contacts whose point, normal or velocity does not fit the motion.
    wrong_geometry: u64,
}

impl From<MotionCounts> for MotionReport {
    fn from(counts: MotionCounts) -> Self {
        Self {
            steps: counts.steps,
            contacts: counts.contacts,
            pairs: counts.pairs,
            missed: counts.missed,
            spurious: counts.spurious,
            wrong_times: counts.wrong_times,
            wrong_geometry: counts.wrong_geometry,
        }
    }
}

#[derive(Debug, Serialize)]
struct CountsReport {
    frames: u64,
    pairs_truth: u64,
    missed: u64,
    spurious: u64,
    undecided_by_filter: u64,
    containment_checks: u64,
    containment_violations: u64,
}

/// Everything needed to reproduce a wrong answer. Numbers are printed so that parsing them gives the same bits.
#[derive(Debug, Serialize)]
struct ReproductionReport {
    leaf_size: usize,
    /// `missed`, `spurious` or `outside`.
    trouble: &'static str,
    /// One triangle of each body; `None` if a vertex is outside a box.
    triangles: Option<[u32; 2]>,
    /// The body and the welded vertex, if it is outside a box.
    body_and_vertex: Option<(usize, u32)>,
    weights: [Vec<f32>; 2],
    /// Column by column, with the translation last.
    world_from_model: [[f32; 12]; 2],
    /// The joint matrices of a skinned mesh, in the same layout; empty for other meshes.
    world_from_mesh: [Vec<[f32; 12]>; 2],
    /// The corners of both triangles.
    world: Option<[[[f64; 3]; 3]; 2]>,
}

impl VerifyReport {
    pub(super) fn new(
        bodies: [WhichMesh; 2],
        leaf_sizes: &[usize],
        seed: u64,
        verification: &Verification,
        motion: MotionCounts,
    ) -> Self {
        let mut total = Counts::default();
        verification.counts.iter().for_each(|counts| total += *counts);
        if let Some(first) = verification.counts.first() {
            (total.frames, total.pairs_truth) = (first.frames, first.pairs_truth);
        }
        let tree = |(&leaf_size, counts): (&usize, &Counts)| TreeReport {
            leaf_size,
            counts: CountsReport::new(counts),
        };
        let reproduction = verification.smallest.as_ref();
        let reproduction =
            reproduction.map(|finding| ReproductionReport::new(&bodies, leaf_sizes[finding.source], finding));
        Self {
            bodies,
            seed,
            total: CountsReport::new(&total),
            trees: leaf_sizes.iter().zip(&verification.counts).map(tree).collect(),
            motion: motion.into(),
            reproduction,
        }
    }

    /// The number of answers that differ.
    pub(super) fn differences(&self) -> u64 {
        let (total, motion) = (&self.total, &self.motion);
        let in_motion = motion.missed + motion.spurious + motion.wrong_times + motion.wrong_geometry;
        total.missed + total.spurious + total.containment_violations + in_motion
    }

    /// Intersecting pairs of triangles that brute force finds.
    pub(super) fn pairs(&self) -> u64 {
        self.total.pairs_truth
    }

    /// The number of answers compared: pairs of triangles in every tree, boxes, and features in motion. 0 if nothing touched, because then no
    /// pair could be missed.
    pub(super) fn answers(&self) -> u64 {
        match self.total.pairs_truth + self.motion.contacts + self.differences() {
            0 => 0,
            _ => self.total.pairs_truth * self.trees.len() as u64 + self.total.containment_checks + self.motion.pairs,
        }
    }

    pub(super) fn verdict(&self) -> Verdict {
        match self.differences() == 0 && self.answers() > 0 {
            true => Verdict::Clean,
            false => Verdict::FoundWrong,
        }
    }

    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, text: &mut String) -> std::fmt::Result {
        let total = &self.total;
        writeln!(
            text,
            "{} of seed {}, {} intersecting pairs of triangles",
            counted(total.frames as usize, "frame", "frames"),
            self.seed,
            Grouped(total.pairs_truth)
        )?;
        writeln!(
            text,
            "{:8} {:>8} {:>8} {:>12} {:>14} {:>10}",
            "leaf", "missed", "spurious", "undecided", "containment", "outside"
        )?;
        for row in &self.trees {
            let CountsReport {
                missed,
                spurious,
                undecided_by_filter,
                ..
            } = row.counts;
            let CountsReport {
                containment_checks,
                containment_violations,
                ..
            } = row.counts;
            writeln!(
                text,
                "{:8} {missed:8} {spurious:8} {undecided_by_filter:12} {containment_checks:14} {containment_violations:10}",
                row.leaf_size
            )?;
        }
        let MotionReport {
            steps,
            contacts,
            pairs,
            missed,
            spurious,
            wrong_times,
            wrong_geometry,
        } = &self.motion;
        writeln!(
            text,
            "{steps} motions: {contacts} contacts, {pairs} pairs of features compared: {missed} missed, {spurious} spurious, {wrong_times} wrong times, \
             {wrong_geometry} wrong points or normals"
        )?;
        if let Some(reproduction) = &self.reproduction {
            reproduction.write_text(&self.bodies, text)?;
        }
        let answers = Grouped(self.answers());
        match (self.differences(), self.answers(), total.frames) {
            (0, 0, 0) => writeln!(text, "Nothing was compared, because no frames were asked for."),
            (0, 0, frames) => writeln!(
                text,
                "Nothing was compared, because nothing touched in {frames} frames; try more --frames or another --seed."
            ),
            (0, _, _) => writeln!(text, "All {answers} answers agree with brute force."),
            (wrong, _, _) => writeln!(text, "{} of {answers} answers differ from brute force.", Grouped(wrong)),
        }
    }
}

impl CountsReport {
    fn new(counts: &Counts) -> Self {
        Self {
            frames: counts.frames,
            pairs_truth: counts.pairs_truth,
            missed: counts.missed,
            spurious: counts.spurious,
            undecided_by_filter: counts.undecided_by_filter,
            containment_checks: counts.containment_checks,
            containment_violations: counts.containment_violations,
        }
    }
}

impl ReproductionReport {
    fn new([first, second]: &[WhichMesh; 2], leaf_size: usize, finding: &Finding) -> Self {
        let numbers = |a, b| Some([first.triangle(a), second.triangle(b)]);
        let reproduction = &finding.reproduction;
        let (trouble, triangles, body_and_vertex) = match reproduction.trouble {
            Trouble::Missed(a, b) => ("missed", numbers(a, b), None),
            Trouble::Spurious(a, b) => ("spurious", numbers(a, b), None),
            Trouble::Outside { body, vertex } => ("outside", None, Some((body, vertex))),
        };
        Self {
            leaf_size,
            trouble,
            triangles,
            body_and_vertex,
            weights: reproduction.situation.weights.clone(),
            world_from_model: reproduction.situation.places.map(|place| place.to_cols_array()),
            world_from_mesh: [0, 1].map(|body| {
                let joints = reproduction.situation.world_joints(body);
                joints.iter().map(Affine3A::to_cols_array).collect()
            }),
            world: reproduction
                .world
                .map(|of_both| of_both.map(|corners| corners.map(|corner| corner.to_array()))),
        }
    }

    fn write_text(&self, bodies: &[WhichMesh; 2], text: &mut String) -> std::fmt::Result {
        writeln!(
            text,
            "\nthe smallest that differs: {} with leaves of {}",
            self.trouble, self.leaf_size
        )?;
        for (body, which) in bodies.iter().enumerate() {
            let model = which.model.display().to_string();
            writeln!(text, "body {body}: {} mesh {}", Printable(&model), which.mesh)?;
            writeln!(text, "  weights {:?}", self.weights[body])?;
            writeln!(text, "  world_from_model {:?}", self.world_from_model[body])?;
            for (joint, matrix) in self.world_from_mesh[body].iter().enumerate() {
                writeln!(text, "  world_from_mesh of joint {joint} {matrix:?}")?;
            }
            if let (Some(triangles), Some(world)) = (&self.triangles, &self.world) {
                writeln!(text, "  triangle {}: {:?}", triangles[body], world[body])?;
            }
        }
        match self.body_and_vertex {
            Some((body, vertex)) => writeln!(text, "welded vertex {vertex} of body {body} is outside a box above it"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use morph_collision_testkit::verify::{Reproduction, Situation};

    use super::*;

    fn found(trouble: Trouble) -> VerifyReport {
        let counts = Counts {
            frames: 5,
            pairs_truth: 7,
            missed: 2,
            ..Counts::default()
        };
        let reproduction = Reproduction {
            trouble,
            situation: Situation {
                weights: [vec![0.1], vec![-1.5e-7]],
                places: [Affine3A::IDENTITY; 2],
                joints: [Vec::new(), vec![Affine3A::from_scale(glam::Vec3::splat(0.3))]],
            },
            world: Some([[DVec3::splat(0.1); 3]; 2]),
        };
        let verification = Verification {
            counts: vec![counts; 2],
            smallest: Some(Finding {
                source: 1,
                reproduction,
            }),
        };
        let which = WhichMesh {
            model: "a.glb".into(),
            mesh: 3,
            kept: Some(vec![0, 1, 2, 3, 5, 6, 8]),
        };
        let leaf_sizes = [8, 2];
        VerifyReport::new(
            [which.clone(), which],
            &leaf_sizes,
            9,
            &verification,
            MotionCounts::default(),
        )
    }

    #[test]
    fn what_differs_is_written_in_full() {
        let report = found(Trouble::Missed(4, 6));
        assert_eq!(report.verdict(), Verdict::FoundWrong);
        assert_eq!(
            (report.total.frames, report.total.pairs_truth, report.total.missed),
            (5, 7, 4)
        );
        let text = report.text();
        for part in [
            "missed with leaves of 2",
            "a.glb mesh 3",
            "[-1.5e-7]",
            "triangle 8",
            "0.1, 0.1",
            "joint 0 [0.3, 0.0",
        ] {
            assert!(text.contains(part), "no {part:?} in: {text}");
        }
        assert!(text.ends_with("4 of 14 answers differ from brute force.\n"), "{text}");
        let outside = found(Trouble::Outside { body: 1, vertex: 8 }).text();
        assert!(outside.contains("vertex 8 of body 1"), "{outside}");
    }

    #[test]
    fn numbers_come_back_bit_for_bit() -> Result<(), serde_json::Error> {
        let json: serde_json::Value = serde_json::from_str(&serde_json::to_string(&found(Trouble::Spurious(0, 0)))?)?;
        let weight = json["reproduction"]["weights"][1][0].as_f64().unwrap_or(0.0) as f32;
        assert_eq!(weight.to_bits(), (-1.5e-7_f32).to_bits());
        let corner = json["reproduction"]["world"][0][0][0].as_f64();
        assert_eq!(corner, Some(0.1));
        Ok(())
    }
}
