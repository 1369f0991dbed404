//! All plugins at once.

use bevy::app::PluginGroupBuilder;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

use super::collision::MorphCollisionPlugin;
use super::schedule::MorphCollisionSchedule;
use crate::app::InGroup;
use crate::bounds::MorphBoundsPlugin;

/// Adds all plugins of this crate: [`MorphCollisionPlugin`], [`MorphBoundsPlugin`] and one plugin for each enabled feature.
///
/// | feature | plugin |
/// |---|---|
/// | `picking` | `MorphPickingPlugin` |
/// | `gizmos` | `MorphGizmosPlugin` |
/// | `diagnostics` | `MorphCollisionDiagnosticsPlugin` |
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # let mut app = App::new();
/// app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin, MorphPlugins));
/// ```
///
/// Works in any app, with or without a renderer. Without this group (or [`MorphCollisionPlugin`]), components of this crate have no
/// effect, and nothing can tell you so. Do not add its plugins a second time: Bevy panics and names the plugin.
///
/// If the counterpart of a plugin is missing (Bevy's picking or gizmos), that plugin does nothing.
///
/// A physics engine needs one more plugin, `MorphRapierPlugin` of the crate `bevy_morph_rapier` or `MorphAvianPlugin` of
/// `bevy_morph_avian`. It and the engine's own plugins may come before or after this group, and may run in any schedule.
///
/// You can leave plugins out or replace them, as in any [`PluginGroup`].
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphPlugins;

impl MorphPlugins {
    /// The same plugins, with collision detection in a schedule of your choice; see [`MorphCollisionSchedule`].
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::prelude::*;
    /// # let mut app = App::new();
    /// app.add_plugins(MorphPlugins.in_schedule(FixedPostUpdate));
    /// ```
    #[must_use]
    pub fn in_schedule(self, schedule: impl ScheduleLabel) -> PluginGroupBuilder {
        let schedule = MorphCollisionSchedule::new(schedule);
        self.build().add_before::<MorphCollisionPlugin>(schedule)
    }
}

impl PluginGroup for MorphPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>()
            .add(InGroup)
            .add(MorphCollisionPlugin)
            .add(MorphBoundsPlugin);
        #[cfg(feature = "picking")]
        let group = group.add(crate::surface::MorphPickingPlugin);
        #[cfg(feature = "gizmos")]
        let group = group.add(crate::debug::MorphGizmosPlugin);
        #[cfg(feature = "diagnostics")]
        let group = group.add(crate::debug::MorphCollisionDiagnosticsPlugin);
        group
    }
}
