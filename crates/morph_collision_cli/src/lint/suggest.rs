//! The largest weights that do not clip, for targets and pairs of targets that do.

use serde::Serialize;

use super::findings::Finding;
use super::poses::Tried;
use super::search::{Known, Searcher};
use super::subject::Subject;
use crate::error::PoseError;

/// Weights are tried in this many steps, up to the first that clips.
const STEPS: u32 = 16;
/// Between the last step that is clean and the first that clips, the weight is found to within `1 / (STEPS * 2^BISECTIONS)` of the
/// finding's weight.
const BISECTIONS: u32 = 5;

/// The largest weight of a target that does not clip.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Suggestion {
    pub(super) target: String,
    /// A query found nothing at this weight, nor at any smaller step.
    pub(super) largest: f32,
    /// The weight in the finding.
    pub(super) clips_at: f32,
    /// The other target of a pair, and the weight that it keeps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) while_other: Option<(String, f32)>,
}

impl Suggestion {
    /// The limit in a few words.
    pub(super) fn words(&self) -> String {
        let Self {
            target,
            largest,
            clips_at,
            while_other,
        } = self;
        let other = while_other.as_ref();
        let other = other.map(|(other, weight)| format!(" while {other} is {weight}"));
        format!(
            "{target}: at most {largest}{} (it clips at {clips_at})",
            other.unwrap_or_default()
        )
    }
}

/// Searches for each target of a finding's source, while the other one keeps its weight.
pub(super) fn suggest(
    searcher: &mut Searcher,
    subject: &Subject,
    finding: &Finding,
    known: &[&Known],
) -> Result<Vec<Suggestion>, PoseError> {
    let targets = finding.source.targets();
    let name = |target: usize| subject.mesh.target_names[target].clone();
    let mut suggestions = Vec::with_capacity(targets.len());
    for &target in targets {
        let other = targets.iter().copied().find(|&other| other != target);
        suggestions.push(Suggestion {
            target: name(target),
            largest: largest(searcher, subject, finding, target, known)?,
            clips_at: finding.weights[target],
            while_other: other.map(|other| (name(other), finding.weights[other])),
        });
    }
    Ok(suggestions)
}

fn largest(
    searcher: &mut Searcher,
    subject: &Subject,
    finding: &Finding,
    target: usize,
    known: &[&Known],
) -> Result<f32, PoseError> {
    let full = finding.weights[target];
    let mut shape = Tried {
        source: finding.source.clone(),
        moment: None,
        weights: finding.weights.clone(),
        joints: finding.joints.clone(),
    };
    let mut is_clean = |weight: f32| {
        subject.set(&mut shape.weights, target, weight);
        Ok::<bool, PoseError>(!searcher.new_pairs(&shape, known, 0)?.1)
    };
    let (mut clean, mut clips) = (0.0, full);
    for step in 1..=STEPS {
        let weight = full * step as f32 / STEPS as f32;
        if is_clean(weight)? {
            clean = weight;
        } else {
            clips = weight;
            break;
        }
    }
    for _ in 0..BISECTIONS {
        let middle = f32::midpoint(clean, clips);
        if is_clean(middle)? {
            clean = middle;
        } else {
            clips = middle;
        }
    }
    Ok(clean)
}
