//! Bodies on a surface that moves.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

use crate::support::{DT, app, body, place, run, set_weights, settle, sheet, spawn, velocity};

/// A sheet, and a body on it that has come to rest.
fn on_the_sheet(collider: Collider, height: f32) -> (App, Entity, Entity) {
    let mut app = app();
    let sheet = spawn(&mut app, &sheet(), ());
    settle(&mut app);
    let body = body(&mut app, collider, Vec3::new(0.1, height, 0.05));
    run(&mut app, 60);
    assert!(
        (place(&app, body).y - 0.5).abs() < 1e-2,
        "it rests at {}",
        place(&app, body)
    );
    (app, sheet, body)
}

#[test]
fn a_ball_on_a_rising_surface_has_its_velocity() {
    let (mut app, sheet, ball) = on_the_sheet(Collider::ball(0.5), 0.52);
    for i in 1..=120 {
        let height = 0.5 * DT * i as f32;
        set_weights(&mut app, sheet, &[height, 0.0]);
        run(&mut app, 1);
        if i > 10 {
            let (gap, speed) = (place(&app, ball).y - 0.5 - height, velocity(&app, ball).y);
            assert!(gap.abs() < 1e-2, "gap {gap} in step {i}");
            assert!((speed - 0.5).abs() < 0.025, "velocity {speed} in step {i}");
        }
    }
    for i in 1..=120 {
        let height = 1.0 - 0.5 * DT * i as f32;
        set_weights(&mut app, sheet, &[height, 0.0]);
        run(&mut app, 1);
        if i > 30 {
            let gap = place(&app, ball).y - 0.5 - height;
            assert!(gap.abs() < 1e-2, "gap {gap} in step {i} down");
        }
    }
}

#[test]
fn a_box_on_a_sliding_surface_is_carried() {
    let (mut app, sheet, cuboid) = on_the_sheet(Collider::cuboid(0.5, 0.5, 0.5), 0.51);
    for i in 1..=120 {
        set_weights(&mut app, sheet, &[0.0, DT * i as f32]);
        run(&mut app, 1);
    }
    let speed = velocity(&app, cuboid).x;
    assert!((speed - 1.0).abs() < 0.05, "velocity {speed}");
    let lag = 2.0 + 0.1 - place(&app, cuboid).x;
    assert!(lag.abs() < 0.15, "behind by {lag}");
}

#[test]
fn a_slap_throws_a_ball() {
    let (mut app, sheet, ball) = on_the_sheet(Collider::ball(0.5), 0.52);
    // Up by 0.5 within a tenth of a second.
    for i in 1..=6 {
        set_weights(&mut app, sheet, &[i as f32 / 12.0, 0.0]);
        run(&mut app, 1);
    }
    let speed = velocity(&app, ball).y;
    assert!((4.0..6.0).contains(&speed), "thrown at {speed}");
    let mut highest: f32 = 0.0;
    for _ in 0..60 {
        run(&mut app, 1);
        highest = highest.max(place(&app, ball).y);
    }
    assert!((1.7..3.0).contains(&highest), "thrown to {highest}");
}

#[test]
fn a_jump_does_not_throw() {
    let (mut app, sheet, ball) = on_the_sheet(Collider::ball(0.5), 0.52);
    set_weights(&mut app, sheet, &[0.2, 0.0]);
    let mut highest: f32 = 0.0;
    for _ in 0..120 {
        run(&mut app, 1);
        highest = highest.max(place(&app, ball).y);
    }
    assert!(highest < 0.8, "thrown to {highest}");
    assert!(
        (place(&app, ball).y - 0.7).abs() < 1e-2,
        "it rests at {}",
        place(&app, ball)
    );
}

#[test]
fn a_sleeping_body_wakes_when_the_surface_comes_or_goes() {
    for direction in [1.0, -1.0] {
        let (mut app, sheet, cuboid) = on_the_sheet(Collider::cuboid(0.5, 0.5, 0.5), 0.51);
        app.world_mut().entity_mut(cuboid).insert(Sleeping::default());
        run(&mut app, 300);
        let asleep = |app: &App| app.world().entity(cuboid).get::<Sleeping>().unwrap().sleeping;
        assert!(asleep(&app));
        for i in 1..=60 {
            set_weights(&mut app, sheet, &[direction * 0.5 * DT * i as f32, 0.0]);
            run(&mut app, 1);
            assert!(!asleep(&app), "asleep in step {i}");
        }
        run(&mut app, 10);
        let height = place(&app, cuboid).y;
        assert!((height - 0.5 - 0.5 * direction).abs() < 1e-2, "{height}");
    }
}
