//! Reports about bodies, frame by frame. They follow from the contacts of their colliders, and all ways to read them agree.

use std::collections::BTreeSet;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

type Pair = (Entity, Entity);

/// Entity events since the last frame: the body that received it, and the other body.
#[derive(Resource, Default)]
struct Heard {
    starts: Vec<Pair>,
    ends: Vec<Pair>,
}

pub(super) struct BodyStory {
    starts: MessageCursor<MorphBodyCollisionStart>,
    ends: MessageCursor<MorphBodyCollisionEnd>,
    /// Bodies that touched in the last frame.
    touching: BTreeSet<Pair>,
    /// Starts of bodies with several colliders.
    pub(super) starts_of_many: usize,
}

impl BodyStory {
    pub(super) fn new(app: &mut App) -> Self {
        app.init_resource::<Heard>()
            .add_observer(|start: On<MorphBodyCollisionStart>, mut heard: ResMut<Heard>| {
                heard.starts.push((start.body1, start.body2));
            })
            .add_observer(|end: On<MorphBodyCollisionEnd>, mut heard: ResMut<Heard>| {
                heard.ends.push((end.body1, end.body2));
            });
        Self {
            starts: MessageCursor::default(),
            ends: MessageCursor::default(),
            touching: BTreeSet::new(),
            starts_of_many: 0,
        }
    }

    /// Reads the reports of a frame and compares them with the contacts before and now.
    pub(super) fn read(&mut self, app: &mut App, context: &str) {
        let world = app.world_mut();
        let starts: Vec<_> = self.starts.read(world.resource()).copied().collect();
        let ends: Vec<_> = self.ends.read(world.resource()).copied().collect();
        let collisions = world.resource::<MorphCollisions>();
        let now: BTreeSet<Pair> = collisions
            .iter()
            .map(|contact| (contact.body1.min(contact.body2), contact.body1.max(contact.body2)))
            .collect();
        let started: Vec<Pair> = now.difference(&self.touching).copied().collect();
        let ended: Vec<Pair> = self.touching.difference(&now).copied().collect();
        let pairs: Vec<Pair> = starts.iter().map(|start| (start.body1, start.body2)).collect();
        assert_eq!(pairs, started, "{context}: starts of bodies");
        let pairs: Vec<Pair> = ends.iter().map(|end| (end.body1, end.body2)).collect();
        assert_eq!(pairs, ended, "{context}: ends of bodies");
        for start in &starts {
            check_start(collisions, start, context);
        }
        for &(a, b) in &now {
            assert!(
                collisions.contains_bodies(a, b) && collisions.contains_bodies(b, a),
                "{context}"
            );
            let of_both = |contact: &&MorphContact| [(a, b), (b, a)].contains(&(contact.body1, contact.body2));
            let between: Vec<_> = collisions.iter().filter(of_both).collect();
            assert_eq!(
                collisions.collisions_between_bodies(b, a).collect::<Vec<_>>(),
                between,
                "{context}"
            );
        }
        for &(a, b) in &ended {
            assert!(!collisions.contains_bodies(a, b), "{context}");
        }
        self.touching = now;
        self.check_lists(world, context);

        let heard = std::mem::take(&mut *world.resource_mut::<Heard>());
        assert_eq!(
            sorted(heard.starts),
            told(world, &started),
            "{context}: body events of starts"
        );
        assert_eq!(
            sorted(heard.ends),
            told(world, &ended),
            "{context}: body events of ends"
        );
        let has_many = |&&(a, b): &&Pair| {
            world
                .get::<MorphColliders>(a)
                .or(world.get::<MorphColliders>(b))
                .is_some()
        };
        self.starts_of_many += started.iter().filter(has_many).count();
    }

    /// Checks the touching bodies of bodies with several colliders, by the list on them and by the resource.
    fn check_lists(&self, world: &mut World, context: &str) {
        let is_paused = world.resource::<MorphCollisionSettings>().paused;
        let mut bodies = world
            .query_filtered::<(Entity, Option<&MorphCollidingEntities>), (With<MorphColliders>, Allow<Disabled>)>();
        let collisions = world.resource::<MorphCollisions>();
        for (body, list) in bodies.iter(world) {
            let others = self.touching.iter().filter_map(|&(a, b)| match body {
                _ if body == a => Some(b),
                _ if body == b => Some(a),
                _ => None,
            });
            let others = others.collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>();
            assert_eq!(
                collisions.bodies_colliding_with(body).collect::<Vec<_>>(),
                others,
                "{context}: {body}"
            );
            if let Some(list) = list
                && !is_paused
            {
                assert_eq!(**list, *others, "{context}: the list of body {body}");
            }
        }
    }
}

/// Checks that a start names the first contact of its bodies, seen from the first body.
fn check_start(collisions: &MorphCollisions, start: &MorphBodyCollisionStart, context: &str) {
    let first = collisions
        .iter()
        .find(|contact| {
            [contact.body1, contact.body2]
                .iter()
                .all(|body| [start.body1, start.body2].contains(body))
        })
        .expect("bodies that started have a contact");
    let (colliders, normal) = if first.body1 == start.body1 {
        ([first.collider1, first.collider2], first.normal)
    } else {
        ([first.collider2, first.collider1], -first.normal)
    };
    assert_eq!([start.collider1, start.collider2], colliders, "{context}: {start:?}");
    assert_eq!(
        (start.point, start.normal),
        (first.point, normal),
        "{context}: {start:?}"
    );
}

/// The expected receivers of events about some pairs: the bodies that still exist.
fn told(world: &World, pairs: &[Pair]) -> Vec<Pair> {
    let both_ways = pairs.iter().flat_map(|&(a, b)| [(a, b), (b, a)]);
    sorted(both_ways.filter(|&(told, _)| world.get_entity(told).is_ok()).collect())
}

fn sorted(mut pairs: Vec<Pair>) -> Vec<Pair> {
    pairs.sort_unstable();
    pairs
}
