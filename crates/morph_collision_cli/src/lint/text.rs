//! The findings as a table.

use std::fmt::Write as _;

use morph_collision_models::text::Grouped;
use morph_collision_models::text::Printable;

use super::report::{LintReport, MeshReport};
use super::search::MOST_PAIRS;
use crate::messages::counted;
use crate::touching::depth::ThresholdArgs;

/// The table shows at most this many findings of a mesh; the JSON has all.
const MOST_ROWS: usize = 40;

impl LintReport {
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, text: &mut String) -> std::fmt::Result {
        for mesh in &self.meshes {
            mesh.write_text(text, self.thresholds)?;
        }
        let all = self.all().count();
        let tried = counted(self.shapes(), "shape", "shapes");
        match (all, all - self.unaccepted()) {
            (0, _) => {
                let (touches, or_else) = (self.thresholds.one(), self.thresholds.at_rest());
                writeln!(text, "Nothing {touches} that {or_else} at rest, in {tried}.")
            }
            (_, 0) => writeln!(text, "{} in {tried}.", counted(all, "finding", "findings")),
            (_, accepted) => writeln!(
                text,
                "{} in {tried}; {} of them accepted by the baseline.",
                counted(all, "finding", "findings"),
                Grouped(accepted as u64)
            ),
        }
    }
}

impl MeshReport {
    fn write_text(&self, text: &mut String, thresholds: ThresholdArgs) -> std::fmt::Result {
        let [one, many] = [thresholds.one(), thresholds.many()];
        writeln!(
            text,
            "mesh {} \"{}\": {}, {}, {} tried; {} at rest",
            self.mesh,
            Printable(&self.name),
            counted(self.triangles, "triangle", "triangles"),
            counted(self.targets, "target", "targets"),
            counted(self.shapes, "shape", "shapes"),
            counted(self.pairs_at_rest, &format!("pair {one}"), &format!("pairs {many}")),
        )?;
        if let Some(proof) = &self.proof {
            writeln!(text, "  {}", proof.sentence())?;
        }
        if !self.findings.is_empty() {
            writeln!(text, "  {}", self.by_source())?;
            writeln!(text, "     depth     pairs  found with")?;
        }
        for finding in self.findings.iter().take(MOST_ROWS) {
            let pairs = Grouped(finding.pairs as u64).to_string();
            let more = if finding.is_truncated { "+" } else { "" };
            let accepted = if finding.accepted { " (accepted)" } else { "" };
            writeln!(
                text,
                "{:10.6}  {:>8}  {}: {}{accepted}",
                finding.depth,
                pairs + more,
                Printable(&finding.found_with),
                Printable(&finding.shape())
            )?;
            let place = finding.place();
            if !place.is_empty() {
                writeln!(text, "                      {}", Printable(&place))?;
            }
        }
        if self.findings.len() > MOST_ROWS {
            let left = self.findings.len() - MOST_ROWS;
            writeln!(
                text,
                "  and {}; --json has all",
                counted(left, "more finding", "more findings")
            )?;
        }
        if self.findings.iter().any(|finding| finding.is_truncated) {
            writeln!(
                text,
                "  +: only the first {} new pairs of a shape were looked at",
                Grouped(MOST_PAIRS as u64)
            )?;
        }
        for suggestion in &self.suggestions {
            writeln!(text, "  {}", Printable(&suggestion.words()))?;
        }
        Ok(())
    }
}
