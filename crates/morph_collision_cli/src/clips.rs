//! Finds the clips of a body by the name or index of an animation.

use morph_collision_testkit::gltf_read::GltfFile;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::nearest::suggestion;
use morph_collision_testkit::printable::Printable;
use morph_collision_testkit::skeleton::Skeleton;

/// What an animation moves of a body: indices into the clips of its weights, of its joints and of the node that shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ClipChoice {
    pub(crate) weights: Option<usize>,
    pub(crate) joints: Option<usize>,
    pub(crate) node: Option<usize>,
}

/// At most this many names are listed in a message.
const MOST_NAMES: usize = 12;

impl ClipChoice {
    /// The clips of an animation, given by name or else by its index in the file. `placement` is how the node that shows the mesh moves.
    ///
    /// # Errors
    /// No clip of the body is part of such an animation. The message says which animations there are.
    pub(crate) fn find(
        text: &str,
        file: &GltfFile,
        mesh: &MorphMesh,
        placement: Option<&Skeleton>,
    ) -> Result<Self, String> {
        let of_index = || {
            let index: usize = text.parse().ok()?;
            Self::named(file.animation_names().get(index)?, mesh, placement)
        };
        let found = Self::named(text, mesh, placement).or_else(of_index);
        found.ok_or_else(|| complaint(text, file, mesh, placement))
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

/// The names of all animations that move a body, in the order of the file.
pub(crate) fn clip_names(file: &GltfFile, mesh: &MorphMesh, placement: Option<&Skeleton>) -> Vec<String> {
    let mut names = file.animation_names();
    names.retain(|name| ClipChoice::named(name, mesh, placement).is_some());
    names
}

fn complaint(text: &str, file: &GltfFile, mesh: &MorphMesh, placement: Option<&Skeleton>) -> String {
    let names = clip_names(file, mesh, placement);
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
