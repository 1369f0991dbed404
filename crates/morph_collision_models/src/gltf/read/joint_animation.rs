//! Collects the clips that move the nodes of a skeleton.

use glam::Vec4;

use super::GltfFile;
use super::accessor::{FRACTIONS, POINTS, TIMES};
use super::channels::Animated;
use super::document::{Animation, Channel};
use super::error::{AccessorProblem, AnimationProblem, ReadError, Remedy};
use super::skin::Hierarchy;
use super::weight_animation::check_times;
use crate::skeleton::{BrokenClip, Interpolation, JointChannel, JointClip, Property};

/// The clips that move the joints of a mesh, in the order of the file.
#[derive(Debug, Default)]
pub struct JointClips {
    /// The clips that can be played.
    pub clips: Vec<JointClip>,
    /// The animation of the file that each clip is part of.
    pub animations: Vec<usize>,
    /// Why the other clips cannot be played.
    pub broken: Vec<ReadError>,
}

impl GltfFile {
    /// The clips that move the joints of a mesh or their ancestors, with the skin of a node ([`GltfFile::skin`]). Empty for meshes without a
    /// skin, and for skins that cannot be read.
    ///
    /// A clip has the name of its animation ([`GltfFile::animation_names`]) and lasts as long. A clip with a broken channel is left out
    /// as a whole.
    #[must_use]
    pub fn joint_clips(&self, mesh: usize, node: Option<usize>) -> JointClips {
        let json = self.root.meshes.get(mesh, &self.budget).ok();
        let skin = json.and_then(|json| self.skin_of(mesh, json, node));
        match skin.map(|skin| self.hierarchy(skin)) {
            Some(Ok(hierarchy)) => self.clips_of(&hierarchy),
            None | Some(Err(_)) => JointClips::default(),
        }
    }

    /// Adds the clips that move a skeleton, and why others cannot be played, as far as the memory allows.
    pub(super) fn add_clips(&self, hierarchy: &mut Hierarchy) {
        let found = self.clips_of(hierarchy);
        hierarchy.skeleton.clips = found.clips;
        for error in found.broken {
            let ReadError::Animation { animation, .. } = error else {
                continue;
            };
            let reason = error.to_string() + Remedy::hint(error.remedy());
            let bytes = (size_of::<BrokenClip>() + reason.len()) as u64;
            if self.budget.take(bytes, 2, String::new).is_ok() {
                hierarchy.skeleton.broken.push(BrokenClip { animation, reason });
            }
        }
    }

    fn clips_of(&self, hierarchy: &Hierarchy) -> JointClips {
        let mut found = JointClips::default();
        let names = self.animation_table();
        for index in self.root.animations.indices() {
            let Ok(animation) = self.root.animations.get(index, &self.budget) else {
                continue;
            };
            match self.joint_channels(animation, hierarchy) {
                Ok(channels) if channels.is_empty() => {}
                Ok(channels) => {
                    let mut clip = JointClip {
                        name: names.of(index),
                        channels,
                        end: 0.0,
                    };
                    let end = self.animation_end(animation);
                    clip.end = if end > clip.duration() { end } else { 0.0 };
                    found.clips.push(clip);
                    found.animations.push(index);
                }
                Err(problem) => {
                    let name = animation.name.as_deref();
                    found.broken.push(self.animation_error(index, name, problem));
                }
            }
        }
        found
    }

    fn joint_channels(
        &self,
        animation: &Animation,
        hierarchy: &Hierarchy,
    ) -> Result<Vec<JointChannel>, AnimationProblem> {
        let mut channels = Vec::new();
        for channel in animation.channels.indices() {
            // A channel that cannot be parsed cannot be known to move a joint.
            let Ok(json) = animation.channels.get(channel, &self.budget) else {
                continue;
            };
            if let Animated::Node(node, property) = json.target.animated()
                && let Some(&node) = hierarchy.places.get(&node)
            {
                channels.push(self.joint_channel(animation, (channel, json), node, property)?);
            }
        }
        Ok(channels)
    }

    pub(super) fn joint_channel(
        &self,
        animation: &Animation,
        (channel, json): (usize, &Channel),
        node: u32,
        property: Property,
    ) -> Result<JointChannel, AnimationProblem> {
        let sampler = animation.samplers.get(json.sampler, &self.budget);
        let sampler = sampler.map_err(|problem| AnimationProblem::Dangling {
            channel,
            what: "sampler",
            index: json.sampler,
            problem,
        })?;
        let interpolation = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::CubicSpline,
            Some(_) => return Err(AnimationProblem::UnknownInterpolation { channel }),
        };
        let what = what(property);
        let at = |what| move |problem: AccessorProblem| AnimationProblem::Accessor { channel, what, problem };
        let times = self.open_accessor(sampler.input, &TIMES).map_err(at("key times"))?;
        let stored = match property {
            Property::Rotation => self.open_accessor(sampler.output, &FRACTIONS),
            Property::Translation | Property::Scale => self.open_accessor(sampler.output, &POINTS),
        };
        let stored = stored.map_err(at(what))?;
        let (keys, found) = (times.count(), stored.count());
        let per_key = if interpolation == Interpolation::CubicSpline {
            3
        } else {
            1
        };
        let expected = keys.saturating_mul(per_key);
        if found != expected {
            return Err(AnimationProblem::ValueCount {
                channel,
                what,
                found,
                keys,
                expected,
            });
        }
        let bytes = (keys as u64)
            .saturating_mul(8)
            .saturating_add((found as u64).saturating_mul(16))
            .saturating_add(size_of::<JointChannel>() as u64 * 2);
        let take = self.budget.take(bytes, 1, || format!("its {keys} keys"));
        take.map_err(|over| AnimationProblem::OverBudget { channel, over })?;
        let times = times.scalars().map_err(at("key times"))?;
        check_times(channel, &times)?;
        let mut values: Vec<Vec4> = Vec::new();
        match property {
            Property::Rotation => stored.append_vec4(&mut values),
            Property::Translation | Property::Scale => stored.append_vec3_as_vec4(&mut values),
        }
        .map_err(at(what))?;
        if let Some(bad) = values.iter().position(|value| !value.is_finite()) {
            let key = bad / per_key;
            return Err(AnimationProblem::NotFinite { channel, key, what });
        }
        Ok(JointChannel {
            node,
            property,
            interpolation,
            times,
            values,
        })
    }
}

fn what(property: Property) -> &'static str {
    match property {
        Property::Translation => "translations",
        Property::Rotation => "rotations",
        Property::Scale => "scales",
    }
}
