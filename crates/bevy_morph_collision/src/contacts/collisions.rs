//! The contacts of the last run.

use std::collections::{BTreeMap, BTreeSet};

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;

use super::body_pairs::BodyPairs;
use super::changes::Changes;
use super::contact::MorphContact;
use super::impact::MorphImpact;

/// The colliders that touch, as of the last run of [`NarrowPhase`](crate::app::MorphCollisionSystems::NarrowPhase).
///
/// Use it as a system parameter: `Res<MorphCollisions>`. It answers questions about colliders ([`contains`](Self::contains),
/// [`get`](Self::get), [`collisions_with`](Self::collisions_with)) and about bodies ([`contains_bodies`](Self::contains_bodies),
/// [`collisions_between_bodies`](Self::collisions_between_bodies), [`bodies_colliding_with`](Self::bodies_colliding_with)).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// #[derive(Component)]
/// struct Wall;
///
/// fn count(collisions: Res<MorphCollisions>, walls: Query<Entity, With<Wall>>) {
///     for wall in &walls {
///         let triangles: usize = collisions.collisions_with(wall).map(|contact| contact.triangles.len()).sum();
///         println!("{triangles} pairs of triangles touch the wall");
///     }
/// }
/// # App::new().add_systems(Update, count);
/// ```
///
/// # What started and ended
///
/// A system that runs once per frame or tick sees every change exactly once in [`MorphCollisions::started`] and
/// [`MorphCollisions::ended`]. They are empty while the plugin is paused. Which changes they show depends on the plugin's
/// schedule:
///
/// - [`PostUpdate`] (the default), or any other schedule that runs once per frame: the changes of the last run. Systems that run
///   earlier in the frame see those of the previous frame.
/// - A fixed schedule, for example [`FixedPostUpdate`]: systems in fixed schedules see the changes of the last run. All other
///   systems see the changes of all runs of this frame together, and none in a frame without a tick.
/// - A schedule of your own: the changes of its last run, until it runs again.
///
/// The messages [`MorphCollisionStart`](crate::events::MorphCollisionStart) and [`MorphCollisionEnd`](crate::events::MorphCollisionEnd) do not
/// depend on the schedule: they report every change.
#[derive(Resource, Reflect, Clone, Debug, Default)]
#[reflect(Resource, Debug, Default)]
pub struct MorphCollisions {
    #[reflect(ignore)]
    pub(super) current: BTreeMap<(Entity, Entity), MorphContact>,
    /// What each collider touches.
    #[reflect(ignore)]
    pub(super) neighbours: EntityHashMap<BTreeSet<Entity>>,
    /// The same contacts, grouped by bodies.
    #[reflect(ignore)]
    pub(crate) bodies: BodyPairs,
    #[reflect(ignore)]
    pub(crate) changes: Changes,
}

impl MorphCollisions {
    /// All contacts, in ascending order of their colliders.
    pub fn iter(&self) -> impl Iterator<Item = &MorphContact> {
        self.current.values()
    }

    /// The contacts of one collider, in ascending order. Takes time for these contacts only.
    pub fn collisions_with(&self, collider: Entity) -> impl Iterator<Item = &MorphContact> {
        let neighbours = self.neighbours.get(&collider).into_iter().flatten();
        neighbours.filter_map(move |&other| self.get(collider, other))
    }

    /// Whether two colliders touch, in either order.
    #[must_use]
    pub fn contains(&self, a: Entity, b: Entity) -> bool {
        self.get(a, b).is_some()
    }

    /// The contact of two colliders, in either order. The contact itself has them in ascending order.
    #[must_use]
    pub fn get(&self, a: Entity, b: Entity) -> Option<&MorphContact> {
        self.current.get(&(a.min(b), a.max(b)))
    }

    /// The number of contacts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.current.len()
    }

    /// Whether there are no contacts.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.current.is_empty()
    }

    /// Contacts that started. [Which ones](MorphCollisions#what-started-and-ended) depends on where you call this.
    ///
    /// A contact that started and ended within one frame is in the state in which it ended. One that started several times in a frame is
    /// listed as often, each time in its last state.
    pub fn started(&self) -> impl Iterator<Item = &MorphContact> {
        let ended = |pair: &(Entity, Entity)| {
            let is_one = |contact: &&MorphContact| contact.pair() == *pair;
            self.changes.ended.iter().rev().find(is_one)
        };
        let started = self.changes.started().iter();
        started.filter_map(move |pair| self.current.get(pair).or_else(|| ended(pair)))
    }

    /// Contacts that ended, in their last state. [Which ones](MorphCollisions#what-started-and-ended) depends on where you call
    /// this.
    pub fn ended(&self) -> impl Iterator<Item = &MorphContact> {
        self.changes.ended().iter()
    }

    /// Contacts that started in the last run.
    pub(crate) fn started_in_run(&self) -> impl Iterator<Item = &MorphContact> {
        let started = self.changes.started_in_run().iter();
        started.filter_map(|&pair| self.in_run(pair))
    }

    /// A contact that lasts, or that began and ended in the last run.
    pub(crate) fn in_run(&self, pair: (Entity, Entity)) -> Option<&MorphContact> {
        let passed = self.changes.passed_in_run();
        let index = || passed.binary_search_by_key(&pair, MorphContact::pair).ok();
        self.current.get(&pair).or_else(|| passed.get(index()?))
    }

    /// Goes back to an earlier run.
    pub(crate) fn restore(&mut self, earlier: Self) {
        self.changes.restore(earlier.changes);
        self.current = earlier.current;
        self.neighbours = earlier.neighbours;
        self.bodies = earlier.bodies;
    }

    /// Begins a run, in which nothing has started or ended yet.
    pub(crate) fn begin_run(&mut self) {
        self.changes.begin_run();
    }

    /// Ends the contacts of pairs that may not touch any more.
    pub(crate) fn end_unless(&mut self, may_touch: impl Fn((Entity, Entity)) -> bool) {
        for (pair, contact) in self.current.extract_if(.., |pair, _| !may_touch(*pair)) {
            forget(&mut self.neighbours, pair);
            self.changes.ended.push(contact);
        }
    }

    /// How a contact began that was just found. If it lasts, that is known already, unless only margins touched.
    pub(crate) fn impact_of(&self, contact: &MorphContact) -> Option<MorphImpact> {
        match self.current.get(&contact.pair()) {
            Some(before) if before.distance == 0.0 || contact.impact.is_none() => before.impact,
            _ => contact.impact,
        }
    }

    /// Two colliders touch: starts their contact, or updates it.
    pub(crate) fn touch(&mut self, contact: MorphContact) {
        let (pair, impact) = (contact.pair(), self.impact_of(&contact));
        if let Some(before) = self.current.get_mut(&pair) {
            *before = MorphContact { impact, ..contact };
        } else {
            self.current.insert(pair, contact);
            self.neighbours.entry(pair.0).or_default().insert(pair.1);
            self.neighbours.entry(pair.1).or_default().insert(pair.0);
            self.changes.started.push(pair);
        }
    }

    /// Two colliders whose margins touched have touched since the last run, but are apart now.
    pub(crate) fn pass(&mut self, contact: MorphContact) {
        let pair = contact.pair();
        self.touch(contact);
        self.part(pair);
    }

    /// Two colliders do not touch: ends their contact if there is one.
    pub(crate) fn part(&mut self, pair: (Entity, Entity)) {
        if let Some(contact) = self.current.remove(&pair) {
            forget(&mut self.neighbours, pair);
            self.changes.ended.push(contact);
        }
    }

    /// Ends a run in which pairs were compared. `passed` are contacts that began and ended within it.
    pub(crate) fn end_run(&mut self, passed: Vec<MorphContact>) {
        self.changes.end_run(passed);
        self.pair_bodies();
    }
}

/// Two colliders do not touch any more.
fn forget(neighbours: &mut EntityHashMap<BTreeSet<Entity>>, pair: (Entity, Entity)) {
    for (collider, other) in [pair, (pair.1, pair.0)] {
        if let Some(of) = neighbours.get_mut(&collider) {
            of.remove(&other);
            if of.is_empty() {
                neighbours.remove(&collider);
            }
        }
    }
}
