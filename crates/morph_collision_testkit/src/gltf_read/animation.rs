//! Collects the clips that drive the weights of nodes, and gives them to the meshes of those nodes.

use gltf::{
    animation::{Interpolation, Property},
    json,
};
use json::validation::Checked;

use super::{
    accessor::Accessors,
    error::{AccessorProblem, AnimationProblem},
};
use crate::mesh::{MorphMesh, WeightAnimation};

/// Appends every weight animation to the mesh it drives; on error says which animation by index and name.
///
/// Where several nodes of one animation show the same mesh, the clips after the first carry the node in their names.
pub(super) fn read(
    root: &json::Root,
    accessors: &Accessors<'_>,
    meshes: &mut [MorphMesh],
) -> Result<(), (usize, String, AnimationProblem)> {
    for (index, animation) in root.animations.iter().enumerate() {
        let name = animation.name.clone().unwrap_or_else(|| format!("animation_{index}"));
        for channel in 0..animation.channels.len() {
            let read = read_channel(root, accessors, meshes, animation, channel)
                .map_err(|problem| (index, name.clone(), problem))?;
            let Some((mesh, node, mut clip)) = read else { continue };
            let clips = &mut meshes[mesh].animations;
            clip.name = match clips.iter().any(|other| other.name == name) {
                true => format!("{name} (node {node})"),
                false => name.clone(),
            };
            clips.push(clip);
        }
    }
    Ok(())
}

/// The mesh index, the node index and the clip; `None` for a channel that drives something else.
fn read_channel(
    root: &json::Root,
    accessors: &Accessors<'_>,
    meshes: &[MorphMesh],
    animation: &json::Animation,
    channel: usize,
) -> Result<Option<(usize, usize, WeightAnimation)>, AnimationProblem> {
    let dangling = |what| AnimationProblem::Dangling { channel, what };
    let json = &animation.channels[channel];
    if json.target.path != Checked::Valid(Property::MorphTargetWeights) {
        return Ok(None);
    }
    let node = json.target.node.value();
    let Some(mesh) = root.nodes.get(node).ok_or_else(|| dangling("node"))?.mesh else {
        return Ok(None);
    };
    let mesh = mesh.value();
    let targets = meshes.get(mesh).ok_or_else(|| dangling("mesh"))?.targets.len();
    let sampler = animation
        .samplers
        .get(json.sampler.value())
        .ok_or_else(|| dangling("sampler"))?;
    let Checked::Valid(interpolation) = sampler.interpolation else {
        return Err(AnimationProblem::UnknownInterpolation { channel });
    };

    let at = |what| move |problem: AccessorProblem| AnimationProblem::Accessor { channel, what, problem };
    let times = accessors.scalars(sampler.input.value()).map_err(at("key times"))?;
    let stored = accessors.scalars(sampler.output.value()).map_err(at("weights"))?;
    check_times(channel, &times)?;

    // A cubic key is an in-tangent, a value and an out-tangent, each a whole weight vector.
    let (vectors_per_key, value) = if interpolation == Interpolation::CubicSpline {
        (3, 1)
    } else {
        (1, 0)
    };
    let keys = times.len();
    let expected = keys.saturating_mul(targets).saturating_mul(vectors_per_key);
    if stored.len() != expected {
        return Err(AnimationProblem::WeightCount {
            channel,
            found: stored.len(),
            keys,
            targets,
            expected,
        });
    }
    let weights: Vec<Vec<f32>> = (0..keys)
        .map(|key| {
            let start = (key * vectors_per_key + value) * targets;
            stored[start..start + targets].to_vec()
        })
        .collect();
    for (key, weights) in weights.iter().enumerate() {
        if let Some(target) = weights.iter().position(|weight| !weight.is_finite()) {
            return Err(AnimationProblem::Weight {
                channel,
                key,
                target,
                weight: weights[target],
            });
        }
    }
    let (times, weights) = match interpolation {
        Interpolation::Step => steps(&times, &weights),
        Interpolation::Linear | Interpolation::CubicSpline => (times, weights),
    };
    Ok(Some((
        mesh,
        node,
        WeightAnimation {
            name: String::new(),
            times,
            weights,
        },
    )))
}

fn check_times(channel: usize, times: &[f32]) -> Result<(), AnimationProblem> {
    let mut previous = f32::NEG_INFINITY;
    for (key, &time) in times.iter().enumerate() {
        if !time.is_finite() || time < previous {
            return Err(AnimationProblem::KeyOrder { channel, key, time });
        }
        previous = time;
    }
    Ok(())
}

/// Holds each key until the next one: a second key, equal to the one before, at the time of every jump.
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
