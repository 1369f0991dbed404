//! Avian's collision events, and the lists of touching entities.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{BALL, DT, Log, app, ball_on_sheet, body, colliding, pair, put, run, set_weights, spawn};

/// The events that an observer received.
#[derive(Resource, Default)]
struct Observed(Vec<(Entity, Entity, Option<Entity>, Option<Entity>)>);

#[test]
fn observers_of_the_surface_and_of_the_body_are_told_with_bodies() {
    let mut app = app();
    app.init_resource::<Observed>();
    let root = app.world_mut().spawn((RigidBody::Static, Transform::default())).id();
    let surface = spawn(&mut app, &sheet(16), (ChildOf(root), CollisionEventsEnabled));
    settle(&mut app);
    let ball = body(&mut app, Collider::sphere(0.3), BALL);
    app.world_mut().entity_mut(ball).insert(CollisionEventsEnabled);
    for entity in [surface, ball] {
        let tell = |start: On<CollisionStart>, mut observed: ResMut<Observed>| {
            let start = *start.event();
            observed
                .0
                .push((start.collider1, start.collider2, start.body1, start.body2));
        };
        app.world_mut().entity_mut(entity).observe(tell);
    }
    let mut log = Log::from_now(&app);
    log.run(&mut app, 20, |_, _| {});
    assert_eq!((&log.started, &log.ended), (&vec![pair(surface, ball)], &vec![]));
    let mut observed = app.world().resource::<Observed>().0.clone();
    observed.sort();
    let mut expected = vec![
        (surface, ball, Some(root), Some(ball)),
        (ball, surface, Some(ball), Some(root)),
    ];
    expected.sort();
    assert_eq!(observed, expected);
}

#[test]
fn nobody_is_told_who_does_not_listen() {
    let (mut app, surface, ball) = ball_on_sheet();
    let mut log = Log::from_now(&app);
    log.run(&mut app, 30, |app, i| {
        put(app, ball, BALL + Vec3::Y * (i / 10 % 2) as f32);
        set_weights(app, surface, &[1e-3 * i as f32, 0.0]);
    });
    assert_eq!((log.started, log.ended), (vec![], vec![]));
}

#[test]
fn a_surface_that_rises_into_a_trigger_tells() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let trigger = (
        Collider::cuboid(1.0, 0.2, 1.0),
        Sensor,
        CollisionEventsEnabled,
        Transform::from_xyz(0.3, 0.5, 0.0),
    );
    let trigger = app.world_mut().spawn(trigger).id();
    let mut log = Log::from_now(&app);
    log.run(&mut app, 60, |app, i| {
        set_weights(app, surface, &[DT * i as f32, 0.0]);
        if i == 15 {
            let parts = app.world_mut().query::<&MorphAvianPart>().iter(app.world()).count();
            assert_eq!(parts, 0, "far from it there are no parts");
        }
    });
    let once = vec![pair(surface, trigger)];
    assert_eq!((log.started, log.ended), (once.clone(), once));
}

#[test]
fn what_touches_a_surface_that_goes_is_told() {
    type Go = fn(&mut App, Entity);
    let ways: [(&str, Go); 4] = [
        ("despawned", |app, surface| {
            app.world_mut().entity_mut(surface).despawn();
        }),
        ("disabled", |app, surface| {
            app.world_mut().entity_mut(surface).insert(MorphColliderDisabled);
        }),
        ("not asked for", |app, surface| {
            app.world_mut().entity_mut(surface).remove::<MorphPhysicsCollider>();
        }),
        ("collider disabled", |app, surface| {
            app.world_mut().entity_mut(surface).insert(ColliderDisabled);
        }),
    ];
    for (name, go) in ways {
        let (mut app, surface, ball) = ball_on_sheet();
        let listens = (CollisionEventsEnabled, CollidingEntities::default());
        app.world_mut().entity_mut(ball).insert(listens);
        put(&mut app, ball, BALL + Vec3::Y);
        run(&mut app, 60);
        assert_eq!(colliding(&app, ball), [surface], "{name}");
        let mut log = Log::from_now(&app);
        go(&mut app, surface);
        log.run(&mut app, 3, |_, _| {});
        assert_eq!(log.ended, [pair(surface, ball)], "{name}");
        assert!(colliding(&app, ball).is_empty(), "{name}");
    }
}

#[test]
fn a_floor_and_other_surfaces_are_told_of_no_parts() {
    let mut app = app();
    let told = || (CollidingEntities::default(), CollisionEventsEnabled);
    let floor = (
        (RigidBody::Static, Collider::cuboid(20.0, 1.0, 20.0), told()),
        Transform::from_xyz(0.0, -0.5, 0.0),
    );
    let floor = app.world_mut().spawn(floor).id();
    let surface = spawn(&mut app, &sheet(16), told());
    // Crosses the first surface, below the same ball.
    let steep = Transform::from_rotation(Quat::from_rotation_z(0.3));
    let other = spawn(&mut app, &sheet(16), (steep, told()));
    settle(&mut app);
    let mut log = Log::from_now(&app);
    let ball = body(&mut app, Collider::sphere(0.3), BALL);
    let second = body(&mut app, Collider::sphere(0.3), BALL + 0.5 * Vec3::Z);
    log.run(&mut app, 60, |app, i| {
        let height = 0.02 * (0.5 * i as f32).sin();
        set_weights(app, surface, &[height, 0.0]);
        set_weights(app, other, &[-height, 0.0]);
    });
    let balls = [ball, second];
    assert!(!log.started.is_empty());
    for &(a, b) in log.started.iter().chain(&log.ended) {
        let met = if balls.contains(&a) { b } else { a };
        assert!(balls.contains(&a) || balls.contains(&b), "{a} and {b}");
        assert!(balls.contains(&met) || [surface, other, floor].contains(&met), "{met}");
    }
    for entity in [floor, surface, other] {
        let with = colliding(&app, entity);
        assert!(with.iter().all(|with| balls.contains(with)), "{entity}: {with:?}");
    }
}
