//! The results of several models, one line each.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_models::text::Grouped;
use morph_collision_models::text::Printable;
use serde::Serialize;

use super::report::VerifyReport;

/// The JSON of `verify` for several models.
#[derive(Debug, Default, Serialize)]
pub(super) struct BatchReport {
    meshes: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    model: PathBuf,
    mesh: usize,
    /// `agrees`, `differs`, `nothing compared` or `error`.
    result: &'static str,
    /// Pairs of triangles that brute force finds.
    pairs_truth: u64,
    /// Answers that were compared, over all trees.
    answers: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

const AGREES: &str = "agrees";
const ERROR: &str = "error";

impl BatchReport {
    pub(super) fn add(&mut self, model: &Path, mesh: usize, report: Result<VerifyReport, AnyError>) {
        let row = match report {
            Ok(report) => Row {
                model: model.to_owned(),
                mesh,
                result: match (report.differences(), report.answers()) {
                    (0, 0) => "nothing compared",
                    (0, _) => AGREES,
                    _ => "differs",
                },
                pairs_truth: report.pairs(),
                answers: report.answers(),
                error: None,
            },
            Err(error) => Row {
                model: model.to_owned(),
                mesh,
                result: ERROR,
                pairs_truth: 0,
                answers: 0,
                error: Some(error.to_string()),
            },
        };
        self.meshes.push(row);
    }

    pub(super) fn len(&self) -> usize {
        self.meshes.len()
    }

    /// The number of meshes that could not be compared because of an error.
    pub(super) fn failed(&self) -> usize {
        self.meshes.iter().filter(|row| row.result == ERROR).count()
    }

    pub(super) fn verdict(&self) -> Verdict {
        match self.meshes.iter().all(|row| row.result == AGREES) {
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
        for row in &self.meshes {
            let model = row.model.display().to_string();
            write!(text, "{} mesh {}: {}", Printable(&model), row.mesh, row.result)?;
            match &row.error {
                Some(error) => writeln!(text, ": {}", Printable(error))?,
                None => writeln!(
                    text,
                    ", {} answers, {} pairs of triangles",
                    Grouped(row.answers),
                    Grouped(row.pairs_truth)
                )?,
            }
        }
        let agree = self.meshes.iter().filter(|row| row.result == AGREES).count();
        let answers: u64 = self.meshes.iter().map(|row| row.answers).sum();
        writeln!(
            text,
            "{} of {} meshes agree with brute force in all answers ({} answers compared).",
            agree,
            self.meshes.len(),
            Grouped(answers)
        )
    }
}
