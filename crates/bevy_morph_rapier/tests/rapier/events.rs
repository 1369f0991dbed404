//! Rapier's own events about surfaces.

use std::path::Path;

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::app::headless;
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::log::start;
use crate::support::{Log, app, ask, pair, place, run, set_weights, spawn};

/// No friction, whatever it touches.
fn slippery() -> Friction {
    Friction {
        coefficient: 0.0,
        combine_rule: CoefficientCombineRule::Min,
    }
}

#[test]
fn contact_forces_are_reported() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let cuboid = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(0.0, 0.31, 0.05));
    let forces = (ActiveEvents::CONTACT_FORCE_EVENTS, ContactForceEventThreshold(0.0));
    app.world_mut()
        .entity_mut(cuboid)
        .insert((forces, ColliderMassProperties::Mass(2.0), Sleeping::disabled()));
    run(&mut app, 60);
    let mut cursor: MessageCursor<ContactForceEvent> = MessageCursor::default();
    cursor.clear(app.world().resource());
    run(&mut app, 1);
    let events: Vec<_> = cursor.read(app.world().resource()).copied().collect();
    let total: f32 = events.iter().map(|event| event.total_force_magnitude).sum();
    assert!((total - 2.0 * 9.81).abs() < 1.0, "{events:?}");
    assert!(
        events
            .iter()
            .all(|event| pair(event.collider1, event.collider2) == pair(surface, cuboid))
    );
}

#[test]
fn while_somebody_listens_queries_see_the_contact_with_the_surface() {
    for on_surface in [true, false] {
        let mut app = app();
        let surface = spawn(&mut app, &sheet(32), ());
        settle(&mut app);
        let cuboid = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(-2.0, 0.31, 0.05));
        let listener = if on_surface { surface } else { cuboid };
        let world = app.world_mut();
        world.entity_mut(listener).insert(ActiveEvents::COLLISION_EVENTS);
        world
            .entity_mut(cuboid)
            .insert((slippery(), Velocity::linear(Vec3::X * 3.0)));
        for i in 1..=60 {
            set_weights(&mut app, surface, &[0.2 * (i as f32 * DT).sin(), 0.3 * DT * i as f32]);
            run(&mut app, 1);
        }
        let active = ask(&mut app, move |context| {
            let contact = context.contact_pair(surface, cuboid);
            contact.map(|pair| pair.has_any_active_contact())
        });
        assert_eq!(active, Some(true));
    }
}

#[test]
fn a_sensor_feels_the_surface_itself_once() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    // A body on the surface, and a sensor into which the surface rises.
    let ball = body(&mut app, Collider::ball(0.3), Vec3::new(0.0, 0.31, 0.05));
    let sensor = (
        RigidBody::Dynamic,
        GravityScale(0.0),
        Collider::cuboid(0.2, 0.2, 0.2),
        Sensor,
        Sleeping::disabled(),
        ActiveEvents::COLLISION_EVENTS,
        Transform::from_xyz(1.0, 0.5, 0.0),
    );
    let sensor = app.world_mut().spawn(sensor).id();
    let mut log = Log::default();
    log.run(&mut app, 20, |_, _| {});
    assert!(log.started.is_empty(), "{:?}", log.started);
    log.run(&mut app, 60, |app, i| {
        set_weights(app, surface, &[0.5 * DT * i as f32, 0.0]);
    });
    assert_eq!(log.started, [pair(surface, sensor)]);
    assert!(place(&app, ball).y > 0.75);
}

#[test]
fn collision_and_solver_groups_hold() {
    let mut app = app();
    let groups = CollisionGroups::new(Group::GROUP_1, Group::GROUP_1);
    let surface = spawn(&mut app, &sheet(16), groups);
    settle(&mut app);
    let spawn_ball = |app: &mut App, x: f32| body(app, Collider::ball(0.3), Vec3::new(x, 0.5, 0.05));
    let (stays, passes, ghost) = (
        spawn_ball(&mut app, -1.0),
        spawn_ball(&mut app, 0.0),
        spawn_ball(&mut app, 1.0),
    );
    let world = app.world_mut();
    world.entity_mut(stays).insert(groups);
    world
        .entity_mut(passes)
        .insert(CollisionGroups::new(Group::GROUP_2, Group::GROUP_2));
    let solver = SolverGroups::new(Group::GROUP_3, Group::GROUP_3);
    world.entity_mut(ghost).insert((groups, solver));
    world
        .entity_mut(surface)
        .insert(SolverGroups::new(Group::GROUP_1, Group::GROUP_1));
    world
        .entity_mut(stays)
        .insert(SolverGroups::new(Group::GROUP_1, Group::GROUP_1));
    run(&mut app, 60);
    assert!((place(&app, stays).y - 0.3).abs() < 1e-2, "{}", place(&app, stays));
    assert!(place(&app, passes).y < -1.0 && place(&app, ghost).y < -1.0);
}

#[test]
fn friction_and_restitution_are_the_collider_s() {
    let mut app = app();
    let surface = spawn(
        &mut app,
        &sheet(16),
        (Friction::new(0.0), Restitution::coefficient(1.0)),
    );
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.3), Vec3::new(0.0, 1.3, 0.05));
    let slides = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(-3.0, 0.3, 2.0));
    let world = app.world_mut();
    world.entity_mut(ball).insert(Restitution {
        coefficient: 1.0,
        combine_rule: CoefficientCombineRule::Min,
    });
    world.entity_mut(slides).insert((slippery(), Velocity::linear(Vec3::X)));
    let mut highest: f32 = 0.0;
    for frame in 0..90 {
        run(&mut app, 1);
        if frame > 40 {
            highest = highest.max(place(&app, ball).y);
        }
    }
    assert!(highest > 1.1, "it bounced to {highest}");
    assert!(place(&app, slides).x > -1.7, "{}", place(&app, slides));
    app.world_mut().entity_mut(surface).insert(Friction {
        coefficient: 1.0,
        combine_rule: CoefficientCombineRule::Max,
    });
    run(&mut app, 30);
    let before = place(&app, slides).x;
    run(&mut app, 30);
    assert!((place(&app, slides).x - before).abs() < 0.02, "it still slides");
}

#[test]
fn a_listener_that_comes_and_goes_hears_of_its_own_contact_alone_and_disturbs_nobody() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let slides = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(-3.0, 0.3, 0.0));
    let world = app.world_mut();
    world
        .entity_mut(slides)
        .insert((slippery(), Velocity::linear(Vec3::X), Sleeping::disabled()));
    let listener = body(&mut app, Collider::ball(0.3), Vec3::new(2.0, 0.3, 2.0));
    app.world_mut().entity_mut(listener).insert(Sleeping::disabled());
    let mut log = Log::default();
    log.run(&mut app, 120, |app, i| {
        let events = match (i - 1) / 10 % 2 {
            0 => ActiveEvents::COLLISION_EVENTS,
            _ => ActiveEvents::empty(),
        };
        app.world_mut().entity_mut(listener).insert(events);
    });
    // It was listening when it came to rest, and has been lying there since.
    assert!(!log.started.is_empty(), "nothing was heard");
    let own = |pairs: &[(Entity, Entity)]| pairs.iter().all(|&heard| heard == pair(surface, listener));
    assert!(
        own(&log.started) && own(&log.ended),
        "{:?}, {:?}",
        log.started,
        log.ended
    );
    assert_eq!(
        log.started.len() - log.ended.len(),
        1,
        "{:?}, {:?}",
        log.started,
        log.ended
    );
    assert!((place(&app, slides).y - 0.3).abs() < 1e-2 && (place(&app, slides).x + 1.0).abs() < 0.05);
    assert!((place(&app, listener).y - 0.3).abs() < 1e-2);

    // It still listens when it is lifted off.
    app.world_mut()
        .entity_mut(listener)
        .insert(ActiveEvents::COLLISION_EVENTS);
    let mut log = Log::from_now(&app);
    log.run(&mut app, 30, |_, _| {});
    log.run(&mut app, 1, |app, _| {
        app.world_mut().get_mut::<Transform>(listener).unwrap().translation.y = 5.0;
    });
    log.run(&mut app, 2, |_, _| {});
    assert_eq!(log.ended, [pair(surface, listener)]);
}

/// Lets marked entities fall through surfaces.
#[derive(bevy::ecs::system::SystemParam)]
struct Falls<'w, 's> {
    marked: Query<'w, 's, Entity, With<Name>>,
    surfaces: Query<'w, 's, Entity, With<MorphPhysicsCollider>>,
}

impl BevyPhysicsHooks for Falls<'_, '_> {
    fn filter_contact_pair(&self, context: PairFilterContextView) -> Option<SolverFlags> {
        let pair = [context.collider1(), context.collider2()];
        let falls = pair.iter().any(|&entity| self.marked.contains(entity))
            && pair.iter().any(|&entity| self.surfaces.contains(entity));
        (!falls).then_some(SolverFlags::COMPUTE_RIGID_IMPULSES)
    }
}

#[test]
fn hooks_know_the_surface() {
    let mut app = headless(Path::new("."));
    app.add_plugins((RapierPhysicsPlugin::<Falls>::default(), MorphRapierPlugin))
        .insert_resource(TimestepMode::Fixed { dt: DT, substeps: 1 });
    start(&mut app);
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let hooked = (ActiveHooks::FILTER_CONTACT_PAIRS, ActiveEvents::COLLISION_EVENTS);
    let balls = [-1.0, 1.0].map(|x| body(&mut app, Collider::ball(0.3), Vec3::new(x, 0.5, 0.05)));
    for ball in balls {
        app.world_mut().entity_mut(ball).insert(hooked);
    }
    app.world_mut().entity_mut(balls[0]).insert(Name::new("falls"));
    for i in 0..60 {
        set_weights(&mut app, surface, &[0.1 * (i as f32 * DT).sin(), 0.0]);
        run(&mut app, 1);
    }
    assert!(place(&app, balls[0]).y < -1.0, "{}", place(&app, balls[0]));
    assert!(place(&app, balls[1]).y > 0.3, "{}", place(&app, balls[1]));
}
