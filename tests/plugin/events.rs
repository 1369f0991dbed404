//! Starts and ends as messages and as entity events.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::support::{Edits, Messages, add_mesh, app, cube, diagnostics, move_to, settle, spawn, touches, two_cubes};

#[test]
fn a_start_and_an_end_are_reported_once() {
    let (mut app, [a, b]) = two_cubes(3.0);
    let (first, second) = (a.min(b), a.max(b));
    let mut messages = Messages::default();
    assert_eq!(messages.read(&app), (vec![], vec![]));

    move_to(&mut app, b, 0.8);
    app.update();
    let (starts, ends) = messages.read(&app);
    let who = |start: &MorphCollisionStart| [start.collider1, start.collider2, start.body1, start.body2];
    let starts: Vec<_> = starts.iter().map(who).collect();
    assert_eq!((starts, ends.len()), (vec![[first, second, first, second]], 0));
    assert!(touches(&app, a, b) && touches(&app, b, a));

    app.update();
    move_to(&mut app, b, 0.7);
    app.update();
    assert_eq!(messages.read(&app), (vec![], vec![]), "they still touch");

    move_to(&mut app, b, 3.0);
    app.update();
    let (starts, ends) = messages.read(&app);
    let end = MorphCollisionEnd {
        collider1: first,
        collider2: second,
        body1: first,
        body2: second,
    };
    assert_eq!((starts.len(), ends), (0, vec![end]));
    app.update();
    assert_eq!(messages.read(&app), (vec![], vec![]));
}

#[derive(Resource, Default, PartialEq, Debug)]
struct Observed {
    starts: Vec<MorphCollisionStart>,
    ends: Vec<MorphCollisionEnd>,
}

fn observe(app: &mut App) {
    app.init_resource::<Observed>()
        .add_observer(|start: On<MorphCollisionStart>, mut observed: ResMut<Observed>| {
            observed.starts.push(*start.event());
        })
        .add_observer(|end: On<MorphCollisionEnd>, mut observed: ResMut<Observed>| {
            observed.ends.push(*end.event());
        });
}

#[test]
fn entity_events_are_opt_in_and_agree_with_the_messages() {
    let (mut app, [a, b]) = two_cubes(3.0);
    observe(&mut app);
    move_to(&mut app, b, 0.8);
    app.update();
    assert_eq!(*app.world().resource::<Observed>(), Observed::default());

    move_to(&mut app, b, 3.0);
    app.insert(b, MorphCollisionEventsEnabled);
    app.update();
    move_to(&mut app, b, 0.8);
    app.update();
    let seen_from_b = |observed: &Observed| {
        let starts = observed
            .starts
            .iter()
            .map(|e| [e.collider1, e.collider2, e.body1, e.body2]);
        let ends = observed
            .ends
            .iter()
            .map(|e| [e.collider1, e.collider2, e.body1, e.body2]);
        assert!(starts.chain(ends).all(|event| event == [b, a, b, a]));
        (observed.starts.len(), observed.ends.len())
    };
    assert_eq!(seen_from_b(app.world().resource::<Observed>()), (1, 1));

    app.insert(a, MorphCollisionEventsEnabled);
    move_to(&mut app, b, 3.0);
    app.update();
    let ends = &app.world().resource::<Observed>().ends;
    let targets: Vec<_> = ends.iter().skip(1).map(|end| end.collider1).collect();
    assert_eq!(targets, [a.min(b), a.max(b)], "both are told");
}

#[test]
fn an_observer_of_one_entity_hears_of_that_entity_alone() {
    let (mut app, [a, b]) = two_cubes(3.0);
    app.init_resource::<Observed>();
    app.world_mut()
        .entity_mut(a)
        .insert(MorphCollisionEventsEnabled)
        .observe(|start: On<MorphCollisionStart>, mut observed: ResMut<Observed>| observed.starts.push(*start.event()));
    app.insert(b, MorphCollisionEventsEnabled);
    move_to(&mut app, b, 0.8);
    app.update();
    let starts = &app.world().resource::<Observed>().starts;
    assert_eq!(starts.iter().map(|e| e.collider1).collect::<Vec<_>>(), [a]);
}

#[test]
fn despawning_a_touching_collider_ends_the_contact() {
    let (mut app, [a, b]) = two_cubes(0.8);
    observe(&mut app);
    app.insert(a, MorphCollisionEventsEnabled);
    app.insert(b, MorphCollisionEventsEnabled);
    let mut messages = Messages::default();
    assert_eq!(messages.read(&app).0.len(), 1);

    app.world_mut().despawn(b);
    app.update();
    let (_, ends) = messages.read(&app);
    assert_eq!(
        ends.iter().map(|e| (e.collider1, e.collider2)).collect::<Vec<_>>(),
        [(a.min(b), a.max(b))]
    );
    let observed = app.world().resource::<Observed>();
    assert_eq!(observed.ends.iter().map(|e| e.collider1).collect::<Vec<_>>(), [a]);
    assert!(app.world().resource::<MorphCollisions>().is_empty());
}

#[test]
fn removing_the_component_ends_the_contact_and_adding_it_starts_another() {
    let (mut app, [a, b]) = two_cubes(0.8);
    let mut messages = Messages::default();
    messages.read(&app);

    app.remove::<MorphCollider>(a);
    app.update();
    assert_eq!(messages.read(&app).1.len(), 1);
    assert_eq!(diagnostics(&app).colliders, 1);

    app.insert(a, MorphCollider::default());
    app.update();
    assert_eq!(messages.read(&app).0.len(), 1);
    assert!(touches(&app, a, b));
}

#[test]
fn the_collider_that_asks_for_more_decides_what_a_contact_tells() {
    use MorphCollisionMode::{All, First, Passive};
    let (mut app, [a, b]) = two_cubes(0.8);
    let mut triangles_in = |mode_a, mode_b| {
        app.insert(a, MorphCollider::new(mode_a));
        app.insert(b, MorphCollider::new(mode_b));
        app.update();
        let contact = app.world().resource::<MorphCollisions>().get(b, a);
        contact.map(|contact| (contact.mode, contact.triangles.len()))
    };
    assert_eq!(triangles_in(First, First), Some((First, 1)));
    assert_eq!(triangles_in(First, Passive), Some((First, 1)));
    let all = triangles_in(First, All);
    assert!(
        all.is_some_and(|(mode, triangles)| mode == All && triangles > 1),
        "{all:?}"
    );
}

#[test]
fn contacts_come_in_the_order_of_the_entities() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let places = [0.9, 0.1, 1.6, 0.5, 1.2];
    let cubes = places.map(|x| spawn(&mut app, &mesh, x));
    settle(&mut app);
    let pairs: Vec<_> = app
        .world()
        .resource::<MorphCollisions>()
        .iter()
        .map(|contact| (contact.collider1, contact.collider2))
        .collect();
    let mut expected = Vec::new();
    for (j, &b) in cubes.iter().enumerate() {
        for (i, &a) in cubes[..j].iter().enumerate() {
            if f32::abs(places[i] - places[j]) < 0.99 {
                expected.push((a.min(b), a.max(b)));
            }
        }
    }
    expected.sort();
    assert_eq!(pairs, expected);
}

#[test]
fn a_start_tells_where_and_which_way() {
    let (mut app, [a, b]) = two_cubes(3.0);
    observe(&mut app);
    for cube in [a, b] {
        app.insert(cube, MorphCollisionEventsEnabled);
    }
    let mut messages = Messages::default();
    messages.read(&app);
    move_to(&mut app, b, 0.9);
    app.update();
    let (starts, _) = messages.read(&app);
    let start = starts[0];
    // The cubes overlap between x = 0.4 and 0.5.
    assert!(
        (0.399..=0.5).contains(&start.point.x) && start.point.yz().abs().max_element() <= 0.5,
        "{start:?}"
    );
    assert!((start.normal.length() - 1.0).abs() < 1e-5, "{start:?}");
    let observed = &app.world().resource::<Observed>().starts;
    let seen_from = |cube: Entity| observed.iter().find(|start| start.collider1 == cube).unwrap();
    assert_eq!(seen_from(a).normal, -seen_from(b).normal);
    assert_eq!(seen_from(a).point, seen_from(b).point);
}

#[test]
fn colliding_entities_are_listed_where_that_is_asked_for() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let [a, b, c] = [0.0, 0.8, 1.6].map(|x| spawn(&mut app, &mesh, x));
    app.insert(b, MorphCollidingEntities::default());
    settle(&mut app);
    let listed = |app: &App, cube: Entity| {
        app.world()
            .get::<MorphCollidingEntities>(cube)
            .map(|list| list.to_vec())
    };
    assert_eq!(listed(&app, b), Some(vec![a.min(c), a.max(c)]));
    assert_eq!(listed(&app, a), None);

    // If it is inserted late, it is filled with existing contacts.
    app.insert(a, MorphCollidingEntities::default());
    app.update();
    assert_eq!(listed(&app, a), Some(vec![b]));

    move_to(&mut app, a, -5.0);
    app.update();
    assert_eq!((listed(&app, a), listed(&app, b)), (Some(vec![]), Some(vec![c])));
    app.world_mut().despawn(c);
    app.update();
    assert_eq!(listed(&app, b), Some(vec![]));
}

#[test]
fn a_disabled_listener_hears_one_end_for_each_start() {
    let (mut app, [a, b]) = two_cubes(3.0);
    observe(&mut app);
    for cube in [a, b] {
        app.insert(cube, MorphCollisionEventsEnabled);
    }
    move_to(&mut app, b, 0.8);
    app.update();
    let mut messages = Messages::default();
    messages.read(&app);
    let heard = |app: &mut App, cube: Entity| {
        let observed = app.world().resource::<Observed>();
        let starts = observed.starts.iter().filter(|event| event.collider1 == cube);
        (
            starts.count(),
            observed.ends.iter().filter(|event| event.collider1 == cube).count(),
        )
    };
    for round in 1..=3 {
        app.insert(a, Disabled);
        for _ in 0..2 {
            app.update();
        }
        assert_eq!([a, b].map(|cube| heard(&mut app, cube)), [(round, round); 2]);
        assert_eq!(messages.read(&app).1.len(), 1);
        app.remove::<Disabled>(a);
        for _ in 0..2 {
            app.update();
        }
        assert_eq!([a, b].map(|cube| heard(&mut app, cube)), [(round + 1, round); 2]);
        assert_eq!(messages.read(&app).0.len(), 1);
    }
}

#[test]
fn an_observer_of_a_disabled_entity_hears_its_end() {
    let (mut app, [a, b]) = two_cubes(0.8);
    app.init_resource::<Observed>();
    app.world_mut()
        .entity_mut(a)
        .insert(MorphCollisionEventsEnabled)
        .observe(|end: On<MorphCollisionEnd>, mut observed: ResMut<Observed>| observed.ends.push(*end.event()));
    app.insert(a, Disabled);
    app.update();
    let ends = &app.world().resource::<Observed>().ends;
    assert_eq!(
        ends.iter()
            .map(|end| (end.collider1, end.collider2))
            .collect::<Vec<_>>(),
        [(a, b)]
    );
}

#[test]
fn the_list_of_a_disabled_collider_is_empty() {
    let (mut app, [a, b]) = two_cubes(0.8);
    for cube in [a, b] {
        app.insert(cube, MorphCollidingEntities::default());
    }
    app.update();
    let listed = |app: &App| [a, b].map(|cube| app.world().get::<MorphCollidingEntities>(cube).unwrap().to_vec());
    assert_eq!(listed(&app), [vec![b], vec![a]]);
    app.insert(a, Disabled);
    app.update();
    assert_eq!(listed(&app), [vec![], vec![]]);
    app.remove::<Disabled>(a);
    app.update();
    assert_eq!(listed(&app), [vec![b], vec![a]]);
}

#[test]
fn a_list_is_right_after_its_collider_was_disabled_or_the_list_replaced() {
    let (mut app, [a, b]) = two_cubes(0.8);
    app.insert(a, MorphCollidingEntities::default());
    app.update();
    let listed = |app: &App| app.world().get::<MorphCollidingEntities>(a).map(|list| list.to_vec());
    assert_eq!(listed(&app), Some(vec![b]));
    app.insert(a, Disabled);
    app.update();
    move_to(&mut app, a, 9.0);
    app.remove::<Disabled>(a);
    app.update();
    assert_eq!(listed(&app), Some(vec![]));
    move_to(&mut app, a, 0.0);
    app.update();
    assert_eq!(listed(&app), Some(vec![b]));
    app.update();
    app.insert(a, MorphCollidingEntities::default());
    app.update();
    assert_eq!(listed(&app), Some(vec![b]));
}
