//! The plugin and the order of its systems.

use bevy::app::AnimationSystems;
use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::mesh::mark_3d_meshes_as_changed_if_their_assets_changed;
use bevy::prelude::*;
use bevy::transform::TransformSystems;
use bevy::transform::systems::{mark_dirty_trees, propagate_parent_transforms, sync_simple_transforms};

use crate::body::{MorphBodyRoot, MorphColliderOf, MorphColliders};
use crate::body_events::{MorphBodyCollisionEnd, MorphBodyCollisionStart};
use crate::contacts::{MorphCollisions, MorphContact, MorphContactPoint};
use crate::continuous::MorphTeleported;
use crate::diagnostics::MorphCollisionDiagnostics;
use crate::events::{MorphCollidingEntities, MorphCollisionEnd, MorphCollisionEventsEnabled, MorphCollisionStart};
use crate::impact::{MorphFeatures, MorphImpact};
use crate::import::{DefaultMorphTreeSettings, ImportError, MorphTreeProgress, MorphTreeSettings, MorphTrees};
use crate::readiness::{MorphColliderFailed, MorphColliderReady, MorphColliderSceneReady};
use crate::self_collisions::{MorphSelfCollisionEnd, MorphSelfCollisionStart, MorphSelfCollisions, MorphSelfContact};
use crate::spatial::{
    MorphClosestPoints, MorphManifold, MorphProjection, MorphQueryFilter, MorphRayHit, MorphShapeHit, SpatialState,
};
use crate::{
    MorphCollider, MorphColliderDisabled, MorphColliderScene, MorphCollisionLayers, MorphCollisionMode,
    MorphCollisionSettings, MorphShape, MorphSurfaceAnchor,
};
use crate::{
    anchors, body_events, body_pairs, broad_phase, changes, collider, diagnostics, events, every_mesh, import, joints,
    misuse, narrow_phase, needs, readiness, scene, scene_outcomes, self_collisions, settings, velocities, weights,
};

/// Detects collisions between [`MorphCollider`]s: by default every frame, in [`PostUpdate`].
///
/// Usually you add it with [`MorphPlugins`](crate::MorphPlugins), which contains it.
///
/// To change how trees are built, insert [`DefaultMorphTreeSettings`] before you add the plugin.
#[derive(Clone, Copy, Debug)]
pub struct MorphCollisionPlugin {
    schedule: InternedScheduleLabel,
}

impl MorphCollisionPlugin {
    /// Runs collision detection in a schedule of your choice, usually [`FixedPostUpdate`].
    ///
    /// In any schedule other than [`PostUpdate`], the plugin first propagates transforms there, so that entities moved in
    /// [`FixedUpdate`] are at their new place. Morph weights are those of the last frame's animation. [Surface
    /// anchors](MorphSurfaceAnchor) still update in [`PostUpdate`]. For what [`MorphCollisions::started`] and
    /// [`MorphCollisions::ended`] return then, see [`MorphCollisions`](MorphCollisions#what-started-and-ended).
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::MorphCollisionPlugin;
    /// # let mut app = App::new();
    /// app.add_plugins(MorphCollisionPlugin::new(FixedPostUpdate));
    /// ```
    #[must_use]
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Default for MorphCollisionPlugin {
    fn default() -> Self {
        Self::new(PostUpdate)
    }
}

/// The stages of the plugin, in order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphCollisionSystems {
    /// Finds new colliders and builds the trees of their meshes. Always in [`PostUpdate`].
    Import,
    /// Reads the current morph weights and joint matrices.
    Weights,
    /// Places colliders in the world and finds the pairs whose boxes overlap.
    BroadPhase,
    /// Finds the triangles that intersect.
    NarrowPhase,
    /// Reports what started and ended.
    Events,
    /// Moves anchored entities to their place on the drawn surface. Always in [`PostUpdate`], even while paused.
    Anchors,
}

/// Builds the requested trees.
pub(crate) struct TreesPlugin;

impl Plugin for TreesPlugin {
    fn build(&self, app: &mut App) {
        // Right away, before anything is loaded; or later, if the glTF plugin is added after this one.
        #[cfg(feature = "gltf")]
        import::repair_split_meshes(app);
        app.init_resource::<DefaultMorphTreeSettings>()
            .init_resource::<MorphTrees>()
            .init_resource::<import::LoadFailures>()
            .init_resource::<import::FurtherInfluences>()
            .init_resource::<import::Said>()
            .register_type::<DefaultMorphTreeSettings>()
            .register_type::<MorphTreeSettings>()
            .register_type::<MorphTrees>()
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
                    import::follow_asset_events,
                    import::start_trees,
                    import::follow_load_failures.run_if(import::any_may_fail),
                    import::drop_unused_trees,
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

impl Plugin for MorphCollisionPlugin {
    fn build(&self, app: &mut App) {
        build(app, self.schedule);
    }

    fn finish(&self, app: &mut App) {
        needs::check_transforms(app);
    }
}

fn build(app: &mut App, schedule: InternedScheduleLabel) {
    if !app.is_plugin_added::<TreesPlugin>() {
        app.add_plugins(TreesPlugin);
    }
    app.init_resource::<broad_phase::Candidates>()
        .init_resource::<MorphCollisions>()
        .init_resource::<MorphCollisionDiagnostics>()
        .init_resource::<MorphCollisionSettings>()
        .init_resource::<diagnostics::Preparation>()
        .init_resource::<scene_outcomes::OpenScenes>()
        .init_resource::<velocities::RunTimes>()
        .init_resource::<SpatialState>()
        .add_message::<MorphCollisionStart>()
        .add_message::<MorphCollisionEnd>()
        .add_message::<MorphBodyCollisionStart>()
        .add_message::<MorphBodyCollisionEnd>()
        .add_message::<MorphSelfCollisionStart>()
        .add_message::<MorphSelfCollisionEnd>()
        .add_observer(collider::forget_collider)
        .add_observer(self_collisions::end_with_component)
        .add_observer(scene::forget_scene);
    #[cfg(feature = "gltf")]
    app.add_observer(scene_outcomes::open_again);
    register_types(app);
    misuse::add(app);

    use MorphCollisionSystems as Stage;
    let stages = || (Stage::Weights, Stage::BroadPhase, Stage::NarrowPhase, Stage::Events);
    use VisibilitySystems::{CalculateBounds, CheckVisibility, UpdateFrusta};
    app.configure_sets(schedule, stages().chain().run_if(settings::is_running))
        .configure_sets(
            PostUpdate,
            Stage::Anchors
                .after(Stage::Import)
                .after(Stage::Events)
                // Cameras and models may be anchored.
                .before(CalculateBounds)
                .before(UpdateFrusta)
                .before(CheckVisibility),
        );
    changes::follow_frames(app, schedule);
    if schedule == PostUpdate.intern() {
        app.configure_sets(schedule, stages().after(Stage::Import));
    } else {
        let propagate = (mark_dirty_trees, propagate_parent_transforms, sync_simple_transforms);
        app.add_systems(
            schedule,
            propagate.chain().before(Stage::Weights).run_if(settings::is_running),
        );
    }
    app.add_systems(
        PostUpdate,
        (
            (
                scene::update_scene_parts,
                every_mesh::update_every_deforming_mesh,
                import::request_trees,
            )
                .chain()
                .after(import::follow_asset_events)
                .before(import::start_trees),
            (
                readiness::report_readiness,
                scene_outcomes::report_outcomes.run_if(scene_outcomes::any_is_open),
            )
                .chain()
                .after(import::finish_trees),
        )
            .in_set(Stage::Import),
    )
    .add_systems(
        schedule,
        (
            (
                diagnostics::begin_run,
                velocities::remember,
                import::hand_out_trees,
                weights::read_weights,
                joints::read_joints,
            )
                .chain()
                .in_set(Stage::Weights),
            broad_phase::find_candidates.in_set(Stage::BroadPhase),
            (
                narrow_phase::find_contacts,
                body_pairs::pair_bodies,
                self_collisions::find_self_collisions,
            )
                .chain()
                .in_set(Stage::NarrowPhase),
            (
                events::report_changes,
                body_events::report_body_changes,
                events::list_colliding_entities,
                self_collisions::report_self_collisions,
            )
                .chain()
                .in_set(Stage::Events),
            changes::begin_empty_run
                .before(Stage::Weights)
                .run_if(not(settings::is_running)),
        ),
    )
    .add_systems(PostUpdate, anchors::follow_surfaces.in_set(Stage::Anchors));
}

fn register_types(app: &mut App) {
    app.register_type::<MorphCollider>()
        .register_type::<MorphColliderDisabled>()
        .register_type::<MorphColliderScene>()
        .register_type::<MorphCollisionLayers>()
        .register_type::<MorphColliderOf>()
        .register_type::<MorphColliders>()
        .register_type::<MorphBodyRoot>()
        .register_type::<MorphBodyCollisionStart>()
        .register_type::<MorphBodyCollisionEnd>()
        .register_type::<MorphShape>()
        .register_type::<MorphSurfaceAnchor>()
        .register_type::<MorphCollisionMode>()
        .register_type::<MorphCollidingEntities>()
        .register_type::<MorphCollisionEventsEnabled>()
        .register_type::<MorphCollisionStart>()
        .register_type::<MorphCollisionEnd>()
        .register_type::<MorphCollisionSettings>()
        .register_type::<MorphCollisionDiagnostics>()
        .register_type::<MorphCollisions>()
        .register_type::<MorphContact>()
        .register_type::<MorphContactPoint>()
        .register_type::<MorphImpact>()
        .register_type::<MorphFeatures>()
        .register_type::<MorphTeleported>()
        .register_type::<MorphRayHit>()
        .register_type::<MorphSelfCollisions>()
        .register_type::<MorphSelfContact>()
        .register_type::<MorphSelfCollisionStart>()
        .register_type::<MorphSelfCollisionEnd>()
        .register_type::<MorphProjection>()
        .register_type::<MorphShapeHit>()
        .register_type::<MorphClosestPoints>()
        .register_type::<MorphManifold>()
        .register_type::<MorphQueryFilter>()
        .register_type::<MorphTreeProgress>()
        .register_type::<ImportError>()
        .register_type::<MorphColliderReady>()
        .register_type::<MorphColliderFailed>()
        .register_type::<MorphColliderSceneReady>();
}
