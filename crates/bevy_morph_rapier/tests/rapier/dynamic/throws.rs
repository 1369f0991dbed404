//! Throwing in free space.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::DT;

use super::{HALF, floating, thing};
use crate::support::{run, set_weights, velocity};

/// Speeds of a ball and of a slab with mass 3 that hits it at 5/s.
fn slap(mass: f32) -> (Vec3, Vec3) {
    let (mut app, surface) = floating(3.0);
    let at = Vec3::Y * (HALF.y + 0.3 + 0.1);
    let ball = thing(&mut app, Collider::ball(0.3), mass, at, GravityScale(0.0));
    for frame in 1..=12 {
        set_weights(&mut app, surface, &[0.0, 5.0 * DT * frame as f32, 0.0, 0.0]);
        run(&mut app, 1);
    }
    run(&mut app, 30);
    (velocity(&app, ball), velocity(&app, surface))
}

#[test]
fn slaps_throw_and_keep_momentum() {
    for (mass, expected) in [(0.2, 4.688), (1.0, 3.75), (10.0, 1.154)] {
        let (ball, slab) = slap(mass);
        println!("{mass}: {ball} {slab}");
        assert!((ball.y - expected).abs() < 0.05 * expected, "{mass}: {ball}");
        let momentum = mass * ball + 3.0 * slab;
        assert!(momentum.length() < 1e-3 * mass * expected, "{mass}: {momentum}");
    }
}
