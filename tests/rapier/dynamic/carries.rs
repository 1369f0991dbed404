//! On the ground.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::DT;

use super::{HALF, floating, grounded, thing};
use crate::support::{place, run, set_weights, velocity};

#[test]
fn a_rising_side_lifts_at_its_speed() {
    for mass in [0.2, 1.0, 5.0] {
        let (mut app, surface) = grounded(3.0);
        let top = 2.0 * HALF.y;
        let ball = thing(&mut app, Collider::ball(0.3), mass, Vec3::Y * (top + 0.3), ());
        run(&mut app, 20);
        let mut worst = (0.0_f32, 0.0_f32, 0.0_f32);
        for frame in 1..=120 {
            let height = 0.5 * DT * frame as f32;
            set_weights(&mut app, surface, &[0.0, height]);
            run(&mut app, 1);
            let gap = place(&app, ball).y - 0.3 - top - height;
            let speed = velocity(&app, ball).y;
            if frame > 30 {
                worst = (
                    worst.0.max((speed - 0.5).abs()),
                    worst.1.max(gap.abs()),
                    worst.2.max((place(&app, surface).y - HALF.y).abs()),
                );
            }
        }
        println!("{mass}: {worst:?}");
        assert!(worst.0 < 0.01 && worst.1 < 1e-2 && worst.2 < 1e-2, "{mass}: {worst:?}");
    }
}

#[test]
fn a_conveyor_carries() {
    for mass in [1.0, 5.0] {
        let (mut app, surface) = floating(30.0);
        let at = Vec3::Y * (HALF.y + 0.2);
        let cuboid = thing(&mut app, Collider::cuboid(0.2, 0.2, 0.2), mass, at, ());
        app.world_mut()
            .entity_mut(surface)
            .insert(LockedAxes::TRANSLATION_LOCKED_Y | LockedAxes::ROTATION_LOCKED);
        for frame in 1..=60 {
            set_weights(&mut app, surface, &[0.0, 0.0, DT * frame as f32]);
            run(&mut app, 1);
        }
        let (box_speed, slab) = (velocity(&app, cuboid), velocity(&app, surface));
        println!("{mass}: {box_speed} {slab}");
        // They slide on the same surface, whose body goes back.
        assert!((box_speed.x - slab.x - 1.0).abs() < 0.05, "{mass}: {box_speed} {slab}");
        assert!(
            (mass * box_speed.x + 30.0 * slab.x).abs() < 0.05 * mass,
            "{mass}: {box_speed} {slab}"
        );
    }
}
