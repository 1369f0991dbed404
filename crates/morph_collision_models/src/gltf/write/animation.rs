//! Writes clips of weights and of joints.

use gltf_json::{
    self as json, Index, Root,
    accessor::Type,
    animation::{Channel, Interpolation, Property, Sampler, Target},
    validation::Checked,
};

use super::buffer::Packer;
use crate::clip::WeightAnimation;
use crate::skeleton::{self, JointChannel, JointClip};

/// The nodes that clips move.
pub(super) struct Animated<'a> {
    /// The node that shows the mesh.
    pub(super) mesh: Index<json::Node>,
    /// The nodes of the skeleton.
    pub(super) bones: &'a [Index<json::Node>],
}

/// Writes all clips. Both kinds keep their order. Clips with the same name are merged if the order allows it.
pub(super) fn write(
    of_weights: &[WeightAnimation],
    of_joints: &[JointClip],
    animated: &Animated<'_>,
    root: &mut Root,
    packer: &mut Packer,
) {
    let mut rest = of_weights;
    for clip in of_joints {
        let mut parts = Parts::default();
        if let Some(same) = rest.iter().position(|weights| weights.name == clip.name) {
            for weights in &rest[..same] {
                write_weights(weights, animated.mesh, root, packer);
            }
            parts.add_weights(&rest[same], animated.mesh, root, packer);
            rest = &rest[same + 1..];
        }
        for channel in &clip.with_key_at_end().channels {
            parts.add_joint(channel, animated.bones[channel.node as usize], root, packer);
        }
        parts.finish(&clip.name, root);
    }
    for weights in rest {
        write_weights(weights, animated.mesh, root, packer);
    }
}

fn write_weights(clip: &WeightAnimation, mesh: Index<json::Node>, root: &mut Root, packer: &mut Packer) {
    let mut parts = Parts::default();
    parts.add_weights(clip, mesh, root, packer);
    parts.finish(&clip.name, root);
}

/// The parts of an animation.
#[derive(Default)]
struct Parts {
    channels: Vec<Channel>,
    samplers: Vec<Sampler>,
}

impl Parts {
    /// Adds one linear or cubic channel for the mesh's weights. Clips without keys are left out, because glTF does not
    /// allow them.
    fn add_weights(&mut self, clip: &WeightAnimation, mesh: Index<json::Node>, root: &mut Root, packer: &mut Packer) {
        if clip.times.is_empty() || clip.weights.iter().all(Vec::is_empty) {
            return;
        }
        let clip = &clip.with_key_at_end();
        let input = packer.keys(root, &ascending(&clip.times), true);
        let (interpolation, weights) = if clip.tangents.is_empty() {
            (Interpolation::Linear, clip.weights.concat())
        } else {
            // A key is its in-tangent, its value and its out-tangent.
            let keys = clip.weights.iter().zip(&clip.tangents);
            let keys = keys.map(|(weights, [arriving, leaving])| [&arriving[..], weights, leaving].concat());
            (Interpolation::CubicSpline, keys.collect::<Vec<_>>().concat())
        };
        let output = packer.keys(root, &weights, false);
        self.add(mesh, Property::MorphTargetWeights, input, interpolation, output);
    }

    /// Adds one channel for a node of the skeleton, unless it has no keys.
    fn add_joint(&mut self, channel: &JointChannel, node: Index<json::Node>, root: &mut Root, packer: &mut Packer) {
        if channel.times.is_empty() {
            return;
        }
        let input = packer.keys(root, &ascending(&channel.times), true);
        let vectors = || channel.values.iter().map(|value| value.truncate().to_array());
        let (property, output) = match channel.property {
            skeleton::Property::Translation => (Property::Translation, packer.values(root, Type::Vec3, vectors())),
            skeleton::Property::Scale => (Property::Scale, packer.values(root, Type::Vec3, vectors())),
            skeleton::Property::Rotation => (
                Property::Rotation,
                packer.values(root, Type::Vec4, channel.values.iter().map(glam::Vec4::to_array)),
            ),
        };
        let interpolation = match channel.interpolation {
            skeleton::Interpolation::Linear => Interpolation::Linear,
            skeleton::Interpolation::Step => Interpolation::Step,
            skeleton::Interpolation::CubicSpline => Interpolation::CubicSpline,
        };
        self.add(node, property, input, interpolation, output);
    }

    fn add(
        &mut self,
        node: Index<json::Node>,
        path: Property,
        input: Index<json::Accessor>,
        interpolation: Interpolation,
        output: Index<json::Accessor>,
    ) {
        self.channels.push(Channel {
            sampler: Index::new(self.samplers.len() as u32),
            target: Target {
                extensions: None,
                extras: None,
                node,
                path: Checked::Valid(path),
            },
            extensions: None,
            extras: None,
        });
        self.samplers.push(Sampler {
            extensions: None,
            extras: None,
            input,
            interpolation: Checked::Valid(interpolation),
            output,
        });
    }

    /// Adds the animation to the file, unless it is empty.
    fn finish(self, name: &str, root: &mut Root) {
        if !self.channels.is_empty() {
            root.push(json::Animation {
                extensions: None,
                extras: None,
                channels: self.channels,
                name: Some(name.to_owned()),
                samplers: self.samplers,
            });
        }
    }
}

/// glTF requires strictly ascending times, so a jump (two keys at one time) becomes the shortest possible ramp.
fn ascending(times: &[f32]) -> Vec<f32> {
    let mut times = times.to_vec();
    for key in 1..times.len() {
        times[key] = times[key].max(times[key - 1].next_up());
    }
    times
}
