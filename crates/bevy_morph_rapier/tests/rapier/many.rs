//! Many surfaces and many bodies.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::support::{app, diagnostics, run, set_weights, spawn, velocity};

#[test]
fn every_body_is_pushed_by_the_surface_below_it() {
    let mut app = app();
    let mesh = sheet(4);
    let at = |i: u8| 10.0 * f32::from(i);
    // All bodies are in one row, so only their place along it distinguishes them; the last surface comes
    // first.
    let surfaces: Vec<Entity> = (0..24)
        .rev()
        .map(|i| spawn(&mut app, &mesh, Transform::from_xyz(at(i), 0.0, 0.0)))
        .collect();
    settle(&mut app);
    let mut ball = |x: f32| {
        let ball = body(&mut app, Collider::ball(0.3), Vec3::new(x, 0.31, 0.1));
        app.world_mut().entity_mut(ball).insert(Sleeping::disabled());
        ball
    };
    let carried: Vec<Entity> = (0..24).map(|i| ball(at(i) + 0.2)).collect();
    let beside: Vec<Entity> = (0..24).map(|i| ball(at(i) + 5.0)).collect();
    for &floating in &beside {
        app.world_mut().entity_mut(floating).insert(GravityScale(0.0));
    }
    run(&mut app, 30);
    for step in 1..=60_u8 {
        for &surface in &surfaces {
            set_weights(&mut app, surface, &[0.5 * DT * f32::from(step), 0.0]);
        }
        app.update();
    }
    assert_eq!(diagnostics(&app).parts, 24, "one for each ball on a sheet");
    for (&carried, &beside) in carried.iter().zip(&beside) {
        let speed = velocity(&app, carried).y;
        assert!((speed - 0.5).abs() < 0.01, "{speed}");
        assert_eq!(velocity(&app, beside), Vec3::ZERO);
    }
}
