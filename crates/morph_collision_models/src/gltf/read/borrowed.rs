//! Clips for models of other files: libraries ship animations without meshes, and nodes are matched by their names.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::GltfFile;
use super::channels::Animated;
use super::document::{Animation, abridged};
use super::error::{AnimationProblem, ReadError};
use super::target_names;
use crate::clip::WeightAnimation;
use crate::memory::{MemoryBudget, OverBudget};
use crate::mesh::MorphMesh;
use crate::skeleton::{JointChannel, JointClip, Skeleton};

/// Upper bound on the bytes of an entry of a [`BorrowedClip`], without its keys and its name.
const BYTES_PER_ENTRY: u64 = 256;

/// An animation of a file for the models of other files. What it animates is known by the names of nodes.
///
/// Values are used as they are, so a model should have the rest pose of the file that the animation is from.
#[derive(Clone, Debug, Default)]
pub struct BorrowedClip {
    end: f32,
    joints: BTreeMap<String, Vec<JointChannel>>,
    weights: BTreeMap<String, Weights>,
    repeated: Vec<String>,
    unnamed: usize,
    not_applied: Vec<String>,
}

/// Weights of the mesh that a node shows.
#[derive(Clone, Debug)]
struct Weights {
    /// The names of the targets; empty if they have none.
    targets: Vec<String>,
    clip: WeightAnimation,
}

/// What a model takes of a [`BorrowedClip`].
#[derive(Clone, Debug, PartialEq)]
pub struct Matched<T> {
    /// The clip.
    pub clip: T,
    /// What was matched, as in [`BorrowedClip::parts`].
    pub parts: Vec<String>,
    /// Names that several nodes of the model have; the clip moves the first of each.
    pub repeated: Vec<String>,
}

impl GltfFile {
    /// An animation for models of other files. The file needs no mesh.
    ///
    /// # Errors
    /// The animation does not exist, or one of its channels cannot be played. The error names the channel. Pointers to what is not animated
    /// here are no errors; see [`BorrowedClip::not_applied`].
    pub fn borrowed_clip(&self, animation: usize) -> Result<BorrowedClip, ReadError> {
        let json = self.root.animations.get(animation, &self.budget);
        let json = json.map_err(|problem| self.animation_error(animation, None, AnimationProblem::Element(problem)))?;
        self.borrow_channels(animation, json)
            .map_err(|problem| self.animation_error(animation, json.name.as_deref(), problem))
    }

    fn borrow_channels(&self, index: usize, animation: &Animation) -> Result<BorrowedClip, AnimationProblem> {
        let mut found = BorrowedClip {
            end: self.animation_end(animation),
            ..BorrowedClip::default()
        };
        // The first node with each name.
        let mut owners: HashMap<&str, usize> = HashMap::new();
        for channel in animation.channels.indices() {
            let json = animation.channels.get(channel, &self.budget);
            let json = json.map_err(|problem| AnimationProblem::Channel { channel, problem })?;
            let (node, property) = match json.target.animated() {
                Animated::Node(node, property) => (Some(node), Some(property)),
                Animated::NodeWeights(node, None) => (Some(node), None),
                Animated::MeshWeights(mesh, None) => (self.main_node(mesh), None),
                Animated::NotApplied(pointer) => {
                    let pointer = abridged(pointer);
                    let bytes = BYTES_PER_ENTRY + pointer.len() as u64;
                    let take = self
                        .budget
                        .take(bytes, 1, || "the names of what it animates".to_owned());
                    take.map_err(|over| AnimationProblem::OverBudget { channel, over })?;
                    found.not_applied.push(pointer);
                    continue;
                }
                Animated::NodeWeights(_, Some(pointer)) | Animated::MeshWeights(_, Some(pointer)) => {
                    let pointer = abridged(pointer);
                    return Err(AnimationProblem::NotApplied { channel, pointer });
                }
                Animated::Other => continue,
            };
            let node_json = node.and_then(|node| self.root.nodes.get(node, &self.budget).ok().map(|json| (node, json)));
            let named = node_json.and_then(|(node, json)| Some((node, json, json.name.as_deref()?)));
            let Some((node, node_json, name)) = named else {
                found.unnamed += 1;
                continue;
            };
            if *owners.entry(name).or_insert(node) != node {
                found.repeated.push(abridged(name));
                continue;
            }
            let bytes = BYTES_PER_ENTRY + 4 * name.len() as u64;
            let take = self.budget.take(bytes, 1, || "the names of its nodes".to_owned());
            take.map_err(|over| AnimationProblem::OverBudget { channel, over })?;
            if let Some(property) = property {
                let keys = self.joint_channel(animation, (channel, json), 0, property)?;
                found.joints.entry(name.to_owned()).or_default().push(keys);
                continue;
            }
            let clip = self.channel_weights(animation, index, channel, json.sampler)?;
            let count = clip.weights.first().map_or(0, Vec::len);
            let mesh = node_json
                .mesh
                .and_then(|mesh| self.root.meshes.get(mesh, &self.budget).ok());
            let mut targets = mesh.map_or_else(Vec::new, |mesh| target_names::read(self, mesh, count));
            if !are_named(&targets) {
                targets.clear();
            }
            let bytes = targets.iter().map(|name| BYTES_PER_ENTRY + 3 * name.len() as u64).sum();
            let take = self.budget.take(bytes, 1, || "the names of its targets".to_owned());
            take.map_err(|over| AnimationProblem::OverBudget { channel, over })?;
            found
                .weights
                .entry(name.to_owned())
                .or_insert(Weights { targets, clip });
        }
        found.repeated.sort_unstable();
        found.repeated.dedup();
        Ok(found)
    }
}

/// Whether targets have names of their own, other than those that the reader makes up.
fn are_named(targets: &[String]) -> bool {
    let made_up = |(index, name): (usize, &String)| name.strip_prefix("target_") == Some(&index.to_string());
    !targets.iter().enumerate().all(made_up)
}

fn weights_part(node: &str) -> String {
    format!("the weights of {node}")
}

fn target_part(node: &str, target: &str) -> String {
    format!("target {target} of {node}")
}

impl BorrowedClip {
    /// What it animates, in words: names of nodes, and weights and targets of nodes.
    pub fn parts(&self) -> impl Iterator<Item = String> {
        let weights = self
            .weights
            .iter()
            .flat_map(|(node, weights)| match &weights.targets[..] {
                [] => vec![weights_part(node)],
                targets => targets.iter().map(|target| target_part(node, target)).collect(),
            });
        self.joints.keys().cloned().chain(weights)
    }

    /// Names that several of its nodes have; the first node counts.
    #[must_use]
    pub fn repeated(&self) -> &[String] {
        &self.repeated
    }

    /// The number of channels that animate nodes without a name, which fit no model.
    #[must_use]
    pub fn unnamed(&self) -> usize {
        self.unnamed
    }

    /// Pointers of channels (`KHR_animation_pointer`) to parts of nodes, meshes and skins that are not animated here.
    #[must_use]
    pub fn not_applied(&self) -> &[String] {
        &self.not_applied
    }

    /// A clip of this name for the nodes of a skeleton; `None` if no node has the name of a node that the animation moves.
    ///
    /// # Errors
    /// The budget has no room for a copy of the keys.
    pub fn for_skeleton(
        &self,
        name: &str,
        skeleton: &Skeleton,
        budget: &MemoryBudget,
    ) -> Result<Option<Matched<JointClip>>, OverBudget> {
        let mut matched = Matched {
            clip: JointClip {
                name: name.to_owned(),
                ..JointClip::default()
            },
            parts: Vec::new(),
            repeated: Vec::new(),
        };
        let mut seen = HashSet::new();
        for (index, node) in skeleton.nodes.iter().enumerate() {
            let Some(channels) = self.joints.get(&node.name) else {
                continue;
            };
            if !seen.insert(&*node.name) {
                matched.repeated.push(node.name.clone());
                continue;
            }
            let bytes: usize = channels
                .iter()
                .map(|channel| 4 * channel.times.len() + 16 * channel.values.len())
                .sum();
            let bytes = bytes as u64 + channels.len() as u64 * BYTES_PER_ENTRY + 2 * node.name.len() as u64;
            budget.take(bytes, 1, || "a copy of a clip of another file".to_owned())?;
            matched.parts.push(node.name.clone());
            let of_node = channels.iter().map(|channel| JointChannel {
                node: index as u32,
                ..channel.clone()
            });
            matched.clip.channels.extend(of_node);
        }
        let is_longer = self.end > matched.clip.duration();
        matched.clip.end = if is_longer { self.end } else { 0.0 };
        Ok((!matched.parts.is_empty()).then_some(matched))
    }

    /// A clip of this name for the weights of a mesh that a node of this name shows; `None` if the animation has none that fit.
    ///
    /// Targets are matched by name if both files name them, or else by index if there are equally many. Other targets keep their default
    /// weights.
    ///
    /// # Errors
    /// The budget has no room for the weights.
    pub fn for_weights(
        &self,
        name: &str,
        node: &str,
        mesh: &MorphMesh,
        budget: &MemoryBudget,
    ) -> Result<Option<Matched<WeightAnimation>>, OverBudget> {
        let Some(Weights { targets, clip }) = self.weights.get(node) else {
            return Ok(None);
        };
        let count = clip.weights.first().map_or(0, Vec::len);
        let by_name = !targets.is_empty() && are_named(&mesh.target_names);
        let mut sources: Vec<Option<usize>> = Vec::with_capacity(mesh.targets.len());
        if by_name {
            let mut places = HashMap::new();
            for (index, target) in targets.iter().enumerate() {
                places.entry(&**target).or_insert(index);
            }
            sources.extend(mesh.target_names.iter().map(|name| places.get(&**name).copied()));
        } else if count == mesh.targets.len() {
            sources.extend((0..count).map(Some));
        }
        if sources.iter().all(Option::is_none) {
            return Ok(None);
        }
        let keys = (clip.weights.len() + 2 * clip.tangents.len()) as u64;
        let bytes = keys.saturating_mul(4 * sources.len() as u64 + 64);
        budget.take(bytes, 1, || "a copy of a clip of another file".to_owned())?;
        let rest = mesh.weights_at_rest();
        let filled = |key: &Vec<f32>, rest: &[f32]| {
            let weights = sources.iter().zip(rest);
            weights
                .map(|(source, &rest)| source.and_then(|source| key.get(source).copied()).unwrap_or(rest))
                .collect()
        };
        let flat = vec![0.0; rest.len()];
        let retargeted = WeightAnimation {
            name: name.to_owned(),
            times: clip.times.clone(),
            weights: clip.weights.iter().map(|key| filled(key, &rest)).collect(),
            tangents: clip
                .tangents
                .iter()
                .map(|both| [filled(&both[0], &flat), filled(&both[1], &flat)])
                .collect(),
            end: if self.end > clip.duration() { self.end } else { 0.0 },
        };
        let parts = match by_name {
            true => sources
                .iter()
                .flatten()
                .map(|&source| target_part(node, &targets[source]))
                .collect(),
            false if targets.is_empty() => vec![weights_part(node)],
            false => targets.iter().map(|target| target_part(node, target)).collect(),
        };
        Ok(Some(Matched {
            clip: retargeted,
            parts,
            repeated: Vec::new(),
        }))
    }
}
