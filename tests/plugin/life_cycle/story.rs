//! Reports, frame by frame: every start ends once, and all ways to read them agree.

use std::collections::BTreeSet;

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::support::Messages;

type Pair = (Entity, Entity);

/// Entity events since the last frame: the entity that received it, and the other entity.
#[derive(Resource, Default)]
struct Heard {
    starts: Vec<Pair>,
    ends: Vec<Pair>,
}

pub(super) struct Story {
    messages: Messages,
    /// Pairs that have started and not ended.
    open: BTreeSet<Pair>,
    pub(super) starts: usize,
    pub(super) ends: usize,
}

impl Story {
    pub(super) fn new(app: &mut App) -> Self {
        app.init_resource::<Heard>()
            .add_observer(|start: On<MorphCollisionStart>, mut heard: ResMut<Heard>| {
                heard.starts.push((start.collider1, start.collider2));
            })
            .add_observer(|end: On<MorphCollisionEnd>, mut heard: ResMut<Heard>| {
                heard.ends.push((end.collider1, end.collider2));
            });
        Self {
            messages: Messages::default(),
            open: BTreeSet::new(),
            starts: 0,
            ends: 0,
        }
    }

    pub(super) fn touching(&self) -> usize {
        self.open.len()
    }

    /// Reads the reports of a frame and checks them against earlier ones.
    pub(super) fn read(&mut self, app: &mut App, context: &str) {
        let (starts, ends) = self.messages.read(app);
        let starts: Vec<Pair> = starts.iter().map(|start| (start.collider1, start.collider2)).collect();
        let ends: Vec<Pair> = ends.iter().map(|end| (end.collider1, end.collider2)).collect();
        (self.starts, self.ends) = (self.starts + starts.len(), self.ends + ends.len());
        for end in &ends {
            assert!(self.open.remove(end), "{context}: {end:?} ended, and had not started");
        }
        for &start in &starts {
            assert!(self.open.insert(start), "{context}: {start:?} started twice");
        }

        let world = app.world_mut();
        let heard = std::mem::take(&mut *world.resource_mut::<Heard>());
        assert_eq!(
            sorted(heard.starts),
            listeners(world, &starts),
            "{context}: entity events of starts"
        );
        assert_eq!(
            sorted(heard.ends),
            listeners(world, &ends),
            "{context}: entity events of ends"
        );

        let collisions = world.resource::<MorphCollisions>();
        let pairs = |contact: &MorphContact| (contact.collider1, contact.collider2);
        let now: BTreeSet<Pair> = collisions.iter().map(pairs).collect();
        assert_eq!(now, self.open, "{context}: messages and contacts");
        assert_eq!(collisions.started().map(pairs).collect::<Vec<_>>(), starts, "{context}");
        assert_eq!(collisions.ended().map(pairs).collect::<Vec<_>>(), ends, "{context}");

        if world.resource::<MorphCollisionSettings>().paused {
            assert!(starts.is_empty() && ends.is_empty(), "{context}: paused");
        } else {
            self.check_lists(world, context);
        }
    }

    /// Checks the lists on colliders, including those of disabled entities.
    fn check_lists(&self, world: &mut World, context: &str) {
        let mut lists =
            world.query_filtered::<(Entity, &MorphCollidingEntities), (Without<MorphColliders>, Allow<Disabled>)>();
        for (entity, list) in lists.iter(world) {
            let mut expected: Vec<Entity> = self.open.iter().filter_map(|&(a, b)| other((a, b), entity)).collect();
            expected.sort_unstable();
            assert_eq!(**list, *expected, "{context}: the list of {entity}");
        }
    }
}

fn other((a, b): Pair, entity: Entity) -> Option<Entity> {
    match entity {
        _ if entity == a => Some(b),
        _ if entity == b => Some(a),
        _ => None,
    }
}

/// The expected receivers of events about some pairs: entities that listen and still exist.
fn listeners(world: &World, pairs: &[Pair]) -> Vec<Pair> {
    let both_ways = pairs.iter().flat_map(|&(a, b)| [(a, b), (b, a)]);
    let listens = |&(told, _): &Pair| world.get::<MorphCollisionEventsEnabled>(told).is_some();
    sorted(both_ways.filter(listens).collect())
}

fn sorted(mut pairs: Vec<Pair>) -> Vec<Pair> {
    pairs.sort_unstable();
    pairs
}
