//! Finds the physics engine in an app, and says what is missing.

use std::marker::PhantomData;

use bevy::ecs::schedule::InternedScheduleLabel;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use tracing::error;

use super::layout;
use super::schedule::choose;
use crate::app::missing;
use crate::contacts::MorphCollisions;

/// A physics engine.
pub(crate) trait Engine: Send + Sync + 'static {
    /// A resource that exists if the engine is in the app.
    type Present: Resource;
    /// This crate's plugin for it, and the engine's own plugin.
    const PLUGINS: [&'static str; 2];
    /// What to write to add them.
    const VALUES: [&'static str; 2];
    /// Says that no schedule has a step of the engine.
    const NO_STEP: &'static str;

    fn is_there(app: &App) -> bool;

    /// The schedules in which it steps.
    fn schedules(app: &App) -> Vec<InternedScheduleLabel>;

    /// Adds this crate's systems.
    fn build(app: &mut App, schedule: InternedScheduleLabel);
}

/// Whether the plugin has found the engine's schedule, or has logged what is missing.
#[derive(Resource)]
pub(crate) struct Settled<E: Engine>(PhantomData<E>);

/// Adds this crate's systems if the engine is there. Otherwise [`finish`] does, when all plugins are.
pub(crate) fn build<E: Engine>(app: &mut App, named: Option<InternedScheduleLabel>) {
    if E::is_there(app) && !E::schedules(app).is_empty() {
        install::<E>(app, named);
    }
}

/// Adds this crate's systems if that has not happened yet, and logs what is missing.
pub(crate) fn finish<E: Engine>(app: &mut App, named: Option<InternedScheduleLabel>) {
    if E::is_there(app) && !app.world().contains_resource::<Settled<E>>() {
        install::<E>(app, named);
    }
    let [plugin, engine] = E::PLUGINS;
    if !app.world().contains_resource::<MorphCollisions>() {
        let message = format!("{plugin} does nothing without MorphCollisionPlugin, which builds its trees");
        missing(app, &message);
    }
    if !E::is_there(app) {
        let message = format!("{plugin} does nothing without {engine}: add {engine} to the app");
        if missing(app, &message) {
            app.insert_resource(Settled::<E>(PhantomData));
        }
    }
    layout::add_to_trees(app);
}

fn install<E: Engine>(app: &mut App, named: Option<InternedScheduleLabel>) {
    app.insert_resource(Settled::<E>(PhantomData));
    let found = E::schedules(app);
    if let Some(schedule) = choose(&found, named, E::PLUGINS) {
        E::build(app, schedule);
    } else if found.is_empty() {
        error!("{}", E::NO_STEP);
    }
}

/// What an app lacks, so that components for the engine have no effect.
#[derive(SystemParam)]
pub(crate) struct Lacking<'w, E: Engine> {
    engine: Option<Res<'w, <E as Engine>::Present>>,
    settled: Option<Res<'w, Settled<E>>>,
}

impl<E: Engine> Lacking<'_, E> {
    /// The plugin that is missing, and what to write to add it. `None` if none is, or if the log says so already.
    pub(crate) fn plugin(&self) -> Option<[&'static str; 2]> {
        let missing = match (&self.settled, &self.engine) {
            (Some(_), _) => return None,
            (None, Some(_)) => 0,
            (None, None) => 1,
        };
        Some([E::PLUGINS[missing], E::VALUES[missing]])
    }
}
