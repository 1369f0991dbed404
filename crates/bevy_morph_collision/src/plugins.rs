//! All plugins at once.

use bevy::app::PluginGroupBuilder;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use tracing::{debug, error};

use crate::bounds::MorphBoundsPlugin;
use crate::plugin::MorphCollisionPlugin;

/// [`MorphCollisionPlugin`], [`MorphBoundsPlugin`] and, with the crate's features of these names, `MorphPickingPlugin` (`picking`),
/// `MorphGizmosPlugin` (`gizmos`), `MorphCollisionDiagnosticsPlugin` (`diagnostics`), `MorphRapierPlugin` (`rapier`) and `MorphAvianPlugin` (`avian`).
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # let mut app = App::new();
/// app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin, MorphPlugins::default()));
/// ```
///
/// Works in any app, with a renderer or without: a plugin of the group whose counterpart is missing (Bevy's picking or gizmos,
/// `RapierPhysicsPlugin`, Avian's `PhysicsPlugins`) does nothing, and logs no error. One condition remains: the physics engine's plugins must be
/// added before this group.
///
/// Leave plugins out or replace them as in any [`PluginGroup`]. `MorphRapierPlugin` is for physics in [`PostUpdate`], Rapier's default, and
/// `MorphAvianPlugin` in [`FixedPostUpdate`], Avian's. If your physics runs in another schedule, name it:
/// `MorphPlugins::new(FixedPostUpdate).set(MorphRapierPlugin::new(FixedUpdate))`.
#[derive(Clone, Copy, Debug)]
pub struct MorphPlugins {
    schedule: InternedScheduleLabel,
}

impl MorphPlugins {
    /// The plugins with collision detection in a schedule of your choice; see [`MorphCollisionPlugin::new`].
    #[must_use]
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Default for MorphPlugins {
    fn default() -> Self {
        Self::new(PostUpdate)
    }
}

impl PluginGroup for MorphPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>()
            .add(InGroup)
            .add(MorphCollisionPlugin::new(self.schedule))
            .add(MorphBoundsPlugin);
        #[cfg(feature = "picking")]
        let group = group.add(crate::picking::MorphPickingPlugin);
        #[cfg(feature = "gizmos")]
        let group = group.add(crate::gizmos::MorphGizmosPlugin);
        #[cfg(feature = "diagnostics")]
        let group = group.add(crate::diagnostics::MorphCollisionDiagnosticsPlugin);
        #[cfg(feature = "rapier")]
        let group = group.add(crate::rapier::MorphRapierPlugin::default());
        #[cfg(feature = "avian")]
        let group = group.add(crate::avian::MorphAvianPlugin::default());
        group
    }
}

/// Marks an app to which the whole group was added: nobody asked for each plugin by name.
struct InGroup;

impl Plugin for InGroup {
    fn build(&self, _: &mut App) {}
}

/// Logs that a plugin does nothing because another one is missing: an error, unless it came with the group.
#[cfg_attr(
    not(any(feature = "picking", feature = "gizmos", feature = "rapier", feature = "avian")),
    allow(dead_code)
)]
pub(crate) fn missing(app: &App, message: &str) {
    if app.is_plugin_added::<InGroup>() {
        debug!("{message}");
    } else {
        error!("{message}");
    }
}
