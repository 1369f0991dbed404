//! Collects the plugin's errors and warnings while a test runs.

use std::fmt::{Debug, Write};
use std::sync::{Arc, Mutex, PoisonError};

use bevy::app::App;
use bevy::ecs::schedule::{Schedules, SingleThreadedExecutor};
use morph_collision_workspace::app::ready;
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Metadata, Subscriber, span};

/// The plugin's errors and warnings, in order, from apps that this test [`start`]ed. Tests do not see each other's.
#[derive(Clone, Default)]
pub(crate) struct Errors(Arc<Mutex<Vec<(Level, String)>>>);

impl Errors {
    /// Runs a test's body and collects its log. The body can read what has been logged so far.
    pub(crate) fn collect(body: impl FnOnce(&Self)) {
        let errors = Self::default();
        tracing::subscriber::with_default(errors.clone(), || body(&errors));
    }

    /// The errors since the last call.
    pub(crate) fn take(&self) -> Vec<String> {
        self.take_level(Level::ERROR)
    }

    /// The warnings since the last call.
    pub(crate) fn take_warnings(&self) -> Vec<String> {
        self.take_level(Level::WARN)
    }

    fn take_level(&self, wanted: Level) -> Vec<String> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.extract_if(.., |(level, _)| *level == wanted)
            .map(|(_, text)| text)
            .collect()
    }
}

/// Makes the app ready for its first frame and runs its systems on this thread, where their log is collected.
///
/// Every app of these tests should start this way. Otherwise another test's thread may run one of its systems while waiting for
/// its own tasks, and then that test gets the log.
pub(crate) fn start(app: &mut App) {
    ready(app);
    run_here(app);
}

/// The part of [`start`] for an app that is ready already.
pub(crate) fn run_here(app: &mut App) {
    for (_, schedule) in app.world_mut().resource_mut::<Schedules>().iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
}

impl Subscriber for Errors {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        *metadata.level() <= Level::WARN && metadata.target().starts_with("bevy_morph_")
    }

    fn event(&self, event: &Event<'_>) {
        let mut text = Message(String::new());
        event.record(&mut text);
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push((*event.metadata().level(), text.0));
    }

    fn new_span(&self, _: &span::Attributes<'_>) -> span::Id {
        span::Id::from_u64(1)
    }

    fn record(&self, _: &span::Id, _: &span::Record<'_>) {}

    fn record_follows_from(&self, _: &span::Id, _: &span::Id) {}

    fn enter(&self, _: &span::Id) {}

    fn exit(&self, _: &span::Id) {}
}

struct Message(String);

impl Visit for Message {
    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        if field.name() == "message" {
            // Writing to a string cannot fail.
            let _ = write!(self.0, "{value:?}");
        }
    }
}
