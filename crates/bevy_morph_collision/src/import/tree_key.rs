//! The key that determines which tree an entity uses.

use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use crate::components::MorphTreeOptions;

/// A mesh as an entity shows it. Entities with equal keys share a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TreeKey {
    pub(crate) mesh: AssetId<Mesh>,
    /// The entity's own options, if it has any.
    pub(crate) options: Option<MorphTreeOptions>,
    /// The number of joints of the skeleton with which the mesh is shown, if any.
    pub(crate) joints: Option<usize>,
}

impl TreeKey {
    pub(crate) fn of(mesh: &Mesh3d, options: Option<&MorphTreeOptions>, skin: Option<&SkinnedMesh>) -> Self {
        Self {
            mesh: mesh.id(),
            options: options.copied(),
            joints: skin.map(|skin| skin.joints.len()),
        }
    }
}
