//! How trees are built, for all meshes or for one entity.

use bevy::prelude::*;
use morph_collision::{BuildOptions, InputError};

/// How trees are built, for all meshes. It never affects answers. When you change it, trees are rebuilt; until then, the old ones
/// stay in use.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::{BuildOptions, MorphPlugins, DefaultMorphTreeSettings};
/// # let mut app = App::new();
/// app.insert_resource(DefaultMorphTreeSettings(BuildOptions::default().with_leaf_size(16)?));
/// app.add_plugins(MorphPlugins);
/// # Ok::<(), bevy_morph_collision::InputError>(())
/// ```
#[derive(Resource, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Resource, Clone, Debug, Default)]
pub struct DefaultMorphTreeSettings(#[reflect(ignore)] pub BuildOptions);

/// Overrides [`DefaultMorphTreeSettings`] for the mesh of one collider. Colliders with equal settings share a tree. It never
/// affects answers: when you change it, the old tree stays in use until the new one is built. With an invalid leaf size, the
/// collider is left out.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Component, Debug, Default, Clone, PartialEq, Hash)]
pub struct MorphTreeSettings {
    /// A node with at most this many triangles becomes a leaf; 1 to 255.
    pub leaf_size: u8,
}

impl Default for MorphTreeSettings {
    fn default() -> Self {
        Self {
            leaf_size: BuildOptions::default().leaf_size() as u8,
        }
    }
}

impl MorphTreeSettings {
    /// The app's options, overridden by these settings, or an error that names the invalid one.
    pub(crate) fn over(&self, options: BuildOptions) -> Result<BuildOptions, InputError> {
        options.with_leaf_size(self.leaf_size.into())
    }
}
