//! Everything that started must end.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Debug;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::message::MessageCursor;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use serde::Serialize;

use crate::digest::Digest;

/// What has started and not ended, by the messages of all frames.
#[derive(Default)]
pub(crate) struct Balance {
    pub(crate) events: Events,
    open: BTreeSet<[Entity; 2]>,
    open_bodies: BTreeSet<[Entity; 2]>,
    open_regions: BTreeSet<(Entity, u32)>,
    starts: MessageCursor<MorphCollisionStart>,
    ends: MessageCursor<MorphCollisionEnd>,
    body_starts: MessageCursor<MorphBodyCollisionStart>,
    body_ends: MessageCursor<MorphBodyCollisionEnd>,
    self_starts: MessageCursor<MorphSelfCollisionStart>,
    self_ends: MessageCursor<MorphSelfCollisionEnd>,
}

/// Counts of messages.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Events {
    pub(crate) started: u64,
    pub(crate) ended: u64,
    pub(crate) bodies_started: u64,
    pub(crate) bodies_ended: u64,
    pub(crate) self_started: u64,
    pub(crate) self_ended: u64,
}

impl Balance {
    /// Reads the messages of a frame, and compares what is open with the plugin's lists.
    pub(crate) fn check(&mut self, world: &mut World, digest: &mut Digest) -> Result<(), String> {
        let mut changes = BTreeMap::<[Entity; 2], i64>::new();
        for end in self.ends.read(world.resource()) {
            self.events.ended += 1;
            digest.add(1);
            add_pair(&mut changes, digest, [end.collider1, end.collider2], -1);
        }
        for start in self.starts.read(world.resource()) {
            self.events.started += 1;
            digest.add(2);
            add_pair(&mut changes, digest, [start.collider1, start.collider2], 1);
            digest.vector(start.point);
            digest.vector(start.normal);
            digest.impact(start.impact);
        }
        apply(&mut self.open, std::mem::take(&mut changes), "colliders")?;

        for end in self.body_ends.read(world.resource()) {
            self.events.bodies_ended += 1;
            digest.add(3);
            add_pair(&mut changes, digest, [end.body1, end.body2], -1);
        }
        for start in self.body_starts.read(world.resource()) {
            self.events.bodies_started += 1;
            digest.add(4);
            add_pair(&mut changes, digest, [start.body1, start.body2], 1);
            digest.vector(start.point);
            digest.vector(start.normal);
        }
        apply(&mut self.open_bodies, changes, "bodies")?;

        let mut changes = BTreeMap::<(Entity, u32), i64>::new();
        for end in self.self_ends.read(world.resource()) {
            self.events.self_ended += 1;
            digest.add(5);
            digest.entity(end.collider);
            *changes.entry((end.collider, end.region)).or_default() -= 1;
        }
        for start in self.self_starts.read(world.resource()) {
            self.events.self_started += 1;
            digest.add(6);
            digest.entity(start.collider);
            digest.vector(start.point);
            *changes.entry((start.collider, start.region)).or_default() += 1;
        }
        apply(&mut self.open_regions, changes, "regions")?;
        self.compare(world)
    }

    fn compare(&mut self, world: &mut World) -> Result<(), String> {
        let collisions = world.resource::<MorphCollisions>();
        let (mut colliders, mut bodies) = (BTreeSet::new(), BTreeSet::new());
        for contact in collisions.iter() {
            colliders.insert([contact.collider1, contact.collider2]);
            bodies.insert(sorted([contact.body1, contact.body2]));
        }
        same(&self.open, &colliders, "colliders")?;
        same(&self.open_bodies, &bodies, "bodies")?;
        let mut lists = world.query_filtered::<(Entity, &MorphSelfCollisions), Allow<Disabled>>();
        let lists = lists.iter(world);
        let regions = lists.flat_map(|(entity, list)| list.regions().iter().map(move |part| (entity, part.region)));
        same(&self.open_regions, &regions.collect(), "regions")
    }

    /// Everything is despawned: nothing may touch any more.
    pub(crate) fn check_nothing(&self, world: &World) -> Result<(), String> {
        let left = self.open.len() + self.open_bodies.len() + self.open_regions.len();
        let contacts = world.resource::<MorphCollisions>().len();
        let colliders = world.resource::<MorphCollisionDiagnostics>().colliders;
        match (left, contacts, colliders) {
            (0, 0, 0) => Ok(()),
            _ => Err(format!(
                "everything is despawned, but {left} contacts have not ended, {contacts} are listed, and {colliders} colliders take part"
            )),
        }
    }
}

fn sorted(mut pair: [Entity; 2]) -> [Entity; 2] {
    pair.sort_unstable();
    pair
}

fn add_pair(changes: &mut BTreeMap<[Entity; 2], i64>, digest: &mut Digest, pair: [Entity; 2], by: i64) {
    pair.into_iter().for_each(|entity| digest.entity(entity));
    *changes.entry(sorted(pair)).or_default() += by;
}

/// A contact may start and end in one run.
fn apply<K: Ord + Copy + Debug>(open: &mut BTreeSet<K>, changes: BTreeMap<K, i64>, what: &str) -> Result<(), String> {
    for (key, change) in changes {
        let was_open = open.contains(&key);
        match (was_open, change) {
            (_, 0) => {}
            (false, 1) => _ = open.insert(key),
            (true, -1) => _ = open.remove(&key),
            _ => {
                return Err(format!(
                    "{what} {key:?}: {change} more starts than ends, although the contact was open: {was_open}"
                ));
            }
        }
    }
    Ok(())
}

fn same<K: Ord + Debug>(open: &BTreeSet<K>, listed: &BTreeSet<K>, what: &str) -> Result<(), String> {
    match open.symmetric_difference(listed).next() {
        None => Ok(()),
        Some(key) => Err(format!(
            "{what} {key:?}: listed: {}, open by the events: {}",
            listed.contains(key),
            open.contains(key)
        )),
    }
}
