//! Reads the clips of a body, and finds one by the name or index of an animation.

use std::collections::{BTreeMap, BTreeSet};

use morph_collision_models::gltf::read::{GltfFile, ReadError};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::skeleton::Skeleton;
use morph_collision_models::text::Printable;
use morph_collision_models::text::suggestion;

use crate::error::CliError;
use crate::files::model::FileArgs;
use crate::messages;
use crate::messages::listed;

/// What an animation moves of a body: indices into the clips of its weights, of its joints and of the node that shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ClipChoice {
    pub(crate) weights: Option<usize>,
    pub(crate) joints: Option<usize>,
    pub(crate) node: Option<usize>,
}

/// The animations that cannot be played for a body, by their indices in the file, and why.
#[derive(Clone, Debug, Default)]
pub struct BrokenClips(BTreeMap<usize, String>);

/// Why a body has no clip of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum NoClip {
    /// No animation of this name moves it.
    Unknown(String),
    /// The animation cannot be played.
    Broken(String),
}

impl NoClip {
    /// In words.
    pub(crate) fn reason(self) -> String {
        match self {
            Self::Unknown(reason) | Self::Broken(reason) => reason,
        }
    }

    pub(crate) fn is_broken(&self) -> bool {
        matches!(self, Self::Broken(_))
    }
}

/// Adds the clips of a mesh's weights. The node is the one that shows the mesh; if none is given, the main one.
///
/// Animations that cannot be played are left out with a warning, which is printed once for each.
pub fn read_clips(
    files: &FileArgs,
    file: &GltfFile,
    index: usize,
    node: Option<usize>,
    mesh: &mut MorphMesh,
    placement: Option<&Skeleton>,
) -> BrokenClips {
    let node = node.or_else(|| file.main_node(index));
    let clips = file.clips(index, node, mesh.targets.len());
    mesh.animations = clips.clips;
    let mut broken = BrokenClips::default();
    for error in clips.broken {
        if let ReadError::Animation { animation, .. } = error {
            broken.0.entry(animation).or_insert(CliError::from(error).to_string());
        }
    }
    let skeletons = [mesh.skin.as_ref().map(|skin| &skin.skeleton), placement];
    for clip in skeletons.into_iter().flatten().flat_map(|skeleton| &skeleton.broken) {
        broken.0.entry(clip.animation).or_insert_with(|| clip.reason.clone());
    }
    for (animation, reason) in &broken.0 {
        if files.told.is_news(file.path(), *animation) {
            messages::complain(format_args!("warning: left out: {reason}"));
        }
    }
    broken
}

impl BrokenClips {
    /// Adds those of another mesh.
    pub(crate) fn add(&mut self, other: Self) {
        for (animation, reason) in other.0 {
            self.0.entry(animation).or_insert(reason);
        }
    }

    /// Whether an animation is one of them.
    pub(crate) fn has(&self, animation: usize) -> bool {
        self.0.contains_key(&animation)
    }
}

impl ClipChoice {
    /// The clips of an animation, given by name or else by its index in the file. `placement` is how the node that shows the mesh moves.
    ///
    /// # Errors
    /// No clip of the body is part of such an animation, and the message says which animations there are; or the animation is `broken`.
    pub(crate) fn find(
        text: &str,
        file: &GltfFile,
        mesh: &MorphMesh,
        placement: Option<&Skeleton>,
        broken: &BrokenClips,
    ) -> Result<Self, NoClip> {
        let of_name = file.animation_named(text);
        let in_file = |&index: &usize| file.animation_name(index).is_some();
        let index = of_name.or_else(|| text.parse().ok().filter(in_file));
        if let Some(reason) = index.and_then(|index| broken.0.get(&index)) {
            return Err(NoClip::Broken(reason.clone()));
        }
        let of_index = || Self::named(file.animation_name(index?)?, mesh, placement);
        let found = Self::named(text, mesh, placement).or_else(of_index);
        found.ok_or_else(|| match index.and_then(|index| file.stray_animation(index)) {
            Some(error) => NoClip::Broken(CliError::from(error).to_string()),
            None => NoClip::Unknown(complaint(text, file, mesh, placement, broken)),
        })
    }

    /// The clips of exactly this name.
    pub(crate) fn named(name: &str, mesh: &MorphMesh, placement: Option<&Skeleton>) -> Option<Self> {
        let of_skeleton = |skeleton: Option<&Skeleton>| skeleton?.clips.iter().position(|clip| clip.name == name);
        let choice = Self {
            weights: mesh.animations.iter().position(|clip| clip.name == name),
            joints: of_skeleton(mesh.skin.as_ref().map(|skin| &skin.skeleton)),
            node: of_skeleton(placement),
        };
        (choice != Self::default()).then_some(choice)
    }

    /// Its length in seconds.
    pub(crate) fn duration(&self, mesh: &MorphMesh, placement: Option<&Skeleton>) -> f32 {
        let of_skeleton = |skeleton: Option<&Skeleton>, clip: Option<usize>| {
            let clip = skeleton?.clips.get(clip?)?;
            Some(clip.duration())
        };
        let of_weights = self
            .weights
            .and_then(|clip| Some(mesh.animations.get(clip)?.duration()));
        let of_joints = of_skeleton(mesh.skin.as_ref().map(|skin| &skin.skeleton), self.joints);
        let of_node = of_skeleton(placement, self.node);
        [of_weights, of_joints, of_node]
            .into_iter()
            .flatten()
            .fold(0.0, f32::max)
    }
}

/// The names of all animations that move a body and are not `broken`, in the order of the file.
pub(crate) fn clip_names(
    file: &GltfFile,
    mesh: &MorphMesh,
    placement: Option<&Skeleton>,
    broken: &BrokenClips,
) -> Vec<String> {
    let names = moving(file, mesh, placement, broken).into_iter();
    names.map(str::to_owned).collect()
}

/// Like [`clip_names`]. It takes time in proportion to the clips of the body, not to all animations of the file.
fn moving<'a>(
    file: &'a GltfFile,
    mesh: &MorphMesh,
    placement: Option<&Skeleton>,
    broken: &BrokenClips,
) -> Vec<&'a str> {
    let skeletons = [mesh.skin.as_ref().map(|skin| &skin.skeleton), placement];
    let of_skeletons = skeletons.into_iter().flatten().flat_map(|skeleton| &skeleton.clips);
    let names = mesh.animations.iter().map(|clip| &clip.name);
    let names = names.chain(of_skeletons.map(|clip| &clip.name));
    let indices = names.filter_map(|name| file.animation_named(name));
    let indices: BTreeSet<usize> = indices.filter(|index| !broken.has(*index)).collect();
    indices
        .into_iter()
        .filter_map(|index| file.animation_name(index))
        .collect()
}

/// Why a body has no clip of a name. Names are compared only if the file has no animation of this name, because bodies that an animation does
/// not move are common.
fn complaint(
    text: &str,
    file: &GltfFile,
    mesh: &MorphMesh,
    placement: Option<&Skeleton>,
    broken: &BrokenClips,
) -> String {
    let names = moving(file, mesh, placement, broken);
    let shown = Printable(text);
    let start = if file.animation_named(text).is_some() {
        format!("the animation \"{shown}\" does not move this mesh")
    } else {
        // Other meshes of the file may have a clip of a similar name.
        let in_file = file.animation_names();
        let in_file = || suggestion(text, in_file.iter().map(String::as_str));
        let hint = Some(suggestion(text, names.iter().copied())).filter(|hint| !hint.is_empty());
        let hint = hint.unwrap_or_else(in_file);
        if !hint.is_empty() {
            return format!("there is no clip \"{shown}\"{hint}");
        }
        format!("there is no clip \"{shown}\"")
    };
    match names.len() {
        0 => format!("{start}; no animation moves this mesh"),
        _ => format!("{start}; the mesh has {}", listed(&names)),
    }
}
