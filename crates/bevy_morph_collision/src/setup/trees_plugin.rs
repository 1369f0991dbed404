//! The systems that build trees, shared by collisions and culling.

use bevy::app::AnimationSystems;
use bevy::asset::AssetEventSystems;
use bevy::mesh::mark_3d_meshes_as_changed_if_their_assets_changed;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

use super::needs;
use super::users::drop_unused_trees;
use crate::app::MorphCollisionSystems;
use crate::import::{self, ImportError, MorphTreeProgress, MorphTrees};

/// Builds the requested trees.
pub(crate) struct TreesPlugin;

impl Plugin for TreesPlugin {
    fn build(&self, app: &mut App) {
        // Right away, before anything is loaded; or later, if the glTF plugin is added after this one.
        #[cfg(feature = "gltf")]
        import::repair_split_meshes(app);
        app.init_resource::<MorphTrees>()
            .init_resource::<import::LoadFailures>()
            .init_resource::<import::FurtherInfluences>()
            .init_resource::<import::LoggedErrors>()
            .register_type::<MorphTrees>()
            .register_type::<MorphTreeProgress>()
            .register_type::<ImportError>()
            .configure_sets(
                PostUpdate,
                MorphCollisionSystems::Import
                    .after(AnimationSystems)
                    .after(TransformSystems::Propagate)
                    .after(AssetEventSystems)
                    .after(mark_3d_meshes_as_changed_if_their_assets_changed),
            )
            .add_systems(
                PostUpdate,
                (
                    import::apply_asset_events,
                    import::start_trees,
                    import::update_load_failures.run_if(import::any_may_fail),
                    drop_unused_trees,
                    import::finish_trees,
                )
                    .chain()
                    .in_set(MorphCollisionSystems::Import),
            );
    }

    fn finish(&self, app: &mut App) {
        #[cfg(feature = "gltf")]
        import::repair_split_meshes(app);
        needs::check_meshes(app);
        needs::check_collisions(app);
    }
}
