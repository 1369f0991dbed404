//! The cost of surfaces, and how they work together with the rest of an app.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use morph_collision_workspace::physics::{settle, sheet};

use crate::log::start;
use crate::support::{app, body, collect_errors, place, run, set_weights, spawn};

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
    collect_errors(|errors| {
        let mut app = app();
        spawn(&mut app, &sheet(16), ());
        settle(&mut app);
        let huge = body(&mut app, Collider::cuboid(1e12, 1.0, 1e12), Vec3::new(0.0, 3.0, 0.0));
        app.world_mut().entity_mut(huge).insert(Name::new("huge"));
        run(&mut app, 20);
        let errors = errors.take();
        assert!(errors.len() == 1 && errors[0].contains("huge"), "{errors:?}");
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
