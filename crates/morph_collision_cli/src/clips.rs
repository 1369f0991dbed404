//! Reads the clips of a body, and finds one by the name or index of an animation.

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use morph_collision_testkit::gltf_read::{GltfFile, ReadError};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::nearest::suggestion;
use morph_collision_testkit::printable::Printable;
use morph_collision_testkit::skeleton::Skeleton;

use crate::error::CliError;
use crate::model_file::FileArgs;
use crate::output;

/// What an animation moves of a body: indices into the clips of its weights, of its joints and of the node that shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ClipChoice {
    pub(crate) weights: Option<usize>,
    pub(crate) joints: Option<usize>,
    pub(crate) node: Option<usize>,
}

/// At most this many names are listed in a message.
const MOST_NAMES: usize = 12;

/// The animations that cannot be played for a body, by their indices in the file, and why.
#[derive(Clone, Debug, Default)]
pub(crate) struct BrokenClips(BTreeMap<usize, String>);

/// The animations that a warning was printed for.
#[derive(Debug, Default)]
pub(crate) struct ToldClips(Mutex<HashSet<(PathBuf, usize)>>);

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
pub(crate) fn read_clips(
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
            output::complain(format_args!("warning: left out: {reason}"));
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

impl ToldClips {
    /// Whether this is the first time that it is asked about an animation.
    fn is_news(&self, file: &Path, animation: usize) -> bool {
        let told = self.0.lock();
        let mut told = told.unwrap_or_else(PoisonError::into_inner);
        told.insert((file.to_owned(), animation))
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
        let names = file.animation_names();
        let of_name = names.iter().position(|name| name == text);
        let index = of_name.or_else(|| text.parse().ok().filter(|&index: &usize| index < names.len()));
        if let Some(reason) = index.and_then(|index| broken.0.get(&index)) {
            return Err(NoClip::Broken(reason.clone()));
        }
        let of_index = || Self::named(names.get(index?)?, mesh, placement);
        let found = Self::named(text, mesh, placement).or_else(of_index);
        let stray =
            |error: &ReadError| matches!(error, ReadError::Animation { animation, .. } if Some(*animation) == index);
        found.ok_or_else(|| match file.stray_animations().into_iter().find(stray) {
            Some(error) => NoClip::Broken(CliError::from(error).to_string()),
            None => NoClip::Unknown(complaint(text, file, mesh, placement, broken)),
        })
    }

    fn named(name: &str, mesh: &MorphMesh, placement: Option<&Skeleton>) -> Option<Self> {
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
    let names = file.animation_names().into_iter().enumerate();
    let moves =
        |(index, name): &(usize, String)| !broken.has(*index) && ClipChoice::named(name, mesh, placement).is_some();
    names.filter(moves).map(|(_, name)| name).collect()
}

fn complaint(
    text: &str,
    file: &GltfFile,
    mesh: &MorphMesh,
    placement: Option<&Skeleton>,
    broken: &BrokenClips,
) -> String {
    let names = clip_names(file, mesh, placement, broken);
    let shown = Printable(text);
    let in_file = file.animation_names();
    // Other meshes of the file may have a clip of a similar name.
    let hints = [&names, &in_file].map(|names| suggestion(text, names.iter().map(String::as_str)));
    let exists = in_file.iter().any(|name| name == text);
    if !exists && let Some(hint) = hints.iter().find(|hint| !hint.is_empty()) {
        return format!("there is no clip \"{shown}\"{hint}");
    }
    let start = if exists {
        format!("the animation \"{shown}\" does not move this mesh")
    } else {
        format!("there is no clip \"{shown}\"")
    };
    let quoted = |name: &String| format!("\"{}\"", Printable(name));
    let list: Vec<String> = names.iter().take(MOST_NAMES).map(quoted).collect();
    match names.len() {
        0 => format!("{start}; no animation moves this mesh"),
        count if count > MOST_NAMES => format!("{start}; the mesh has {count} clips: {}, ...", list.join(", ")),
        _ => format!("{start}; the mesh has {}", list.join(", ")),
    }
}
