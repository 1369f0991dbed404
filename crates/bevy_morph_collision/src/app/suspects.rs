//! The entities to look at, and what has been logged.

use std::collections::VecDeque;
use std::time::Duration;

use bevy::ecs::entity::EntityHashSet;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use tracing::{error, warn};

/// How long an entity may lack something that its components need.
pub(crate) const PATIENCE: Duration = Duration::from_secs(5);
/// How many entities are looked at in a frame.
const PER_FRAME: usize = 256;
/// How many messages of a kind are logged.
const MAX_OF_A_KIND: usize = 10;

/// The entities to look at.
#[derive(Resource, Default)]
pub(crate) struct Suspects {
    new: VecDeque<Entity>,
    /// Entities to look at again, and when, in ascending order.
    later: VecDeque<(Duration, Entity)>,
    /// The entities in both lists.
    noted: EntityHashSet,
    /// The time, as far as it passed while there were suspects.
    now: Duration,
    log: WarnOnce,
}

impl Suspects {
    /// Notes an entity to look at in this frame.
    pub(crate) fn note(&mut self, entity: Entity) {
        if self.noted.insert(entity) {
            self.new.push_back(entity);
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.noted.is_empty()
    }

    /// Takes the entities to look at in this frame. True for those that are noted for the first time.
    pub(crate) fn take(&mut self, frame: Duration) -> Vec<(Entity, bool)> {
        self.now += frame;
        let count = self.new.len().min(PER_FRAME);
        let mut taken: Vec<(Entity, bool)> = self.new.drain(..count).map(|entity| (entity, true)).collect();
        let due = self.later.iter().take_while(|(due, _)| *due <= self.now).count();
        let due = self.later.drain(..due.min(PER_FRAME));
        taken.extend(due.map(|(_, entity)| (entity, false)));
        for (entity, _) in &taken {
            self.noted.remove(entity);
        }
        taken
    }

    /// Notes an entity to look at again when it had time to get what it lacks.
    pub(crate) fn note_for_later(&mut self, entity: Entity) {
        if self.noted.insert(entity) {
            self.later.push_back((self.now + PATIENCE, entity));
        }
    }

    pub(crate) fn log(&mut self) -> &mut WarnOnce {
        &mut self.log
    }
}

/// What has been logged.
#[derive(Default)]
pub(crate) struct WarnOnce(HashMap<&'static str, HashSet<String>>);

impl WarnOnce {
    /// Logs a warning of a kind, once for each subject: a file, or the name of an entity. A game may spawn the same mistake many times.
    pub(crate) fn warn(&mut self, kind: &'static str, about: String, message: impl FnOnce() -> String) {
        if let Some(rest) = self.news(kind, about) {
            warn!("{}{rest}", message());
        }
    }

    /// The same for an error.
    pub(crate) fn error(&mut self, kind: &'static str, about: String, message: impl FnOnce() -> String) {
        if let Some(rest) = self.news(kind, about) {
            error!("{}{rest}", message());
        }
    }

    /// Whether there is something to log: how the message ends.
    fn news(&mut self, kind: &'static str, about: String) -> Option<&'static str> {
        let subjects = self.0.entry(kind).or_default();
        if subjects.len() >= MAX_OF_A_KIND || !subjects.insert(about) {
            return None;
        }
        let is_last = subjects.len() == MAX_OF_A_KIND;
        Some(if is_last {
            ". Further ones like it are not logged"
        } else {
            ""
        })
    }
}
