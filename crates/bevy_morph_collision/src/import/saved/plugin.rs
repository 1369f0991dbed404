//! The plugin for files of trees.

use bevy::prelude::*;

use super::file::{Loader, MorphTreeFile, MorphTreeFrom};
use super::store::Store;

/// Restores the trees that `morph-collide bake` saved, instead of building them, so that colliders are ready as soon as their meshes are loaded.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # let mut app = App::new();
/// app.add_plugins((DefaultPlugins, MorphPlugins, MorphTreeFilesPlugin::default()));
/// ```
///
/// Run `morph-collide bake boss.glb`, ship `boss.glb.morphtree` beside `boss.glb`, and add this plugin. While Bevy loads `boss.glb`, it reads the
/// other file, too (feature `gltf`, on by default), and restores the trees on the loader's thread, from the meshes that the loader made. A
/// restored tree is kept until a collider first uses it, or until the mesh is changed or removed. Files elsewhere need a
/// [`MorphTreeFrom`] on the entity.
///
/// A file never changes an answer. It has a hash of each mesh; if the mesh, the number of joints or [`MorphTreeOptions`](crate::components::MorphTreeOptions)
/// differ, or the file is damaged or of another version, a warning says so, and the tree is built as without this plugin. A model without a
/// file is loaded as without this plugin, and the log says nothing. The plugin asks for a file beside *every* model: over HTTP, this is a
/// request per model, and browsers list those that are not found. Set [`beside_models`](Self::beside_models) to `false` if only a few models have one.
///
/// It needs one of the plugins that build trees, such as [`MorphPlugins`](crate::plugins::MorphPlugins). It is not part of that group.
#[derive(Clone, Copy, Debug)]
pub struct MorphTreeFilesPlugin {
    /// Looks for a file beside every glTF file that is loaded. On by default.
    pub beside_models: bool,
}

impl Default for MorphTreeFilesPlugin {
    fn default() -> Self {
        Self { beside_models: true }
    }
}

impl Plugin for MorphTreeFilesPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Store>().register_type::<MorphTreeFrom>();
        add_loader(app);
    }

    fn finish(&self, app: &mut App) {
        add_loader(app);
        #[cfg(feature = "gltf")]
        if self.beside_models {
            super::beside::look_beside_models(app);
        }
    }
}

/// Once, as soon as `AssetPlugin` is there.
fn add_loader(app: &mut App) {
    let world = app.world();
    if world.contains_resource::<AssetServer>() && !world.contains_resource::<Assets<MorphTreeFile>>() {
        app.init_asset::<MorphTreeFile>().init_asset_loader::<Loader>();
    }
}
