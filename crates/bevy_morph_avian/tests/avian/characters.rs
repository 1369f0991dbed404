//! Characters that the game moves with `MoveAndSlide`.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use morph_collision_workspace::physics::{settle, sheet};

use crate::log::Errors;
use crate::support::{DT, app, body, place, run, set_weights, spawn};

/// A character with its own velocity: how it falls, and how it walks.
#[derive(Component, Default)]
struct Walker {
    falls: Vec3,
    walks: Vec3,
}

fn walk(mut walkers: Query<(Entity, &mut Walker, &Collider, &mut Transform)>, space: MoveAndSlide, time: Res<Time>) {
    for (entity, mut walker, collider, mut transform) in &mut walkers {
        let fallen = walker.falls - Vec3::Y * 9.81 * time.delta_secs();
        let filter = SpatialQueryFilter::from_excluded_entities([entity]);
        let moved = space.move_and_slide(
            collider,
            transform.translation,
            transform.rotation,
            fallen + walker.walks,
            time.delta(),
            &MoveAndSlideConfig::default(),
            &filter,
            |_| MoveAndSlideHitResponse::Accept,
        );
        transform.translation = moved.position;
        // It brakes on the ground at once.
        walker.falls = Vec3::Y * moved.projected_velocity.y;
    }
}

/// A sheet, and a character of height 1.6 at rest on it.
fn on_a_sheet(on: impl Bundle, character: impl Bundle) -> (App, Entity, Entity) {
    let mut app = app();
    app.add_systems(FixedUpdate, walk);
    let surface = spawn(&mut app, &sheet(16), (RigidBody::Static, on));
    settle(&mut app);
    let parts = (
        Walker::default(),
        Collider::capsule(0.3, 1.0),
        Transform::from_xyz(-1.0, 0.82, 0.05),
        character,
    );
    let character = app.world_mut().spawn(parts).id();
    run(&mut app, 30);
    let height = app.world().get::<Transform>(character).unwrap().translation.y;
    assert!((height - 0.81).abs() < 0.01, "it stands at {height}");
    (app, surface, character)
}

fn kinematic() -> impl Bundle {
    (
        RigidBody::Kinematic,
        CustomPositionIntegration,
        MorphAvianCarry::default(),
    )
}

#[test]
fn a_character_stands_on_a_surface_and_is_carried() {
    for is_body in [true, false] {
        for (rise, slide) in [
            (0.0, 0.0),
            (0.05, 0.0),
            (0.5, 0.0),
            (3.0, 0.0),
            (0.5, 1.0),
            (-0.5, 1.0),
            (0.0, 0.005),
        ] {
            let (mut app, surface, character) = match is_body {
                true => on_a_sheet((), kinematic()),
                false => on_a_sheet((), MorphAvianCarry::default()),
            };
            let at = |app: &App| app.world().get::<Transform>(character).unwrap().translation;
            let begin = at(&app);
            for i in 1..=120 {
                let time = DT * i as f32;
                set_weights(&mut app, surface, &[rise * time, slide * time]);
                run(&mut app, 1);
            }
            let ground = *app.world().get::<MorphCharacterGround>(character).unwrap();
            assert_eq!(ground.surface, Some(surface));
            assert!(
                ground.velocity.distance(Vec3::new(slide, rise, 0.0)) < 1e-3,
                "{rise}, {slide}: {}",
                ground.velocity
            );
            // The first step is a jump for the fastest, and a character feels it one step late.
            let expected = Vec3::new(slide, rise, 0.0) * 2.0;
            let moved = at(&app) - begin;
            let missing = moved.distance(expected);
            assert!(
                missing < 0.02 * expected.length() + 2e-3 + 2.0 * DT * rise.abs(),
                "body: {is_body}, rises at {rise}, slides at {slide}: moved by {moved}, not by {expected}"
            );
        }
    }
}

#[test]
fn a_carried_character_walks() {
    for is_body in [true, false] {
        let (mut app, surface, character) = match is_body {
            true => on_a_sheet((), kinematic()),
            false => on_a_sheet((), MorphAvianCarry::default()),
        };
        app.world_mut().get_mut::<Walker>(character).unwrap().walks = Vec3::Z;
        let at = |app: &App| app.world().get::<Transform>(character).unwrap().translation;
        let begin = at(&app);
        for i in 1..=120 {
            let time = DT * i as f32;
            set_weights(&mut app, surface, &[0.5 * time, time]);
            run(&mut app, 1);
        }
        let moved = at(&app) - begin;
        let expected = Vec3::new(2.0, 1.0, 2.0);
        assert!(
            moved.distance(expected) < 0.06,
            "body: {is_body}: moved by {moved}, not by {expected}"
        );
        // Avian sees it where it is drawn, up to the last step.
        let seen = app.world().get::<Position>(character).unwrap().0;
        assert!(
            seen.distance(at(&app)) < 0.05,
            "body: {is_body}: {seen} is not {}",
            at(&app)
        );
    }
}

#[test]
fn a_body_whose_colliders_are_children_is_carried_as_a_whole() {
    // The component is on the body, or on its collider.
    for on_root in [true, false] {
        let mut app = app();
        let surface = spawn(&mut app, &sheet(16), RigidBody::Static);
        settle(&mut app);
        let root = (RigidBody::Kinematic, CustomPositionIntegration, Visibility::default());
        let root = app
            .world_mut()
            .spawn((root, Transform::from_xyz(-1.0, 0.01, 0.05)))
            .id();
        let lower = (Collider::sphere(0.3), Transform::from_xyz(0.0, 0.3, 0.0), ChildOf(root));
        let lower = app.world_mut().spawn(lower).id();
        let upper = (Collider::sphere(0.3), Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(root));
        app.world_mut().spawn(upper);
        let carried = if on_root { root } else { lower };
        app.world_mut().entity_mut(carried).insert(MorphAvianCarry::default());
        run(&mut app, 10);
        for i in 1..=120 {
            set_weights(&mut app, surface, &[0.0, DT * i as f32]);
            run(&mut app, 1);
        }
        let ground = app.world().get::<MorphCharacterGround>(carried).unwrap();
        assert_eq!(ground.surface, Some(surface), "on the root: {on_root}");
        let (at, below) = (place(&app, root), place(&app, lower));
        assert!(
            at.distance(Vec3::new(1.0, 0.01, 0.05)) < 0.05,
            "on the root: {on_root}: {at}"
        );
        let inside = app.world().get::<Transform>(lower).unwrap().translation;
        assert!(
            inside.distance(Vec3::Y * 0.3) < 1e-4,
            "on the root: {on_root}: {inside}"
        );
        assert!(
            below.distance(at + Vec3::Y * 0.3) < 0.05,
            "on the root: {on_root}: {below}"
        );
    }
}

#[test]
fn without_the_component_a_surface_slides_away_below_a_character() {
    let (mut app, surface, character) = on_a_sheet((), (RigidBody::Kinematic, CustomPositionIntegration));
    for i in 1..=60 {
        set_weights(&mut app, surface, &[0.0, DT * i as f32]);
        run(&mut app, 1);
    }
    let x = app.world().get::<Transform>(character).unwrap().translation.x;
    assert!((x + 1.0).abs() < 1e-3, "{x}");
}

#[test]
fn a_floor_above_a_surface_and_a_wall_stop_what_is_carried() {
    // On a floor, the surface just below it does not matter.
    let (mut app, surface, character) = on_a_sheet((), kinematic());
    let floor = (
        RigidBody::Static,
        Collider::cuboid(8.0, 0.02, 8.0),
        Transform::from_xyz(0.0, 0.02, 0.0),
    );
    app.world_mut().spawn(floor);
    run(&mut app, 10);
    for i in 1..=60 {
        set_weights(&mut app, surface, &[0.0, DT * i as f32]);
        run(&mut app, 1);
    }
    let x = app.world().get::<Transform>(character).unwrap().translation.x;
    assert!((x + 1.0).abs() < 1e-3, "{x}");
    assert_eq!(
        app.world().get::<MorphCharacterGround>(character).unwrap().surface,
        None
    );

    // At a wall, it stays, and slides along it.
    let (mut app, surface, character) = on_a_sheet((), kinematic());
    let wall = (
        RigidBody::Static,
        Collider::cuboid(0.2, 4.0, 8.0),
        Transform::from_xyz(0.4, 1.0, 0.0),
    );
    app.world_mut().spawn(wall);
    for i in 1..=120 {
        set_weights(&mut app, surface, &[0.2 * DT * i as f32, DT * i as f32]);
        run(&mut app, 1);
    }
    let at = app.world().get::<Transform>(character).unwrap().translation;
    assert!((at.x - 0.0).abs() < 0.05, "{at}");
    assert!((at.y - 0.81 - 0.4).abs() < 0.02, "{at}");
}

#[test]
fn a_paused_game_carries_nothing() {
    let (mut app, surface, character) = on_a_sheet((), kinematic());
    for i in 1..=30 {
        set_weights(&mut app, surface, &[0.0, DT * i as f32]);
        run(&mut app, 1);
    }
    let at = |app: &App| app.world().get::<Position>(character).unwrap().0;
    app.world_mut().resource_mut::<Time<Physics>>().pause();
    run(&mut app, 1);
    let before = at(&app);
    run(&mut app, 30);
    assert_eq!(at(&app).x, before.x);
}

#[test]
fn velocities_are_those_of_the_last_step() {
    use bevy::ecs::system::RunSystemOnce;
    let (mut app, surface, _) = on_a_sheet((), kinematic());
    for i in 1..=30 {
        set_weights(&mut app, surface, &[0.5 * DT * i as f32, DT * i as f32]);
        run(&mut app, 1);
    }
    let ask = move |mut surfaces: MorphAvianVelocity| {
        (
            surfaces.surface_velocity(surface, Vec3::ZERO),
            surfaces.velocity_at(surface, 0, Vec3::new(0.2, 0.3, 0.5)),
            surfaces.surface_velocity(Entity::PLACEHOLDER, Vec3::ZERO),
        )
    };
    let (near, at, none) = app.world_mut().run_system_once(ask).unwrap();
    for velocity in [near, at] {
        assert!(
            velocity.unwrap().distance(Vec3::new(1.0, 0.5, 0.0)) < 1e-3,
            "{velocity:?}"
        );
    }
    assert_eq!(none, None);
}

#[test]
fn without_a_body_a_surface_is_no_ground_for_move_and_slide_as_with_any_collider() {
    for plain in [false, true] {
        let mut app = app();
        app.add_systems(FixedUpdate, walk);
        if plain {
            app.world_mut()
                .spawn((Collider::cuboid(8.0, 0.1, 8.0), Transform::from_xyz(0.0, -0.05, 0.0)));
        } else {
            spawn(&mut app, &sheet(16), ());
        }
        settle(&mut app);
        let parts = (Walker::default(), Collider::capsule(0.3, 1.0), RigidBody::Kinematic);
        let parts = (parts, CustomPositionIntegration, Transform::from_xyz(0.0, 0.82, 0.0));
        let character = app.world_mut().spawn(parts).id();
        run(&mut app, 60);
        assert!(place(&app, character).y < 0.0, "{plain}");
        // Bodies do rest on it.
        if !plain {
            let ball = body(&mut app, Collider::sphere(0.3), Vec3::new(2.0, 0.31, 0.0));
            run(&mut app, 30);
            assert!((place(&app, ball).y - 0.3).abs() < 1e-2);
        }
    }
}

#[test]
fn a_character_with_a_number_out_of_range_is_told_once_and_not_carried() {
    Errors::collect(|errors| {
        let (mut app, surface, character) = on_a_sheet((), kinematic());
        let good = MorphAvianCarry::default();
        let mut set = |carry: MorphAvianCarry| {
            app.world_mut().entity_mut(character).insert(carry);
            run(&mut app, 5);
            let ground = app.world().get::<MorphCharacterGround>(character).unwrap().surface;
            (errors.take().len(), ground)
        };
        assert_eq!(set(good), (0, Some(surface)));
        for bad in [
            MorphAvianCarry { reach: 0.0, ..good },
            MorphAvianCarry {
                reach: f32::NAN,
                ..good
            },
            MorphAvianCarry {
                max_slope: -0.1,
                ..good
            },
        ] {
            assert_eq!(set(bad), (1, None), "{bad:?}");
            assert_eq!(set(good), (0, Some(surface)));
        }
    });
}
