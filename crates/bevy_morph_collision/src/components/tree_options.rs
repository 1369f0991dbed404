//! How trees are built.

use bevy::prelude::*;
use morph_collision::{BuildOptions, InputError};

/// How trees are built, for all meshes ([`MorphCollisionSettings::tree_options`](crate::components::MorphCollisionSettings)) or, as a
/// component, for the mesh of one collider. Colliders with equal options share a tree.
///
/// Options never affect answers: when you change them, the old trees stay in use until the new ones are built. An invalid leaf size is an
/// error in the log: for all meshes, the last good one stays in use; for one collider, the collider is left out.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # let mut app = App::new();
/// app.insert_resource(MorphCollisionSettings { tree_options: MorphTreeOptions { leaf_size: 16 }, ..default() });
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Component, Debug, Default, Clone, PartialEq, Hash)]
pub struct MorphTreeOptions {
    /// A node with at most this many triangles becomes a leaf; 1 to 255. The default is 8.
    #[reflect(@1..=u8::MAX)]
    pub leaf_size: u8,
}

impl Default for MorphTreeOptions {
    fn default() -> Self {
        Self {
            leaf_size: BuildOptions::default().leaf_size() as u8,
        }
    }
}

impl MorphTreeOptions {
    /// The core's options, or an error that names the invalid one.
    pub(crate) fn build_options(&self) -> Result<BuildOptions, InputError> {
        BuildOptions::default().with_leaf_size(self.leaf_size.into())
    }
}
