//! The cost of surfaces, and how they work together with the rest of an app.

use std::path::Path;

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use morph_collision_models::generated::random;
use morph_collision_workspace::app::headless;
use morph_collision_workspace::physics::{settle, sheet};

use crate::log::{Errors, start};
use crate::support::{app, ball_on_sheet, body, diagnostics, is_asleep, place, population, run, set_weights, spawn};

#[test]
fn parts_come_with_bodies_and_go_with_them() {
    let (mut app, _, ball) = ball_on_sheet();
    assert_eq!(population(&mut app), (3, 1));
    app.world_mut().entity_mut(ball).despawn();
    run(&mut app, 2);
    assert_eq!(population(&mut app), (1, 0));
}

#[test]
fn what_nothing_can_touch_is_not_blended() {
    let (mut app, surface, ball) = ball_on_sheet();
    // A second surface far away.
    let far = spawn(&mut app, &sheet(16), Transform::from_xyz(100.0, 0.0, 0.0));
    settle(&mut app);
    run(&mut app, 3);
    let resting = diagnostics(&app);
    assert_eq!((resting.surfaces, resting.moving, resting.parts), (2, 0, 1));
    assert_eq!(resting.blended, 0, "nothing moves, the ball stays where it is");
    for i in 1..=10 {
        for surface in [surface, far] {
            set_weights(&mut app, surface, &[0.01 * i as f32, 0.0]);
        }
        run(&mut app, 1);
        let moving = diagnostics(&app);
        assert_eq!((moving.moving, moving.parts, moving.blended), (2, 1, 1));
    }
    // A sleeping body on a resting surface needs no work.
    run(&mut app, 120);
    assert!(is_asleep(&app, ball));
    assert_eq!((diagnostics(&app).parts, diagnostics(&app).blended), (1, 0));
    assert!((place(&app, ball).y - 0.4).abs() < 1e-2, "{}", place(&app, ball));
}

#[test]
fn bodies_each_have_their_ground_and_move_with_it() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(32), ());
    settle(&mut app);
    let balls: Vec<Entity> = (0..25)
        .map(|i| {
            let place = Vec3::new((i % 5) as f32 * 0.65 - 1.3, 0.31, (i / 5) as f32 * 0.65 - 1.3);
            body(&mut app, Collider::sphere(0.3), place)
        })
        .collect();
    run(&mut app, 20);
    for i in 1..=60 {
        set_weights(&mut app, surface, &[0.01 * i as f32, 0.0]);
        run(&mut app, 1);
        // No contacts are computed between parts.
        for pair in app.world().resource::<ContactGraph>().iter_active() {
            let is_part = |entity: &Entity| app.world().entity(*entity).contains::<MorphAvianPart>();
            let met = [pair.collider1, pair.collider2];
            assert!(!met.iter().all(is_part), "{met:?} in step {i}");
        }
    }
    for ball in balls {
        assert!((place(&app, ball).y - 0.9).abs() < 1e-2, "{}", place(&app, ball));
    }
}

#[test]
fn a_collider_that_is_too_large_is_left_out_and_logged_once() {
    Errors::collect(|_| {
        Errors::collect(|errors| {
            let mut app = app();
            spawn(&mut app, &sheet(16), ());
            settle(&mut app);
            let huge = body(&mut app, Collider::cuboid(1e12, 1.0, 1e12), Vec3::new(0.0, 3.0, 0.0));
            app.world_mut().entity_mut(huge).insert(Name::new("huge"));
            run(&mut app, 20);
            let errors = errors.take();
            assert!(errors.len() == 1 && errors[0].contains("huge"), "{errors:?}");
        });
    });
}

#[test]
fn without_avian_it_says_so_and_does_nothing() {
    Errors::collect(|_| {
        Errors::collect(|errors| {
            let mut app = headless(Path::new("."));
            app.add_plugins(MorphAvianPlugin);
            start(&mut app);
            spawn(&mut app, &sheet(4), ());
            run(&mut app, 3);
            let errors = errors.take();
            assert!(errors.len() == 1 && errors[0].contains("PhysicsPlugins"), "{errors:?}");
        });
    });
}

#[test]
fn a_systems_order_of_the_games_own_is_not_refused() {
    let mut app = crate::support::unfinished();
    // Avian treats unordered systems as an error.
    app.add_systems(
        PhysicsSchedule,
        (|mut bodies: Query<&mut LinearVelocity>| bodies.iter_mut().for_each(|mut body| body.x += 0.0))
            .before(PhysicsStepSystems::BroadPhase)
            .after(PhysicsStepSystems::First),
    );
    start(&mut app);
    spawn(&mut app, &sheet(4), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::sphere(0.3), Vec3::new(0.1, 0.31, 0.05));
    run(&mut app, 30);
    assert!((place(&app, ball).y - 0.3).abs() < 1e-2, "{}", place(&app, ball));
}

#[test]
fn the_mass_of_a_large_surface_is_there_when_a_body_needs_it_and_elsewhere_a_few_steps_later() {
    let mut app = app();
    let mesh = random::random_blob(1, 4, 1, 0.0);
    let fixed = spawn(&mut app, &mesh, ());
    let body = (RigidBody::Dynamic, GravityScale(0.0));
    let falling = spawn(&mut app, &mesh, (Transform::from_xyz(10.0, 0.0, 0.0), body));
    let mass = |app: &App, surface: Entity| app.world().get::<ColliderMassProperties>(surface).unwrap().mass;
    // Trees are built in the background, so either may come first.
    let mut first = [None; 2];
    while first.contains(&None) {
        app.update();
        for (first, surface) in first.iter_mut().zip([fixed, falling]) {
            if first.is_none() && app.world().get::<Collider>(surface).is_some() {
                *first = Some(mass(&app, surface));
            }
        }
    }
    let [of_fixed, of_falling] = first.map(Option::unwrap_or_default);
    let corners = mesh
        .triangles
        .iter()
        .map(|t| t.map(|i| mesh.positions[i as usize].as_dvec3()));
    let volume = corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum::<f64>() as f32;
    let is_right = |mass: f32| (mass / volume - 1.0).abs() < 1e-4;
    assert!(is_right(of_falling), "{of_falling} {volume}");
    assert_eq!(of_fixed, 0.0, "it takes a few steps");
    run(&mut app, 10);
    assert!(is_right(mass(&app, fixed)), "{} {volume}", mass(&app, fixed));
    let of_body = app.world().get::<ComputedMass>(falling).unwrap().value();
    assert!(is_right(of_body), "{of_body} {volume}");
}
