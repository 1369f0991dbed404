//! Single pairs of moving features: time by kind, and by the stage that decides.

use std::error::Error;
use std::hint::black_box;
use std::path::PathBuf;

use morph_collision::motion::StageCounts;
use morph_collision_testkit::motion::MotionKind;
use morph_collision_testkit::motion::records::{FramePair, read_queries};
use morph_collision_testkit::report::Table;
use serde::{Deserialize, Serialize};

use super::timing::{Features, median_seconds};

const STAGES: [&str; 4] = [
    "apart along an axis",
    "filter in `f64`",
    "start and end",
    "exact arithmetic",
];

/// A question about two features: whether they touch, or when. Returns whether they do.
type Question = fn(&Features, &mut StageCounts) -> bool;

const QUESTIONS: [(&str, Question); 2] = [
    ("whether", Features::touch),
    ("when", |features, stages| features.impact(stages).is_some()),
];

/// The recorded queries of a kind that one stage decides.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Queried {
    features: String,
    decided_by: String,
    question: String,
    queries: usize,
    share: f64,
    nanoseconds: Option<f64>,
    pub(super) measured: String,
}

/// A row for each kind of features, each question and each stage, over all recordings.
///
/// # Errors
/// A recording cannot be read.
pub(super) fn measure(
    queries: &[PathBuf],
    pairs: &[PathBuf],
    rounds: usize,
    measured: &str,
) -> Result<Vec<Queried>, Box<dyn Error>> {
    let mut recorded = Vec::new();
    for path in queries {
        recorded.extend(read_queries(path)?.iter().map(|query| Features::new(&query.motion)));
    }
    for path in pairs {
        recorded.extend(recorded_pairs(&FramePair::read(path)?)?);
    }
    let mut rows = Vec::new();
    for kind in MotionKind::ALL {
        let of_kind = recorded.iter().filter(|features| features.kind == kind);
        let of_kind: Vec<Features> = of_kind.copied().collect();
        for (asked, question) in QUESTIONS {
            let mut by_stage = [const { Vec::new() }; STAGES.len()];
            for features in &of_kind {
                by_stage[stage(question, features)].push(*features);
            }
            let groups = STAGES.iter().zip(&by_stage).chain([(&"all", &of_kind)]);
            rows.extend(groups.map(|(decided_by, group)| Queried {
                features: kind.name().to_owned(),
                decided_by: (*decided_by).to_owned(),
                question: asked.to_owned(),
                queries: group.len(),
                share: group.len() as f64 / of_kind.len() as f64,
                nanoseconds: nanoseconds(group, question, rounds),
                measured: measured.to_owned(),
            }));
        }
    }
    Ok(rows)
}

/// All pairs of features in the list of a recording.
///
/// # Errors
/// A pair names features that the recording does not have.
pub(super) fn recorded_pairs(frames: &FramePair) -> Result<Vec<Features>, Box<dyn Error>> {
    let motions = MotionKind::ALL.into_iter().flat_map(|kind| {
        let pairs = frames.pairs(kind).iter();
        pairs.map(move |pair| frames.motion(kind, pair.features))
    });
    let features: Option<Vec<_>> = motions.map(|motion| Some(Features::new(&motion?))).collect();
    features.ok_or_else(|| "a pair has no features".into())
}

/// The stage that decides, as an index of [`STAGES`].
fn stage(question: Question, features: &Features) -> usize {
    let mut stages = StageCounts::default();
    question(features, &mut stages);
    match stages {
        StageCounts { separated: 1, .. } => 0,
        StageCounts { filtered: 1, .. } => 1,
        StageCounts { at_ends: 1, .. } => 2,
        _ => 3,
    }
}

/// The time of one query; none without queries.
fn nanoseconds(group: &[Features], question: Question, rounds: usize) -> Option<f64> {
    let work = |()| {
        let mut stages = StageCounts::default();
        let touching = group
            .iter()
            .filter(|features| question(black_box(features), &mut stages));
        (touching.count(), stages)
    };
    (!group.is_empty()).then(|| median_seconds(rounds, || (), work) * 1e9 / group.len() as f64)
}

/// The table of the page.
pub(super) fn table(rows: &[Queried]) -> Table {
    let mut table = Table::new(["features", "question", "decided by", "queries", "share", "ns each"]);
    for row in rows {
        let nanoseconds = row.nanoseconds.map(|time| format!("{time:.0}"));
        table.row([
            row.features.clone(),
            row.question.clone(),
            row.decided_by.clone(),
            row.queries.to_string(),
            format!("{:.2} %", row.share * 100.0),
            nanoseconds.unwrap_or_else(|| "-".to_owned()),
        ]);
    }
    table
}
