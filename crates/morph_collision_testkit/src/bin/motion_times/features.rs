//! The table of single pairs of features: time by kind, and by the stage that decides.

use std::error::Error;
use std::hint::black_box;
use std::path::PathBuf;

use morph_collision::motion::StageCounts;
use morph_collision_testkit::motion::MotionKind;
use morph_collision_testkit::motion::records::{FramePair, read_queries};

use super::timing::{Features, median_seconds};

const STAGES: [&str; 3] = ["apart along an axis", "filter in `f64`", "exact arithmetic"];

/// A question about two features: whether they touch, or when. Returns whether they do.
type Question = fn(&Features, &mut StageCounts) -> bool;

const QUESTIONS: [Question; 2] = [Features::touch, |features, stages| features.impact(stages).is_some()];

/// A row for each kind of features and each stage, over all recordings.
pub(crate) fn table(queries: &[PathBuf], pairs: &[PathBuf], rounds: usize) -> Result<String, Box<dyn Error>> {
    let mut recorded = Vec::new();
    for path in queries {
        recorded.extend(read_queries(path)?.iter().map(|query| Features::new(&query.motion)));
    }
    for path in pairs {
        recorded.extend(recorded_pairs(&FramePair::read(path)?)?);
    }
    let mut text = String::from(
        "| features | decided by | queries: whether | share | ns each | queries: when | share | ns each |\n|---|---|--:|--:|--:|--:|--:|--:|\n",
    );
    for kind in MotionKind::ALL {
        let of_kind: Vec<Features> = recorded
            .iter()
            .filter(|features| features.kind == kind)
            .copied()
            .collect();
        let cells = QUESTIONS.map(|question| {
            let mut by_stage = [const { Vec::new() }; 3];
            for features in &of_kind {
                by_stage[stage(question, features)].push(*features);
            }
            let [a, b, c] = by_stage.map(|some| cell(&some, of_kind.len(), question, rounds));
            [a, b, c, cell(&of_kind, of_kind.len(), question, rounds)]
        });
        for (row, name) in STAGES.into_iter().chain(["all"]).enumerate() {
            text += &format!("| {} | {name} | {} | {} |\n", kind.name(), cells[0][row], cells[1][row]);
        }
    }
    Ok(text)
}

/// All pairs of features in the list of a recording.
pub(crate) fn recorded_pairs(frames: &FramePair) -> Result<Vec<Features>, Box<dyn Error>> {
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
        _ => 2,
    }
}

/// How many queries there are, their share of all, and the time of one.
fn cell(some: &[Features], all: usize, question: Question, rounds: usize) -> String {
    if some.is_empty() {
        return "0 | 0 % | -".to_owned();
    }
    let work = |()| {
        let mut stages = StageCounts::default();
        let touching = some
            .iter()
            .filter(|features| question(black_box(features), &mut stages));
        (touching.count(), stages)
    };
    let nanoseconds = median_seconds(rounds, || (), work) * 1e9 / some.len() as f64;
    let share = some.len() as f64 / all as f64 * 100.0;
    format!("{} | {share:.2} % | {nanoseconds:.0}", some.len())
}
