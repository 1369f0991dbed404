//! Bodies on a surface that moves.

use bevy::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{
    DT, app, ball, body, cuboid, fall_asleep, is_asleep, on_the_sheet, place, run, set_weights, spawn, velocity,
};

#[test]
fn a_ball_on_a_rising_surface_has_its_velocity_and_stays_on_a_falling_one() {
    let (mut app, sheet, ball) = on_the_sheet(ball(0.5));
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
    let (mut app, sheet, cuboid) = on_the_sheet(cuboid(Vec3::splat(0.5)));
    for i in 1..=120 {
        set_weights(&mut app, sheet, &[0.0, DT * i as f32]);
        run(&mut app, 1);
    }
    let speed = velocity(&app, cuboid).x;
    assert!((speed - 1.0).abs() < 0.02, "velocity {speed}");
    let lag = 2.0 + 0.1 - place(&app, cuboid).x;
    assert!(lag.abs() < 0.15, "behind by {lag}");
}

#[test]
fn a_slap_throws_a_ball() {
    let (mut app, sheet, ball) = on_the_sheet(ball(0.5));
    // Rises by 0.5 within a tenth of a second.
    for i in 1..=6 {
        set_weights(&mut app, sheet, &[i as f32 / 12.0, 0.0]);
        run(&mut app, 1);
    }
    let speed = velocity(&app, ball).y;
    assert!((4.5..5.5).contains(&speed), "thrown at {speed}");
    let mut highest: f32 = 0.0;
    for _ in 0..60 {
        run(&mut app, 1);
        highest = highest.max(place(&app, ball).y);
    }
    assert!((1.9..2.6).contains(&highest), "thrown to {highest}");
}

#[test]
fn a_jump_does_not_throw() {
    for jump in [0.05, 0.2, 0.4] {
        let (mut app, sheet, ball) = on_the_sheet(ball(0.5));
        set_weights(&mut app, sheet, &[jump, 0.0]);
        let mut highest: f32 = 0.0;
        for _ in 0..120 {
            run(&mut app, 1);
            highest = highest.max(place(&app, ball).y);
        }
        assert!(highest < 0.6 + jump, "thrown to {highest} by {jump}");
        let rests = place(&app, ball).y;
        assert!((rests - 0.5 - jump).abs() < 1e-2, "it rests at {rests} after {jump}");
    }
}

#[test]
fn a_sleeping_body_wakes_when_the_surface_comes_or_goes() {
    for direction in [1.0, -1.0] {
        let (mut app, sheet, cuboid) = on_the_sheet(cuboid(Vec3::splat(0.5)));
        fall_asleep(&mut app, cuboid);
        for i in 1..=60 {
            set_weights(&mut app, sheet, &[direction * 0.5 * DT * i as f32, 0.0]);
            run(&mut app, 1);
            assert!(!is_asleep(&app, cuboid), "asleep in step {i}");
        }
        run(&mut app, 10);
        let height = place(&app, cuboid).y;
        assert!((height - 0.5 - 0.5 * direction).abs() < 1e-2, "{height}");
    }
}

/// A sheet that stretches along x. With the weight as its speed, it slides at 3 per second where x is 3, and at -1 where x is -1.
pub(crate) fn stretching() -> MorphMesh {
    let mut mesh = sheet(32);
    mesh.targets = vec![mesh.positions.iter().map(|p| Vec3::X * p.x).collect()];
    mesh
}

/// Stretches such a sheet by a fifth per second, and checks that each body moves as its own ground does.
pub(crate) fn stretch(app: &mut App, surface: Entity, bodies: &[(f32, Entity)]) {
    for i in 1..=30 {
        set_weights(app, surface, &[0.2 * DT * i as f32]);
        run(app, 1);
    }
    for &(x, body) in bodies {
        let speed = velocity(app, body).x;
        assert!((speed - 0.2 * x).abs() < 0.05 * (0.2 * x).abs(), "at {x}: {speed}");
    }
}

#[test]
fn what_lies_on_a_growing_surface_moves_as_its_own_place_does() {
    let mut app = app();
    let surface = spawn(&mut app, &stretching(), ());
    settle(&mut app);
    let small = |app: &mut App, x: f32| body(app, cuboid(Vec3::splat(0.1)), Vec3::new(x, 0.11, 0.3));
    let cuboids = [-2.0, -1.0, 1.0, 3.0].map(|x| (x, small(&mut app, x)));
    run(&mut app, 30);
    stretch(&mut app, surface, &cuboids);
}
