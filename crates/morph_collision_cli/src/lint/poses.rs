//! The shapes to try: single targets, pairs of targets, clips, captures, expressions and random mixtures.

use glam::Affine3A;
use morph_collision_models::gltf::read::GltfFile;
use morph_collision_models::text::Printable;

use super::capture::Capture;
use super::mixtures::Mixtures;
use super::source::{Kind, Source};
use super::subject::Subject;
use crate::files::clips::{ClipChoice, clip_names};
use crate::options::frame_times::FrameTimes;

/// The weights at which each target is tried alone.
const ALONE: [f32; 4] = [0.25, 0.5, 0.75, 1.0];
/// The weights at which two targets are tried together. They are among those of [`ALONE`].
const TOGETHER: [[f32; 2]; 4] = [[1.0, 1.0], [1.0, 0.5], [0.5, 1.0], [0.5, 0.5]];

/// The strengths at which an expression is tried. Some are only ever shown in full.
const STRENGTHS: [f32; 2] = [1.0, 0.5];

/// A shape to try.
#[derive(Clone, Debug)]
pub(super) struct Tried {
    pub(super) source: Source,
    /// When: seconds of a clip, or the row of a capture, or the number of a mixture.
    pub(super) moment: Option<f64>,
    pub(super) weights: Vec<f32>,
    /// World from mesh for each joint of a skinned mesh.
    pub(super) joints: Option<Vec<Affine3A>>,
}

/// Shapes of one kind. They are made one at a time, when they are tried.
pub(super) enum Stage<'a> {
    Alone(Vec<usize>),
    Pairs(Vec<[usize; 2]>),
    Clip {
        name: String,
        choice: ClipChoice,
        times: FrameTimes,
    },
    Capture(Capture),
    /// Expressions of the subject, with strengths.
    Expressions(Vec<(usize, f32)>),
    Mixtures(Mixtures<'a>),
}

impl Stage<'_> {
    /// The number of shapes.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Alone(targets) => targets.len() * ALONE.len(),
            Self::Pairs(pairs) => pairs.len() * TOGETHER.len(),
            Self::Clip { times, .. } => times.len(),
            Self::Capture(capture) => capture.len(),
            Self::Expressions(expressions) => expressions.len(),
            Self::Mixtures(mixtures) => mixtures.count,
        }
    }

    /// What a shape is called while progress is shown.
    pub(super) fn step_name(&self) -> String {
        match self {
            Self::Alone(_) => "single target".to_owned(),
            Self::Pairs(_) => "pair of targets".to_owned(),
            Self::Clip { name, .. } => format!("frame of {}", Printable(name)),
            Self::Capture(capture) => format!("row of {}", Printable(&capture.name)),
            Self::Expressions(_) => "expression".to_owned(),
            Self::Mixtures(_) => "mixture".to_owned(),
        }
    }

    pub(super) fn kind(&self) -> Kind {
        match self {
            Self::Alone(_) => Kind::Target,
            Self::Pairs(_) => Kind::Pair,
            Self::Clip { .. } => Kind::Clip,
            Self::Capture(_) => Kind::Capture,
            Self::Expressions(_) => Kind::Expression,
            Self::Mixtures(_) => Kind::Mixture,
        }
    }

    /// Whether its shapes are frames with weights.
    pub(super) fn has_weights(&self) -> bool {
        match self {
            Self::Clip { choice, .. } => choice.weights.is_some(),
            Self::Capture(_) => true,
            Self::Alone(_) | Self::Pairs(_) | Self::Expressions(_) | Self::Mixtures(_) => false,
        }
    }

    /// The weights of one of the shapes.
    pub(super) fn weights(&self, subject: &Subject, index: usize) -> Vec<f32> {
        let mut weights = subject.mesh.weights_at_rest();
        match self {
            Self::Alone(targets) => {
                subject.set(&mut weights, targets[index / ALONE.len()], ALONE[index % ALONE.len()]);
            }
            Self::Pairs(pairs) => {
                let pair = pairs[index / TOGETHER.len()];
                for (target, weight) in pair.into_iter().zip(TOGETHER[index % TOGETHER.len()]) {
                    subject.set(&mut weights, target, weight);
                }
            }
            Self::Clip { choice, times, .. } => {
                weights = subject.weights_in_clip(choice.weights, times.seconds(index) as f32);
            }
            Self::Capture(capture) => {
                for (target, weight) in capture.row(index) {
                    subject.set(&mut weights, target, weight);
                }
            }
            Self::Expressions(expressions) => {
                let (expression, strength) = expressions[index];
                subject.expressions[expression].add(strength, &mut weights);
            }
            Self::Mixtures(mixtures) => weights = mixtures.draw(subject, index),
        }
        weights
    }

    /// One of the shapes.
    pub(super) fn shape(&self, subject: &Subject, index: usize) -> Tried {
        let skeleton = subject.mesh.skin.as_ref().map(|skin| &skin.skeleton);
        let at_rest = || skeleton.map(|skeleton| skeleton.world_from_mesh(None, 0.0));
        let row = Some(index as f64);
        let (source, moment, joints) = match self {
            Self::Alone(targets) => (Source::Target(targets[index / ALONE.len()]), None, at_rest()),
            Self::Pairs(pairs) => (Source::Pair(pairs[index / TOGETHER.len()]), None, at_rest()),
            Self::Clip { name, choice, times } => {
                let moment = times.seconds(index);
                let joints = skeleton.map(|skeleton| {
                    let clip = choice.joints.and_then(|clip| skeleton.clips.get(clip));
                    skeleton.world_from_mesh(clip, moment as f32)
                });
                (Source::Clip(name.clone()), Some(moment), joints)
            }
            Self::Capture(capture) => (Source::Capture(capture.name.clone()), row, at_rest()),
            Self::Expressions(expressions) => {
                let name = subject.expressions[expressions[index].0].name.clone();
                (Source::Expression(name), None, at_rest())
            }
            Self::Mixtures(_) => (Source::Mixtures, row, at_rest()),
        };
        Tried {
            source,
            moment,
            weights: self.weights(subject, index),
            joints,
        }
    }
}

/// The clips of a mesh as stages.
pub(super) fn clip_stages(
    file: &GltfFile,
    subject: &Subject,
    wanted: &[String],
    fps: f32,
    is_loop: bool,
) -> Vec<Stage<'static>> {
    let (mesh, broken) = (&subject.mesh, &subject.broken);
    let names = match wanted {
        [] => clip_names(file, mesh, None, broken),
        _ => wanted.to_vec(),
    };
    // A clip that is asked for moves at least one subject, but not each.
    let stage = |name: String| {
        let choice = ClipChoice::find(&name, file, mesh, None, broken).ok()?;
        let seconds = choice
            .duration(mesh, None)
            .max(subject.seconds_of_weights(choice.weights));
        let times = FrameTimes::of_clip(seconds, fps, is_loop);
        Some(Stage::Clip { name, choice, times })
    };
    names.into_iter().filter_map(stage).collect()
}

/// The expressions of a subject.
pub(super) fn expressions(subject: &Subject) -> Stage<'static> {
    let strengths = |is_binary: bool| if is_binary { &STRENGTHS[..1] } else { &STRENGTHS[..] };
    let all = subject.expressions.iter().enumerate();
    let all = all.flat_map(|(index, expression)| strengths(expression.is_binary).iter().map(move |&by| (index, by)));
    Stage::Expressions(all.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_tried_only_at_weights_that_are_tried_alone() {
        assert!(TOGETHER.as_flattened().iter().all(|weight| ALONE.contains(weight)));
    }
}
