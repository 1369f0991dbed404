//! All plugins at once.

use bevy::app::PluginGroupBuilder;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use tracing::{debug, error};

use crate::bounds::MorphBoundsPlugin;
use crate::plugin::MorphCollisionPlugin;

/// Adds all plugins of this crate: [`MorphCollisionPlugin`], [`MorphBoundsPlugin`] and one plugin for each enabled feature.
///
/// | feature | plugin |
/// |---|---|
/// | `picking` | `MorphPickingPlugin` |
/// | `gizmos` | `MorphGizmosPlugin` |
/// | `diagnostics` | `MorphCollisionDiagnosticsPlugin` |
/// | `rapier` | `MorphRapierPlugin` |
/// | `avian` | `MorphAvianPlugin` |
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # let mut app = App::new();
/// app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin, MorphPlugins::default()));
/// ```
///
/// Works in any app, with or without a renderer. Without this group (or [`MorphCollisionPlugin`]), components of this crate have no
/// effect, and nothing can tell you so. Do not add its plugins a second time: Bevy panics and names the plugin.
///
/// If the counterpart of a plugin is missing (Bevy's picking or gizmos, `RapierPhysicsPlugin`, Avian's `PhysicsPlugins`), that plugin
/// does nothing. If you then use a component for a physics engine, a warning in the log says what is missing. The physics engine's
/// plugins may come before or after this group, and may run in any schedule.
///
/// You can leave plugins out or replace them, as in any [`PluginGroup`].
#[derive(Clone, Copy, Debug)]
pub struct MorphPlugins {
    schedule: InternedScheduleLabel,
}

impl MorphPlugins {
    /// Runs collision detection in a schedule of your choice; see [`MorphCollisionPlugin::new`].
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

/// Marks an app that added the whole group, so no plugin was requested by name.
struct InGroup;

impl Plugin for InGroup {
    fn build(&self, _: &mut App) {}
}

/// Logs that a plugin does nothing because another one is missing. This is an error unless the plugin came with the group. Returns
/// whether it is.
#[cfg_attr(
    not(any(feature = "picking", feature = "gizmos", feature = "rapier", feature = "avian")),
    allow(dead_code)
)]
pub(crate) fn missing(app: &App, message: &str) -> bool {
    let is_error = !app.is_plugin_added::<InGroup>();
    if is_error {
        error!("{message}");
    } else {
        debug!("{message}");
    }
    is_error
}
