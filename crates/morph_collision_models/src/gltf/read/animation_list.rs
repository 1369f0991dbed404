//! The animations of a file as such: their names, their lengths, and what they animate.

use std::collections::{BTreeSet, HashMap};

use super::GltfFile;
use super::accessor::TIMES;
use super::channels::Animated;
use super::document::{Animation, abridged};

/// An animation of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AnimationInfo {
    /// Its name, see [`GltfFile::animation_names`].
    pub name: String,
    /// The time of its last key in seconds.
    pub seconds: f32,
    /// The number of its channels.
    pub channels: usize,
    /// The meshes whose weights it animates.
    pub meshes: Vec<usize>,
    /// The number of nodes that it moves.
    pub nodes: usize,
    /// Channels that are ignored, because they animate nothing that poses or places a mesh, as the specification demands, or because they
    /// cannot be read.
    pub ignored: usize,
    /// The interpolations of its samplers, as the file names them.
    pub interpolations: Vec<String>,
}

/// The names of a file's animations.
pub(super) struct AnimationNames<'a> {
    names: Vec<Option<&'a str>>,
    /// The first animation with each name.
    first: HashMap<&'a str, usize>,
}

/// The names of all animations of a file, to look up.
#[derive(Debug)]
pub(super) struct AnimationList {
    names: Vec<String>,
    /// The first animation with each name.
    places: HashMap<String, usize>,
}

impl AnimationNames<'_> {
    /// The name of an animation, or a default name. If an earlier animation has the same name, it includes the index.
    pub(super) fn of(&self, index: usize) -> String {
        match self.names.get(index).copied().flatten() {
            None => default_name(index),
            Some(name) if self.first.get(name) == Some(&index) => name.to_owned(),
            Some(name) => format!("{name} (animation {index})"),
        }
    }
}

/// The name of an animation that has none in the file.
pub(super) fn default_name(index: usize) -> String {
    format!("animation_{index}")
}

impl GltfFile {
    /// The names of the animations, in order. An animation without a name gets a default name, and one whose name is taken gets its
    /// index added.
    #[must_use]
    pub fn animation_names(&self) -> Vec<String> {
        self.animation_list().names.clone()
    }

    /// The name of an animation, as in [`GltfFile::animation_names`].
    ///
    /// The first call makes a list of all names, and others take constant time. The same is true for [`GltfFile::animation_named`].
    #[must_use]
    pub fn animation_name(&self, animation: usize) -> Option<&str> {
        self.animation_list().names.get(animation).map(String::as_str)
    }

    /// The index of the first animation of this name.
    #[must_use]
    pub fn animation_named(&self, name: &str) -> Option<usize> {
        self.animation_list().places.get(name).copied()
    }

    fn animation_list(&self) -> &AnimationList {
        self.animation_list.get_or_init(|| {
            let table = self.animation_table();
            let names: Vec<String> = self.root.animations.indices().map(|index| table.of(index)).collect();
            let mut places = HashMap::with_capacity(names.len());
            for (index, name) in names.iter().enumerate() {
                places.entry(name.clone()).or_insert(index);
            }
            AnimationList { names, places }
        })
    }

    /// All animations, in order.
    #[must_use]
    pub fn animations(&self) -> Vec<AnimationInfo> {
        let table = self.animation_table();
        let info = |index: usize| {
            let name = table.of(index);
            let animation = self.root.animations.get(index, &self.budget).ok();
            animation.map_or_else(AnimationInfo::default, |animation| self.info(name, animation))
        };
        self.root.animations.indices().map(info).collect()
    }

    fn info(&self, name: String, animation: &Animation) -> AnimationInfo {
        let (mut meshes, mut nodes, mut interpolations) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
        let mut ignored = 0;
        for channel in animation.channels.indices() {
            let json = animation.channels.get(channel, &self.budget).ok();
            let Some(json) = json else {
                ignored += 1;
                continue;
            };
            match json.target.animated() {
                Animated::NodeWeights(node, None) => {
                    let node = self.root.nodes.get(node, &self.budget).ok();
                    meshes.extend(node.and_then(|node| node.mesh));
                }
                Animated::MeshWeights(mesh, None) => {
                    meshes.insert(mesh);
                }
                Animated::Node(node, _) => {
                    nodes.insert(node);
                }
                _ => {
                    ignored += 1;
                    continue;
                }
            }
            if let Ok(sampler) = animation.samplers.get(json.sampler, &self.budget) {
                interpolations.insert(abridged(sampler.interpolation.as_deref().unwrap_or("LINEAR")));
            }
        }
        AnimationInfo {
            name,
            seconds: self.animation_end(animation),
            channels: animation.channels.len(),
            meshes: meshes.into_iter().collect(),
            nodes: nodes.len(),
            ignored,
            interpolations: interpolations.into_iter().collect(),
        }
    }

    pub(super) fn animation_table(&self) -> AnimationNames<'_> {
        let name = |index| {
            let animation = self.root.animations.get(index, &self.budget).ok();
            animation.and_then(|animation| animation.name.as_deref())
        };
        let names: Vec<Option<&str>> = self.root.animations.indices().map(name).collect();
        let mut first = HashMap::new();
        for (index, name) in names.iter().enumerate() {
            if let Some(name) = name {
                first.entry(*name).or_insert(index);
            }
        }
        AnimationNames { names, first }
    }

    /// The time of an animation's last key in seconds, whatever it animates. Channels that cannot be read are skipped.
    pub(super) fn animation_end(&self, animation: &Animation) -> f32 {
        let end = |channel| {
            let channel = animation.channels.get(channel, &self.budget).ok()?;
            let sampler = animation.samplers.get(channel.sampler, &self.budget).ok()?;
            self.open_accessor(sampler.input, &TIMES).ok()?.last_scalar()
        };
        let ends = animation.channels.indices().filter_map(end);
        ends.filter(|end| end.is_finite()).fold(0.0, f32::max)
    }
}
