//! Groups the contacts of colliders by pairs of bodies.

use bevy::prelude::*;

use super::contact::MorphContact;

/// Two entities in ascending order.
pub(crate) type Pair = (Entity, Entity);

/// The contacts of the last run in which pairs were compared and of the one before, grouped by bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyPairs {
    /// The two bodies and the two colliders of each contact, ascending.
    pub(super) now: Vec<(Pair, Pair)>,
    pub(super) before: Vec<(Pair, Pair)>,
    /// The same of contacts that began and ended in the last run.
    pub(super) passed: Vec<(Pair, Pair)>,
    /// All of `now` and `passed`, if anything passed.
    pub(super) touched: Vec<(Pair, Pair)>,
    /// The two bodies of each pair in descending order, ascending.
    descending: Vec<Pair>,
}

impl BodyPairs {
    /// Replaces the contacts after a run in which colliders were compared.
    pub(super) fn replace<'a>(&mut self, contacts: impl Iterator<Item = &'a MorphContact>, passed: &[MorphContact]) {
        std::mem::swap(&mut self.now, &mut self.before);
        let entry = |contact: &MorphContact| (ascending(contact.body1, contact.body2), contact.pair());
        self.now.clear();
        self.now.extend(contacts.map(entry));
        // Already sorted if every collider is a body of its own.
        self.now.sort_unstable();
        self.find_descending();
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

    /// Updates the pairs in descending order.
    pub(super) fn find_descending(&mut self) {
        self.descending.clear();
        let pairs = self.now.chunk_by(|a, b| a.0 == b.0).map(|contacts| contacts[0].0);
        self.descending.extend(pairs.map(|(a, b)| (b, a)));
        self.descending.sort_unstable();
    }

    /// The contacts of two bodies.
    pub(super) fn between(&self, a: Entity, b: Entity) -> &[(Pair, Pair)] {
        let bodies = ascending(a, b);
        let start = self.now.partition_point(|&(of, _)| of < bodies);
        let end = self.now.partition_point(|&(of, _)| of <= bodies);
        &self.now[start..end]
    }

    /// The bodies that touch a body, ascending.
    pub(super) fn with(&self, body: Entity) -> impl Iterator<Item = Entity> {
        let start = self.descending.partition_point(|&(second, _)| second < body);
        let lower = self.descending[start..]
            .iter()
            .take_while(move |(second, _)| *second == body);
        let start = self.now.partition_point(|&((first, _), _)| first < body);
        let higher = self.now[start..]
            .chunk_by(|a, b| a.0 == b.0)
            .map(|contacts| contacts[0].0);
        let higher = higher.take_while(move |(first, _)| *first == body);
        lower.map(|&(_, first)| first).chain(higher.map(|(_, second)| second))
    }

    /// Pairs of bodies that started touching, with all of their contacts.
    pub(crate) fn started(&self) -> impl Iterator<Item = &[(Pair, Pair)]> {
        let touched = if self.passed.is_empty() {
            &self.now
        } else {
            &self.touched
        };
        news(touched, &self.before)
    }

    /// Pairs of bodies that stopped touching.
    pub(crate) fn ended(&self) -> impl Iterator<Item = Pair> {
        news(&self.before, &self.now).map(|contacts| contacts[0].0)
    }

    /// Pairs of bodies that started and stopped touching.
    pub(crate) fn passed(&self) -> impl Iterator<Item = Pair> {
        let were_apart = |bodies: &Pair| self.before.binary_search_by_key(bodies, |&(of, _)| of).is_err();
        news(&self.passed, &self.now)
            .map(|contacts| contacts[0].0)
            .filter(were_apart)
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
