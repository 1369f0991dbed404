//! The shapes to try: single targets, pairs of targets, clips, captures and random mixtures.

use glam::Affine3A;
use morph_collision_testkit::gltf_read::GltfFile;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::printable::Printable;

use super::capture::Capture;
use crate::clips::{BrokenClips, ClipChoice, clip_names};
use crate::error::CliError;
use crate::frame_times::FrameTimes;

/// The weights at which each target is tried alone.
const ALONE: [f32; 4] = [0.25, 0.5, 0.75, 1.0];
/// The weights at which two targets are tried together. They are among those of [`ALONE`].
const TOGETHER: [[f32; 2]; 4] = [[1.0, 1.0], [1.0, 0.5], [0.5, 1.0], [0.5, 0.5]];

/// Where the weights of a shape come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Source {
    Target(usize),
    Pair([usize; 2]),
    Clip(String),
    Capture(String),
    Mixtures,
    /// Weights that a proof came across.
    Proof,
}

impl Source {
    /// `target`, `pair`, `clip`, `capture`, `mixture` or `proof`.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Target(_) => "target",
            Self::Pair(_) => "pair",
            Self::Clip(_) => "clip",
            Self::Capture(_) => "capture",
            Self::Mixtures => "mixture",
            Self::Proof => "proof",
        }
    }

    /// Its name, which also identifies it in a baseline.
    pub(super) fn words(&self, names: &[String]) -> String {
        let name = |target: &usize| names.get(*target).cloned().unwrap_or_else(|| target.to_string());
        match self {
            Self::Target(target) => format!("target {}", name(target)),
            Self::Pair([a, b]) => format!("pair {} + {}", name(a), name(b)),
            Self::Clip(clip) => format!("clip {clip}"),
            Self::Capture(file) => format!("capture {file}"),
            Self::Mixtures => "random mixtures".to_owned(),
            Self::Proof => "the proof".to_owned(),
        }
    }

    /// The targets that are tried, if they are one or two.
    pub(super) fn targets(&self) -> &[usize] {
        match self {
            Self::Target(target) => std::slice::from_ref(target),
            Self::Pair(pair) => pair,
            Self::Clip(_) | Self::Capture(_) | Self::Mixtures | Self::Proof => &[],
        }
    }
}

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
    Capture(&'a Capture),
    Mixtures {
        count: usize,
        seed: u64,
    },
}

impl Stage<'_> {
    /// The number of shapes.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Alone(targets) => targets.len() * ALONE.len(),
            Self::Pairs(pairs) => pairs.len() * TOGETHER.len(),
            Self::Clip { times, .. } => times.len(),
            Self::Capture(capture) => capture.len(),
            Self::Mixtures { count, .. } => *count,
        }
    }

    /// What a shape is called while progress is shown.
    pub(super) fn step_name(&self) -> String {
        match self {
            Self::Alone(_) => "single target".to_owned(),
            Self::Pairs(_) => "pair of targets".to_owned(),
            Self::Clip { name, .. } => format!("frame of {}", Printable(name)),
            Self::Capture(capture) => format!("row of {}", Printable(&capture.name)),
            Self::Mixtures { .. } => "mixture".to_owned(),
        }
    }

    /// One of the shapes.
    pub(super) fn shape(&self, mesh: &MorphMesh, index: usize) -> Tried {
        let mut weights = mesh.weights_at_rest();
        let skeleton = mesh.skin.as_ref().map(|skin| &skin.skeleton);
        let mut joints = skeleton.map(|skeleton| skeleton.world_from_mesh(None, 0.0));
        let (source, moment) = match self {
            Self::Alone(targets) => {
                let target = targets[index / ALONE.len()];
                weights[target] = ALONE[index % ALONE.len()];
                (Source::Target(target), None)
            }
            Self::Pairs(pairs) => {
                let pair = pairs[index / TOGETHER.len()];
                for (target, weight) in pair.into_iter().zip(TOGETHER[index % TOGETHER.len()]) {
                    weights[target] = weight;
                }
                (Source::Pair(pair), None)
            }
            Self::Clip { name, choice, times } => {
                let moment = times.seconds(index);
                let seconds = moment as f32;
                if let Some(clip) = choice.weights.and_then(|clip| mesh.animations.get(clip)) {
                    weights = clip.sample(seconds);
                }
                joints = skeleton.map(|skeleton| {
                    let clip = choice.joints.and_then(|clip| skeleton.clips.get(clip));
                    skeleton.world_from_mesh(clip, seconds)
                });
                (Source::Clip(name.clone()), Some(moment))
            }
            Self::Capture(capture) => {
                capture.set(index, &mut weights);
                (Source::Capture(capture.name.clone()), Some(index as f64))
            }
            Self::Mixtures { seed, .. } => {
                mix(*seed, index as u64 + 1, &mut weights);
                (Source::Mixtures, Some(index as f64))
            }
        };
        Tried {
            source,
            moment,
            weights,
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

/// Draws weights from 0 to 1: of a few targets or of many.
fn mix(seed: u64, index: u64, weights: &mut [f32]) {
    // The same numbers would follow each other in all mixtures if the start were not scrambled.
    let mut state = scrambled(seed ^ scrambled(index));
    let mut draw = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        (scrambled(state) >> 40) as f32 / (1_u32 << 24) as f32
    };
    let share = draw();
    for weight in weights {
        let (is_active, drawn) = (draw() < share, draw());
        *weight = if is_active { drawn } else { 0.0 };
    }
}

/// The output function of `SplitMix64` (Steele, Lea and Flood, 2014).
fn scrambled(number: u64) -> u64 {
    let number = (number ^ (number >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    number ^ (number >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixtures_are_reproducible_and_between_zero_and_one() {
        let mixture = |index| {
            let mut weights = vec![9.0; 200];
            mix(1, index, &mut weights);
            weights
        };
        assert_eq!(mixture(7), mixture(7));
        assert_ne!(mixture(7), mixture(8));
        let common = |a: &[f32], b: &[f32]| a.iter().filter(|weight| **weight != 0.0 && b.contains(weight)).count();
        let active: Vec<usize> = (0..50)
            .map(|index| {
                let weights = mixture(index);
                assert_eq!(common(&weights, &mixture(index + 1)), 0, "mixture {index}");
                assert!(weights.iter().all(|weight| (0.0..1.0).contains(weight)));
                weights.iter().filter(|weight| **weight != 0.0).count()
            })
            .collect();
        assert!(active.iter().any(|&count| count < 40) && active.iter().any(|&count| count > 160));
    }

    #[test]
    fn pairs_are_tried_only_at_weights_that_are_tried_alone() {
        assert!(TOGETHER.as_flattened().iter().all(|weight| ALONE.contains(weight)));
    }
}
