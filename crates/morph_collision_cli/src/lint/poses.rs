//! The shapes to try: single targets, pairs of targets, clips, captures and random mixtures.

use glam::Affine3A;
use morph_collision_testkit::gltf_read::GltfFile;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::printable::Printable;

use super::capture::Capture;
use super::mixtures::Mixtures;
use super::source::{Kind, Source};
use crate::clips::{BrokenClips, ClipChoice, clip_names};
use crate::error::CliError;
use crate::frame_times::FrameTimes;

/// The weights at which each target is tried alone.
const ALONE: [f32; 4] = [0.25, 0.5, 0.75, 1.0];
/// The weights at which two targets are tried together. They are among those of [`ALONE`].
const TOGETHER: [[f32; 2]; 4] = [[1.0, 1.0], [1.0, 0.5], [0.5, 1.0], [0.5, 0.5]];

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
            Self::Mixtures(_) => "mixture".to_owned(),
        }
    }

    pub(super) fn kind(&self) -> Kind {
        match self {
            Self::Alone(_) => Kind::Target,
            Self::Pairs(_) => Kind::Pair,
            Self::Clip { .. } => Kind::Clip,
            Self::Capture(_) => Kind::Capture,
            Self::Mixtures(_) => Kind::Mixture,
        }
    }

    /// Whether its shapes are frames with weights.
    pub(super) fn has_weights(&self) -> bool {
        match self {
            Self::Clip { choice, .. } => choice.weights.is_some(),
            Self::Capture(_) => true,
            Self::Alone(_) | Self::Pairs(_) | Self::Mixtures(_) => false,
        }
    }

    /// The weights of one of the shapes.
    pub(super) fn weights(&self, mesh: &MorphMesh, index: usize) -> Vec<f32> {
        let mut weights = mesh.weights_at_rest();
        match self {
            Self::Alone(targets) => weights[targets[index / ALONE.len()]] = ALONE[index % ALONE.len()],
            Self::Pairs(pairs) => {
                let pair = pairs[index / TOGETHER.len()];
                for (target, weight) in pair.into_iter().zip(TOGETHER[index % TOGETHER.len()]) {
                    weights[target] = weight;
                }
            }
            Self::Clip { choice, times, .. } => {
                if let Some(clip) = choice.weights.and_then(|clip| mesh.animations.get(clip)) {
                    weights = clip.sample(times.seconds(index) as f32);
                }
            }
            Self::Capture(capture) => capture.set(index, &mut weights),
            Self::Mixtures(mixtures) => weights = mixtures.draw(mesh, index),
        }
        weights
    }

    /// One of the shapes.
    pub(super) fn shape(&self, mesh: &MorphMesh, index: usize) -> Tried {
        let skeleton = mesh.skin.as_ref().map(|skin| &skin.skeleton);
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
            Self::Mixtures(_) => (Source::Mixtures, row, at_rest()),
        };
        Tried {
            source,
            moment,
            weights: self.weights(mesh, index),
            joints,
        }
    }
}

/// The clips of a mesh as stages.
pub(super) fn clip_stages(
    file: &GltfFile,
    mesh: &MorphMesh,
    broken: &BrokenClips,
    wanted: &[String],
    fps: f32,
    is_loop: bool,
) -> Result<Vec<Stage<'static>>, CliError> {
    let names = match wanted {
        [] => clip_names(file, mesh, None, broken),
        _ => wanted.to_vec(),
    };
    let stage = |name: String| {
        let choice = ClipChoice::find(&name, file, mesh, None, broken).map_err(|error| CliError::Flag {
            flag: "--clip",
            reason: error.reason(),
        })?;
        let times = FrameTimes::of_clip(choice.duration(mesh, None), fps, is_loop);
        Ok(Stage::Clip { name, choice, times })
    };
    names.into_iter().map(stage).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_tried_only_at_weights_that_are_tried_alone() {
        assert!(TOGETHER.as_flattened().iter().all(|weight| ALONE.contains(weight)));
    }
}
