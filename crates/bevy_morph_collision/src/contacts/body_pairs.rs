//! Groups the contacts of colliders by pairs of bodies.

use bevy::prelude::*;

use super::collisions::MorphCollisions;
use super::contact::MorphContact;

/// Two entities in ascending order.
pub(crate) type Pair = (Entity, Entity);

/// The contacts of the last run and of the run before, grouped by bodies.
#[derive(Debug, Default)]
pub(crate) struct BodyPairs {
    /// The two bodies and the two colliders of each contact, ascending.
    now: Vec<(Pair, Pair)>,
    before: Vec<(Pair, Pair)>,
    /// The same of contacts that began and ended in the last run.
    passed: Vec<(Pair, Pair)>,
    /// All of `now` and `passed`, if anything passed.
    touched: Vec<(Pair, Pair)>,
    /// Whether anything was compared in the last run. If not, `before` belongs to an earlier run.
    compared: bool,
}

impl BodyPairs {
    /// Replaces the contacts after a run in which colliders were compared.
    fn replace<'a>(&mut self, contacts: impl Iterator<Item = &'a MorphContact>, passed: &[MorphContact]) {
        std::mem::swap(&mut self.now, &mut self.before);
        let entry = |contact: &MorphContact| (ascending(contact.body1, contact.body2), contact.pair());
        self.now.clear();
        self.now.extend(contacts.map(entry));
        // Already sorted if every collider is a body of its own.
        self.now.sort_unstable();
        self.passed.clear();
        self.passed.extend(passed.iter().map(entry));
        self.passed.sort_unstable();
        self.touched.clear();
        if !passed.is_empty() {
            self.touched.extend_from_slice(&self.now);
            self.touched.extend_from_slice(&self.passed);
            self.touched.sort_unstable();
        }
    }

    /// The contacts of two bodies.
    fn between(&self, a: Entity, b: Entity) -> &[(Pair, Pair)] {
        let bodies = ascending(a, b);
        let start = self.now.partition_point(|&(of, _)| of < bodies);
        let end = self.now.partition_point(|&(of, _)| of <= bodies);
        &self.now[start..end]
    }

    /// Pairs of bodies that started touching, with all of their contacts.
    pub(crate) fn started(&self) -> impl Iterator<Item = &[(Pair, Pair)]> {
        let touched = match (self.compared, self.passed.is_empty()) {
            (false, _) => &[],
            (true, true) => &self.now[..],
            (true, false) => &self.touched[..],
        };
        news(touched, &self.before)
    }

    /// Pairs of bodies that stopped touching.
    pub(crate) fn ended(&self) -> impl Iterator<Item = Pair> {
        let before = if self.compared { &self.before[..] } else { &[] };
        news(before, &self.now).map(|contacts| contacts[0].0)
    }

    /// Pairs of bodies that started and stopped touching.
    pub(crate) fn passed(&self) -> impl Iterator<Item = Pair> {
        let passed = if self.compared { &self.passed[..] } else { &[] };
        let were_apart = |bodies: &Pair| self.before.binary_search_by_key(bodies, |&(of, _)| of).is_err();
        news(passed, &self.now).map(|contacts| contacts[0].0).filter(were_apart)
    }
}

/// Returns the contacts of each pair of bodies that is in one sorted list but not in the other, in one pass over both.
fn news<'l>(list: &'l [(Pair, Pair)], other: &'l [(Pair, Pair)]) -> impl Iterator<Item = &'l [(Pair, Pair)]> {
    let mut other = other.iter().map(|&(bodies, _)| bodies).peekable();
    list.chunk_by(|a, b| a.0 == b.0).filter(move |contacts| {
        let bodies = contacts[0].0;
        while other.next_if(|&other| other < bodies).is_some() {}
        other.peek() != Some(&bodies)
    })
}

fn ascending(a: Entity, b: Entity) -> Pair {
    (a.min(b), a.max(b))
}

/// Groups the contacts by bodies if they have changed since the previous run.
pub(crate) fn pair_bodies(mut collisions: ResMut<MorphCollisions>) {
    // Part of what the narrow phase writes, so it is no change of its own.
    let collisions = collisions.bypass_change_detection();
    collisions.bodies.compared = collisions.compared;
    if collisions.compared {
        let passed = collisions.changes.passed_in_run();
        collisions.bodies.replace(collisions.current.values(), passed);
    }
}

/// Bodies are the entities that [`MorphColliderOf`](crate::components::MorphColliderOf) names, and all colliders without that component.
impl MorphCollisions {
    /// Whether any colliders of two bodies touch. The order of the bodies does not matter.
    #[must_use]
    pub fn contains_bodies(&self, a: Entity, b: Entity) -> bool {
        !self.bodies.between(a, b).is_empty()
    }

    /// The contacts between the colliders of two bodies, in ascending order of the colliders. The order of the bodies does not
    /// matter; each contact keeps its own order.
    pub fn collisions_between_bodies(&self, a: Entity, b: Entity) -> impl Iterator<Item = &MorphContact> {
        let colliders = self.bodies.between(a, b).iter().map(|(_, colliders)| colliders);
        colliders.filter_map(|colliders| self.current.get(colliders))
    }

    /// The contacts of all colliders of a body, in ascending order. Iterates over all contacts.
    pub fn collisions_with_body(&self, body: Entity) -> impl Iterator<Item = &MorphContact> {
        self.iter()
            .filter(move |contact| contact.body1 == body || contact.body2 == body)
    }

    /// The bodies that touch a body, each once, in ascending order. Iterates over all contacts.
    pub fn bodies_colliding_with(&self, body: Entity) -> impl Iterator<Item = Entity> {
        let pairs = self
            .bodies
            .now
            .chunk_by(|a, b| a.0 == b.0)
            .map(|contacts| contacts[0].0);
        // Lower entities come first because the list is sorted by both bodies.
        pairs.filter_map(move |(a, b)| match body {
            _ if body == a => Some(b),
            _ if body == b => Some(a),
            _ => None,
        })
    }
}
