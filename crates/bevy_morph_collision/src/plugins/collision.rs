//! The collision plugin, and the order of its systems.

use bevy::camera::visibility::VisibilitySystems;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use bevy::transform::systems::{mark_dirty_trees, propagate_parent_transforms, sync_simple_transforms};

use super::schedule::MorphCollisionSchedule;
use crate::app::MorphCollisionSystems;
use crate::setup::TreesPlugin;
use crate::{
    broad_phase, components, contacts, events, import, misuse, narrow_phase, posing, rollback, self_collisions, setup,
    spatial, state, surface,
};

/// Detects collisions between [`MorphCollider`](crate::components::MorphCollider)s: by default every frame, in [`PostUpdate`].
///
/// [`MorphPlugins`](crate::plugins::MorphPlugins) contains it. On its own it is the lean way for a headless server:
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # let mut app = App::new();
/// app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin, MorphCollisionPlugin));
/// ```
///
/// To change how trees are built, set [`tree_options`](crate::components::MorphCollisionSettings::tree_options).
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphCollisionPlugin;

impl MorphCollisionPlugin {
    /// Runs collision detection in a schedule of your choice, usually [`FixedPostUpdate`]; see [`MorphCollisionSchedule`].
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::prelude::*;
    /// # let mut app = App::new();
    /// app.add_plugins(MorphCollisionPlugin.in_schedule(FixedPostUpdate));
    /// ```
    #[must_use]
    pub fn in_schedule(self, schedule: impl ScheduleLabel) -> (MorphCollisionSchedule, Self) {
        (MorphCollisionSchedule::new(schedule), self)
    }
}

impl Plugin for MorphCollisionPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<TreesPlugin>() {
            app.add_plugins(TreesPlugin);
        }
        components::register(app);
        contacts::add(app);
        state::add(app);
        posing::add_skeletons(app);
        broad_phase::add(app);
        narrow_phase::add(app);
        spatial::add(app);
        self_collisions::add(app);
        setup::add(app);
        events::add(app);
        surface::register(app);
        misuse::add(app);
        rollback::register(app);
        let schedule = MorphCollisionSchedule::of(app);
        order_stages(app, schedule);
        add_systems(app, schedule);
    }

    fn finish(&self, app: &mut App) {
        setup::check_transforms(app);
    }
}

/// Orders the stages among each other and among Bevy's systems.
fn order_stages(app: &mut App, schedule: InternedScheduleLabel) {
    use MorphCollisionSystems as Stage;
    let stages = || {
        (
            Stage::Weights,
            Stage::BroadPhase,
            Stage::NarrowPhase,
            Stage::Events,
            Stage::Casters,
        )
    };
    use VisibilitySystems::{CalculateBounds, CheckVisibility, UpdateFrusta};
    app.configure_sets(schedule, stages().chain().run_if(components::is_running))
        .configure_sets(
            PostUpdate,
            Stage::Anchors
                .after(Stage::Import)
                .after(Stage::Casters)
                // Cameras and models may be anchored.
                .before(CalculateBounds)
                .before(UpdateFrusta)
                .before(CheckVisibility),
        );
    events::show_fixed_runs_to_frames(app, schedule);
    if schedule == PostUpdate.intern() {
        app.configure_sets(schedule, stages().after(Stage::Import));
    } else {
        let propagate = (mark_dirty_trees, propagate_parent_transforms, sync_simple_transforms);
        app.add_systems(
            schedule,
            propagate.chain().before(Stage::Weights).run_if(components::is_running),
        );
    }
}

/// Adds the systems, stage by stage.
fn add_systems(app: &mut App, schedule: InternedScheduleLabel) {
    use MorphCollisionSystems as Stage;
    app.add_systems(
        PostUpdate,
        (
            (
                setup::update_scene_parts,
                setup::update_every_deforming_mesh,
                setup::request_trees,
            )
                .chain()
                .after(import::apply_asset_events)
                .before(import::start_trees),
            (
                setup::report_readiness,
                setup::report_outcomes.run_if(setup::any_is_open),
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
                state::begin_run,
                posing::remember_previous,
                setup::hand_out_trees,
                posing::read_weights,
                posing::read_joints,
            )
                .chain()
                .in_set(Stage::Weights),
            broad_phase::find_candidates.in_set(Stage::BroadPhase),
            (
                narrow_phase::find_contacts,
                narrow_phase::store_contacts,
                self_collisions::find_self_collisions,
            )
                .chain()
                .in_set(Stage::NarrowPhase),
            (
                events::report_changes,
                events::report_body_changes,
                events::list_colliding_entities,
                self_collisions::report_self_collisions,
            )
                .chain()
                .in_set(Stage::Events),
            spatial::casters().in_set(Stage::Casters),
            events::begin_empty_run
                .before(Stage::Weights)
                .run_if(not(components::is_running)),
        ),
    )
    .add_systems(PostUpdate, surface::move_anchors.in_set(Stage::Anchors));
}
