//! The results of all families, as JSON and as a table.

use std::fmt::Write;

use morph_collision_cli::shared::Verdict;
use morph_collision_models::text::{Grouped, number};
use morph_collision_testkit::stress::FamilyReport;
use serde::Serialize;

/// The JSON of `stress`.
#[derive(Debug, Serialize)]
pub(super) struct StressReport {
    seed: u64,
    families: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    family: &'static str,
    cases: u64,
    pairs_truth: u64,
    missed: u64,
    spurious: u64,
    containment_violations: u64,
    /// Bad input that was refused with an error that names it.
    errors_reported: u64,
    /// Bad input that was accepted or not named, and good input that was refused.
    unexpected: u64,
    panics: u64,
    #[serde(serialize_with = "number")]
    worst_slowdown: f64,
    /// The first thing that went wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    first: Option<String>,
}

impl StressReport {
    pub(super) fn new(seed: u64, families: &[FamilyReport]) -> Self {
        let row = |report: &FamilyReport| Row {
            family: report.family.name(),
            cases: report.cases,
            pairs_truth: report.counts.pairs_truth,
            missed: report.counts.missed,
            spurious: report.counts.spurious,
            containment_violations: report.counts.containment_violations,
            errors_reported: report.errors_reported,
            unexpected: report.unexpected,
            panics: report.panics,
            worst_slowdown: report.worst_slowdown,
            first: report.first.clone(),
        };
        Self {
            seed,
            families: families.iter().map(row).collect(),
        }
    }

    /// The number of things that went wrong.
    fn wrong(&self) -> u64 {
        let wrong = |row: &Row| row.missed + row.spurious + row.containment_violations + row.unexpected + row.panics;
        self.families.iter().map(wrong).sum()
    }

    /// Answers that were compared: intersecting pairs, and refusals of bad input.
    fn answers(&self) -> u64 {
        self.families
            .iter()
            .map(|row| row.pairs_truth + row.errors_reported)
            .sum()
    }

    pub(super) fn verdict(&self) -> Verdict {
        match self.wrong() == 0 && self.answers() > 0 {
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
        writeln!(text, "seed {}", self.seed)?;
        writeln!(
            text,
            "{:15} {:>6} {:>8} {:>6} {:>8} {:>7} {:>6} {:>10} {:>6} {:>8}",
            "family", "cases", "pairs", "missed", "spurious", "outside", "errors", "unexpected", "panics", "slowdown"
        )?;
        for row in &self.families {
            writeln!(
                text,
                "{:15} {:6} {:8} {:6} {:8} {:7} {:6} {:10} {:6} {:8.1}",
                row.family,
                row.cases,
                row.pairs_truth,
                row.missed,
                row.spurious,
                row.containment_violations,
                row.errors_reported,
                row.unexpected,
                row.panics,
                row.worst_slowdown
            )?;
        }
        for first in self.families.iter().filter_map(|row| row.first.as_ref()) {
            writeln!(text, "{first}")?;
        }
        let answers = Grouped(self.answers());
        match (self.wrong(), self.answers()) {
            (0, 0) => writeln!(text, "Nothing was compared; ask for more --cases."),
            (0, _) => writeln!(text, "All {answers} answers agree with brute force."),
            (wrong, _) => writeln!(text, "{} things went wrong among {answers} answers.", Grouped(wrong)),
        }
    }
}

#[cfg(test)]
mod tests {
    use morph_collision_testkit::stress::Family;
    use morph_collision_testkit::verify::Counts;

    use super::*;

    #[test]
    fn anything_wrong_fails_and_is_told() {
        let clean = FamilyReport {
            family: Family::Slivers,
            cases: 3,
            counts: Counts::default(),
            errors_reported: 2,
            unexpected: 0,
            panics: 0,
            worst_slowdown: 900.0,
            first: None,
        };
        let verdict = |report: &FamilyReport| StressReport::new(1, std::slice::from_ref(report)).verdict();
        assert_eq!(verdict(&clean), Verdict::Clean);
        let mut missed = clean.clone();
        missed.counts.missed = 1;
        missed.first = Some("slivers, case 2".into());
        let mut panicked = clean.clone();
        panicked.panics = 1;
        let mut accepted = clean;
        accepted.unexpected = 1;
        for wrong in [&missed, &panicked, &accepted] {
            assert_eq!(verdict(wrong), Verdict::FoundWrong);
        }
        let text = StressReport::new(1, &[missed]).text();
        assert!(
            text.ends_with("slivers, case 2\n1 things went wrong among 2 answers.\n"),
            "{text}"
        );
        let nothing = StressReport::new(1, &[]);
        assert_eq!(nothing.verdict(), Verdict::FoundWrong);
        assert!(
            nothing
                .text()
                .ends_with("Nothing was compared; ask for more --cases.\n")
        );
    }
}
