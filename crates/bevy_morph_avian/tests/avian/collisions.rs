//! `MorphAvianCollisions`: Avian's contacts, with surfaces instead of parts.

use std::collections::HashSet;

use avian3d::prelude::*;
use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{app, body, colliding, cuboid, fall_asleep, pair, run, set_weights, spawn};

/// Runs a system once that reads contacts.
fn read<T: Send + 'static>(
    app: &mut App,
    read: impl Fn(&MorphAvianCollisions, &Query<&MorphAvianPart>) -> T + Send + Sync + 'static,
) -> T {
    let system = move |collisions: MorphAvianCollisions, parts: Query<&MorphAvianPart>| read(&collisions, &parts);
    app.world_mut().run_system_once(system).unwrap()
}

/// What touches an entity, sorted.
fn touching(app: &mut App, entity: Entity) -> Vec<Entity> {
    let mut touching = read(app, move |all, _| {
        all.entities_colliding_with(entity).collect::<Vec<_>>()
    });
    touching.sort();
    touching
}

#[test]
fn contacts_are_those_with_the_surface_each_once() {
    let mut app = app();
    let listening = CollidingEntities::default;
    let surface = spawn(&mut app, &sheet(16), listening());
    // It crosses the first one, below the same bodies.
    let steep = Transform::from_rotation(Quat::from_rotation_z(0.2));
    let other = spawn(&mut app, &sheet(16), (steep, listening()));
    settle(&mut app);
    let mut bodies = vec![];
    for i in 0..24 {
        let at = Vec3::new(
            0.45 * (i % 5) as f32 - 1.0,
            0.4 + 0.3 * (i / 10) as f32,
            0.4 * (i % 4) as f32,
        );
        let shape = if i % 2 == 0 {
            cuboid(Vec3::splat(0.25))
        } else {
            Collider::sphere(0.25)
        };
        let body = body(&mut app, shape, at);
        app.world_mut().entity_mut(body).insert(listening());
        bodies.push(body);
    }
    let trigger = (Collider::cuboid(3.0, 0.5, 3.0), Sensor, listening());
    bodies.push(app.world_mut().spawn((trigger, Transform::default())).id());
    let (mut most_parts, mut sides) = (0, HashSet::new());
    for i in 0..90 {
        let height = 0.2 * (0.2 * i as f32).sin();
        set_weights(&mut app, surface, &[height, 0.0]);
        set_weights(&mut app, other, &[-height, 0.0]);
        run(&mut app, 1);
        for &entity in bodies.iter().chain([&surface, &other]) {
            let mut expected = colliding(&app, entity);
            expected.sort();
            assert_eq!(touching(&mut app, entity), expected, "step {i}, {entity}");
        }
        let listed = read(&mut app, |all, _| {
            all.iter()
                .map(|it| pair(it.collider1, it.collider2))
                .collect::<Vec<_>>()
        });
        let set: HashSet<_> = listed.iter().copied().collect();
        assert_eq!(set.len(), listed.len(), "step {i}: each once");
        let of_bodies = bodies.iter().flat_map(|&body| {
            let touching = colliding(&app, body);
            touching.into_iter().map(move |other| pair(body, other))
        });
        assert_eq!(set, of_bodies.collect(), "step {i}");
        // Each pair of Avian with a part belongs to one of them.
        let bodies: HashSet<Entity> = bodies.iter().copied().collect();
        let (pairs, parts, graph) = read(&mut app, move |all, parts| {
            let with_part = |pair: &&ContactPair| parts.contains(pair.collider1) || parts.contains(pair.collider2);
            let ids = |pairs: &mut dyn Iterator<Item = &ContactPair>| -> Vec<u32> {
                let mut ids: Vec<u32> = pairs.map(|pair| pair.contact_id.0).collect();
                ids.sort();
                ids
            };
            let mut most = 0;
            let mut sides = vec![];
            for contacts in all.iter() {
                assert!(!parts.contains(contacts.collider1) && !parts.contains(contacts.collider2));
                most = most.max(contacts.pairs().count());
                let manifolds = contacts.pairs().map(|pair| pair.manifolds.len()).sum::<usize>();
                assert_eq!(contacts.manifolds().count(), manifolds);
                sides.extend(
                    contacts
                        .pairs()
                        .filter(|it| parts.contains(it.collider1) || parts.contains(it.collider2))
                        .map(|it| it.collider1 == contacts.collider2),
                );
            }
            let ours = ids(&mut all.iter().flat_map(|it| it.pairs()));
            let graph = all.graph();
            let mut touching = graph.iter_active_touching().chain(graph.iter_sleeping_touching());
            let theirs = ids(&mut touching.by_ref().filter(|pair| {
                // Parts also touch each other's bodies and surfaces, which the surface does not.
                let near = bodies.contains(&pair.collider1) || bodies.contains(&pair.collider2);
                !with_part(pair) || near
            }));
            (ours, (most, sides), theirs)
        });
        assert_eq!(pairs, graph, "step {i}");
        most_parts = most_parts.max(parts.0);
        sides.extend(parts.1);
    }
    // Some bodies touch several parts of a surface, and parts are first and second colliders.
    assert!(most_parts > 1, "{most_parts}");
    assert_eq!(sides.len(), 2);
}

#[test]
fn contacts_with_a_surface_are_like_those_with_a_floor() {
    let mut app = app();
    let floor = (RigidBody::Static, Collider::cuboid(8.0, 1.0, 8.0));
    let floor = app
        .world_mut()
        .spawn((floor, Transform::from_xyz(20.0, -0.5, 0.0)))
        .id();
    let root = app.world_mut().spawn((RigidBody::Static, Transform::default())).id();
    let surface = spawn(&mut app, &sheet(16), ChildOf(root));
    settle(&mut app);
    let mut crates = vec![];
    for (ground, x) in [(floor, 20.0), (surface, 0.0), (surface, -1.5), (surface, 1.5)] {
        let at = Vec3::new(x + 0.1, 0.3, 0.1);
        let body = body(&mut app, cuboid(Vec3::splat(0.3)), at);
        app.world_mut().entity_mut(body).insert(SleepingDisabled);
        crates.push((ground, body));
    }
    run(&mut app, 120);
    // What Avian says of its own floor.
    let (_, crate_on_floor) = crates[0];
    let on_floor = move |collisions: Collisions| collisions.get(floor, crate_on_floor).unwrap().total_normal_impulse();
    let weight = app.world_mut().run_system_once(on_floor).unwrap().length();
    assert!(weight > 0.01);
    for (ground, body) in crates {
        read(&mut app, move |all, _| {
            for (a, b) in [(ground, body), (body, ground)] {
                let contacts = all.get(a, b).expect("they touch");
                assert!(all.contains(a, b) && contacts.generates_constraints());
                assert_eq!((contacts.other(a), contacts.other(b)), (b, a));
                let bodies = [
                    (contacts.collider1, contacts.body1),
                    (contacts.collider2, contacts.body2),
                ];
                let expected = [
                    (ground, Some(if ground == floor { floor } else { root })),
                    (body, Some(body)),
                ];
                assert!(expected.iter().all(|it| bodies.contains(it)), "{contacts:?}");
                // From the first to the second.
                let up = if contacts.collider2 == body {
                    Vec3::Y
                } else {
                    Vec3::NEG_Y
                };
                assert!(contacts.manifolds().all(|(normal, _)| normal.distance(up) < 1e-2));
                let total = contacts.total_normal_impulse();
                assert!(total.distance(up * weight) < 0.05 * weight, "{total}, not {weight}");
                let magnitude = contacts.total_normal_impulse_magnitude();
                assert!((magnitude - weight).abs() < 0.05 * weight, "{magnitude}");
                let points = contacts.manifolds().flat_map(|(_, manifold)| &manifold.points);
                let largest = points.map(|point| point.normal_impulse).fold(0.0, f32::max);
                assert!(largest > 0.0);
                assert_eq!(contacts.max_normal_impulse_magnitude(), largest);
                assert!(contacts.max_normal_impulse().distance(up * largest) < 1e-2 * weight);
                let deepest = contacts.find_deepest_contact().expect("it has points");
                assert!(deepest.penetration.abs() < 0.02 && deepest.point.y.abs() < 0.02);
            }
            assert!(!all.contains(body, Entity::PLACEHOLDER));
        });
    }
}

#[test]
fn parts_stand_for_their_surface_and_sleep_and_removal_are_known() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::sphere(0.3), Vec3::new(0.3, 0.3, 0.0));
    run(&mut app, 10);
    let part = {
        let mut parts = app.world_mut().query_filtered::<Entity, With<MorphAvianPart>>();
        parts.iter(app.world()).next().expect("the ball is near")
    };
    assert_eq!(touching(&mut app, part), [ball]);
    assert!(read(&mut app, move |all, _| all.contains(part, ball)));
    fall_asleep(&mut app, ball);
    assert_eq!(
        (touching(&mut app, ball), touching(&mut app, surface)),
        (vec![surface], vec![ball])
    );
    app.world_mut().entity_mut(surface).despawn();
    assert_eq!(touching(&mut app, ball), []);
    run(&mut app, 1);
    assert_eq!(touching(&mut app, ball), []);
}

#[test]
fn pairs_without_parts_are_those_of_avian() {
    let mut app = app();
    // As a sensor, and on a dynamic body, a surface has no parts.
    let sensor = spawn(&mut app, &sheet(16), Sensor);
    let held = (
        RigidBody::Dynamic,
        LockedAxes::ALL_LOCKED,
        Transform::from_xyz(0.0, 0.0, 20.0),
    );
    let dynamic = spawn(&mut app, &sheet(4), held);
    let block = (
        RigidBody::Static,
        Collider::cuboid(1.0, 0.5, 1.0),
        Transform::from_xyz(0.3, 0.0, 20.0),
    );
    let block = app.world_mut().spawn(block).id();
    let floor = (RigidBody::Static, Collider::cuboid(8.0, 1.0, 8.0));
    let floor = app.world_mut().spawn((floor, Transform::from_xyz(0.0, -0.7, 0.0))).id();
    settle(&mut app);
    let ball = body(&mut app, Collider::sphere(0.3), Vec3::new(0.3, 0.3, 0.0));
    run(&mut app, 60);
    assert_eq!(touching(&mut app, ball), {
        let mut both = [sensor, floor];
        both.sort();
        both
    });
    assert_eq!(touching(&mut app, sensor), [ball]);
    assert_eq!(touching(&mut app, dynamic), [block]);
    let avian = |collisions: Collisions| {
        let pairs = collisions.iter().map(|it| {
            (
                it.collider1,
                it.collider2,
                it.total_normal_impulse(),
                it.manifolds.len(),
            )
        });
        pairs.collect::<Vec<_>>()
    };
    let avian = app.world_mut().run_system_once(avian).unwrap();
    let ours = read(&mut app, |all, _| {
        let pairs = all.iter().map(|it| {
            (
                it.collider1,
                it.collider2,
                it.total_normal_impulse(),
                it.manifolds().count(),
            )
        });
        pairs.collect::<Vec<_>>()
    });
    assert_eq!(ours, avian);
    assert!(avian.len() >= 3);
}
