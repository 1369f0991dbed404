//! Collects the clips that animate the weights of nodes, and assigns them to those nodes' meshes.

use super::GltfFile;
use super::accessor::{TIMES, WEIGHTS};
use super::animation_list::default_name;
use super::channels::Animated;
use super::document::{Animation, ElementError, abridged};
use super::error::{AccessorProblem, AnimationProblem, ReadError};
use crate::clip::WeightAnimation;

/// The clips of a mesh, in the order of the file.
#[derive(Debug, Default)]
pub struct Clips {
    /// The clips that can be played.
    pub clips: Vec<WeightAnimation>,
    /// The animation of the file that each clip is part of.
    pub animations: Vec<usize>,
    /// The interpolation of each clip, as the file names it.
    pub interpolations: Vec<&'static str>,
    /// Why the other clips cannot be played.
    pub broken: Vec<ReadError>,
}

/// A channel that animates weights.
struct WeightChannel<'a> {
    animation: &'a Animation,
    /// Borrowed because there can be many channels.
    name: Option<&'a str>,
    index: usize,
    channel: usize,
    /// `None` if it animates the mesh itself.
    node: Option<usize>,
    mesh: usize,
    sampler: usize,
    /// The pointer to it, if it is only one of the weights.
    one: Option<&'a str>,
}

impl GltfFile {
    /// The clips that animate the weights of a mesh with `targets` targets, as a node shows it, or as all nodes do if none is given.
    ///
    /// A clip has the name of its animation ([`GltfFile::animation_names`]). If several nodes of one animation show the mesh, the names
    /// of all clips after the first include the node. Channels without a node, and those that animate something else, are skipped.
    /// A clip lasts as long as the whole animation.
    #[must_use]
    pub fn clips(&self, mesh: usize, node: Option<usize>, targets: usize) -> Clips {
        let mut found = Clips::default();
        let channels = self.weight_channels(&mut Vec::new());
        let names = self.animation_table();
        let mut end = (usize::MAX, 0.0);
        let is_wanted = |channel: &WeightChannel<'_>| {
            let is_of_node = match (node, channel.node) {
                (None, _) => true,
                (Some(node), Some(animated)) => node == animated,
                (Some(node), None) => !self.has_weights(node),
            };
            channel.mesh == mesh && is_of_node
        };
        for channel in channels.into_iter().filter(is_wanted) {
            match self.read_channel(&channel, Some(targets)) {
                Ok((mut clip, interpolation)) => {
                    clip.name = names.of(channel.index);
                    if found.animations.last() == Some(&channel.index) {
                        clip.name += &match channel.node {
                            Some(node) => format!(" (node {node})"),
                            None => format!(" (mesh {mesh})"),
                        };
                    }
                    if end.0 != channel.index {
                        end = (channel.index, self.animation_end(channel.animation));
                    }
                    clip.end = if end.1 > clip.duration() { end.1 } else { 0.0 };
                    found.clips.push(clip);
                    found.animations.push(channel.index);
                    found.interpolations.push(interpolation.name());
                }
                Err(problem) => found
                    .broken
                    .push(self.animation_error(channel.index, channel.name, problem)),
            }
        }
        found
    }

    /// Errors of animations and channels that are too broken to tell which mesh they animate.
    #[must_use]
    pub fn stray_animations(&self) -> Vec<ReadError> {
        let mut problems = Vec::new();
        self.weight_channels(&mut problems);
        problems
    }

    /// The first of the errors in [`GltfFile::stray_animations`] that is about this animation. Only its channels are looked at.
    #[must_use]
    pub fn stray_animation(&self, animation: usize) -> Option<ReadError> {
        let json = match self.root.animations.get(animation, &self.budget) {
            Ok(json) => json,
            Err(problem) => return Some(self.animation_error(animation, None, AnimationProblem::Element(problem))),
        };
        let error = |channel| self.weight_channel(json, animation, channel).err();
        let problem = json.channels.indices().find_map(error)?;
        Some(self.animation_error(animation, json.name.as_deref(), problem))
    }

    pub(super) fn animation_error(&self, animation: usize, name: Option<&str>, problem: AnimationProblem) -> ReadError {
        ReadError::Animation {
            path: self.path.clone(),
            animation,
            name: name.map_or_else(|| default_name(animation), abridged),
            problem: Box::new(problem),
        }
    }

    /// Every channel that animates weights of a mesh. Errors of unreadable channels go to `problems`.
    fn weight_channels(&self, problems: &mut Vec<ReadError>) -> Vec<WeightChannel<'_>> {
        let mut channels = Vec::new();
        for index in self.root.animations.indices() {
            let animation = match self.root.animations.get(index, &self.budget) {
                Ok(animation) => animation,
                Err(problem) => {
                    problems.push(self.animation_error(index, None, AnimationProblem::Element(problem)));
                    continue;
                }
            };
            let name = animation.name.as_deref();
            for channel in animation.channels.indices() {
                match self.weight_channel(animation, index, channel) {
                    Ok(found) => channels.extend(found),
                    Err(problem) => problems.push(self.animation_error(index, name, problem)),
                }
            }
        }
        channels
    }

    /// A channel of an animation; `None` if it animates something else.
    fn weight_channel<'a>(
        &self,
        animation: &'a Animation,
        index: usize,
        channel: usize,
    ) -> Result<Option<WeightChannel<'a>>, AnimationProblem> {
        let json = animation.channels.get(channel, &self.budget);
        let json = json.map_err(|problem| AnimationProblem::Channel { channel, problem })?;
        let dangling = |what, index| {
            move |problem| AnimationProblem::Dangling {
                channel,
                what,
                index,
                problem,
            }
        };
        let (node, mesh, one) = match json.target.animated() {
            Animated::NodeWeights(node, one) => {
                let found = self.root.nodes.get(node, &self.budget);
                let Some(mesh) = found.map_err(dangling("node", node))?.mesh else {
                    return Ok(None);
                };
                (Some(node), mesh, one)
            }
            Animated::MeshWeights(mesh, one) => (None, mesh, one),
            Animated::NotApplied(pointer) => {
                let pointer = abridged(pointer);
                return Err(AnimationProblem::NotApplied { channel, pointer });
            }
            Animated::Node(..) | Animated::Other => return Ok(None),
        };
        if mesh >= self.root.meshes.len() {
            return Err(dangling("mesh", mesh)(ElementError::Missing));
        }
        Ok(Some(WeightChannel {
            animation,
            name: animation.name.as_deref(),
            index,
            channel,
            node,
            mesh,
            sampler: json.sampler,
            one,
        }))
    }

    /// Whether a node has weights of its own.
    fn has_weights(&self, node: usize) -> bool {
        let json = self.root.nodes.get(node, &self.budget);
        json.is_ok_and(|json| json.weights.is_some())
    }

    /// The weights of a channel of any node, for as many targets as it has weights for.
    pub(super) fn channel_weights(
        &self,
        animation: &Animation,
        index: usize,
        channel: usize,
        sampler: usize,
    ) -> Result<WeightAnimation, AnimationProblem> {
        let channel = WeightChannel {
            animation,
            name: animation.name.as_deref(),
            index,
            channel,
            node: None,
            mesh: 0,
            sampler,
            one: None,
        };
        Ok(self.read_channel(&channel, None)?.0)
    }

    /// Reads the weights of this number of targets, or else of as many as there are weights for.
    fn read_channel(
        &self,
        json: &WeightChannel<'_>,
        targets: Option<usize>,
    ) -> Result<(WeightAnimation, Interpolation), AnimationProblem> {
        let channel = json.channel;
        if let Some(pointer) = json.one {
            let pointer = abridged(pointer);
            return Err(AnimationProblem::NotApplied { channel, pointer });
        }
        let sampler = json.animation.samplers.get(json.sampler, &self.budget);
        let sampler = sampler.map_err(|problem| AnimationProblem::Dangling {
            channel,
            what: "sampler",
            index: json.sampler,
            problem,
        })?;
        let interpolation = Interpolation::new(sampler.interpolation.as_deref());
        let interpolation = interpolation.ok_or(AnimationProblem::UnknownInterpolation { channel })?;
        let at = |what| move |problem: AccessorProblem| AnimationProblem::Accessor { channel, what, problem };
        let times = self.open_accessor(sampler.input, &TIMES).map_err(at("key times"))?;
        let stored = self.open_accessor(sampler.output, &WEIGHTS).map_err(at("weights"))?;

        let (keys, found) = (times.count(), stored.count());
        let vectors = keys.saturating_mul(interpolation.vectors_per_key());
        let targets = targets.unwrap_or(found / vectors.max(1));
        let expected = keys
            .saturating_mul(targets)
            .saturating_mul(interpolation.vectors_per_key());
        if found != expected {
            return Err(AnimationProblem::WeightCount {
                channel,
                found,
                keys,
                targets,
                expected,
            });
        }
        // Counts the decoded numbers, each key's vectors, twice more for steps, and the name, which reports copy.
        let bytes = (keys as u64)
            .saturating_mul(200)
            .saturating_add((found as u64).saturating_mul(24))
            .saturating_add(json.name.map_or(0, |name| 4 * name.len() as u64));
        let what = || format!("its {keys} keys of {targets} targets");
        let take = self.budget.take(bytes, 1, what);
        take.map_err(|over| AnimationProblem::OverBudget { channel, over })?;
        let times = times.scalars().map_err(at("key times"))?;
        let stored = stored.scalars().map_err(at("weights"))?;
        check_times(channel, &times)?;
        Ok((interpolation.clip(channel, times, &stored, targets)?, interpolation))
    }
}

/// How weights are interpolated between two keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolation {
    Linear,
    Step,
    /// A key is an in-tangent, a value and an out-tangent, each a whole weight vector.
    CubicSpline,
}

impl Interpolation {
    fn new(name: Option<&str>) -> Option<Self> {
        Some(match name {
            None | Some("LINEAR") => Self::Linear,
            Some("STEP") => Self::Step,
            Some("CUBICSPLINE") => Self::CubicSpline,
            Some(_) => return None,
        })
    }

    fn vectors_per_key(self) -> usize {
        match self {
            Self::Linear | Self::Step => 1,
            Self::CubicSpline => 3,
        }
    }

    fn clip(
        self,
        channel: usize,
        times: Vec<f32>,
        stored: &[f32],
        targets: usize,
    ) -> Result<WeightAnimation, AnimationProblem> {
        let vector = |key: usize, part: usize| {
            let start = (key * self.vectors_per_key() + part) * targets;
            stored[start..start + targets].to_vec()
        };
        let value = if self == Self::CubicSpline { 1 } else { 0 };
        let weights: Vec<Vec<f32>> = (0..times.len()).map(|key| vector(key, value)).collect();
        let tangents = match self {
            Self::Linear | Self::Step => Vec::new(),
            Self::CubicSpline => (0..times.len()).map(|key| [vector(key, 0), vector(key, 2)]).collect(),
        };
        check_finite(channel, &weights, &tangents)?;
        let (times, weights) = match self {
            Self::Step => steps(&times, &weights),
            Self::Linear | Self::CubicSpline => (times, weights),
        };
        Ok(WeightAnimation {
            name: String::new(),
            times,
            weights,
            tangents,
            end: 0.0,
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Linear => "LINEAR",
            Self::Step => "STEP",
            Self::CubicSpline => "CUBICSPLINE",
        }
    }
}

pub(super) fn check_times(channel: usize, times: &[f32]) -> Result<(), AnimationProblem> {
    let mut previous = f32::NEG_INFINITY;
    for (key, &time) in times.iter().enumerate() {
        if !time.is_finite() || time < previous {
            return Err(AnimationProblem::KeyOrder { channel, key, time });
        }
        previous = time;
    }
    Ok(())
}

fn check_finite(channel: usize, weights: &[Vec<f32>], tangents: &[[Vec<f32>; 2]]) -> Result<(), AnimationProblem> {
    let first_bad = |vector: &[f32]| vector.iter().position(|value| !value.is_finite());
    for (key, weights) in weights.iter().enumerate() {
        if let Some(target) = first_bad(weights) {
            let weight = weights[target];
            return Err(AnimationProblem::Weight {
                channel,
                key,
                target,
                weight,
            });
        }
    }
    for (key, both) in tangents.iter().enumerate() {
        for tangents in both {
            if let Some(target) = first_bad(tangents) {
                let tangent = tangents[target];
                return Err(AnimationProblem::Tangent {
                    channel,
                    key,
                    target,
                    tangent,
                });
            }
        }
    }
    Ok(())
}

/// Holds each key until the next one by inserting, at the time of every jump, a second key equal to the one before.
fn steps(times: &[f32], weights: &[Vec<f32>]) -> (Vec<f32>, Vec<Vec<f32>>) {
    let mut held = (Vec::new(), Vec::new());
    for (key, (&time, vector)) in times.iter().zip(weights).enumerate() {
        if let Some(previous) = key.checked_sub(1) {
            held.0.push(time);
            held.1.push(weights[previous].clone());
        }
        held.0.push(time);
        held.1.push(vector.clone());
    }
    held
}
