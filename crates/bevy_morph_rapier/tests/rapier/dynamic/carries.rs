//! Carrying on the ground.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::DT;

use super::{HALF, floating, grounded, spawn_on, thing};
use crate::support::{place, run, set_weights, slab_cut, velocity};

#[test]
fn a_rising_side_lifts_at_its_speed() {
    for mass in [0.2, 1.0, 5.0] {
        let (mut app, surface) = grounded(3.0);
        let top = 2.0 * HALF.y;
        let ball = thing(&mut app, Collider::ball(0.3), mass, Vec3::new(0.1, top + 0.3, 0.05), ());
        run(&mut app, 20);
        let mut worst = (0.0_f32, 0.0_f32, 0.0_f32);
        for frame in 1..=120 {
            let height = 0.5 * DT * frame as f32;
            set_weights(&mut app, surface, &[0.0, height, 0.0, 0.0]);
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
            set_weights(&mut app, surface, &[0.0, 0.0, DT * frame as f32, 0.0]);
            run(&mut app, 1);
        }
        let (box_speed, slab) = (velocity(&app, cuboid), velocity(&app, surface));
        println!("{mass}: {box_speed} {slab}");
        // They slide on the same surface, whose body moves back.
        assert!((box_speed.x - slab.x - 1.0).abs() < 0.05, "{mass}: {box_speed} {slab}");
        assert!(
            (mass * box_speed.x + 30.0 * slab.x).abs() < 0.05 * mass,
            "{mass}: {box_speed} {slab}"
        );
    }
}

#[test]
fn it_lifts_in_every_mode_of_steps() {
    let modes = [
        TimestepMode::Fixed { dt: DT, substeps: 3 },
        TimestepMode::Variable {
            max_dt: 0.1,
            time_scale: 1.0,
            substeps: 1,
        },
        TimestepMode::Interpolated {
            dt: DT * 0.7,
            time_scale: 1.0,
            substeps: 2,
        },
    ];
    for mode in modes {
        let (mut app, surface) = grounded(3.0);
        app.insert_resource(mode);
        let ball = thing(&mut app, Collider::ball(0.3), 1.0, Vec3::Y * (2.0 * HALF.y + 0.3), ());
        run(&mut app, 20);
        for frame in 1..=90 {
            set_weights(&mut app, surface, &[0.0, 0.5 * DT * frame as f32, 0.0, 0.0]);
            run(&mut app, 1);
            let speed = velocity(&app, ball).y;
            assert!(frame < 30 || (speed - 0.5).abs() < 0.02, "{mode:?}, {frame}: {speed}");
        }
        assert!(
            (place(&app, surface).y - HALF.y).abs() < 1e-2,
            "{mode:?}: {}",
            place(&app, surface)
        );
    }
}

/// The final state of a box on a stack of blocks.
#[derive(Debug)]
struct Stacked {
    /// The height above the expected one.
    too_high: f32,
    /// The sideways drift.
    drift: f32,
    /// The largest deviation from the combined growth speed of the blocks.
    off_speed: f32,
}

/// A box on blocks of 1 that each grow at 0.25/s for two seconds. Each is a little narrower than the one below it.
fn stack(blocks: usize, mass: f32) -> Stacked {
    let mut app = crate::support::app();
    app.world_mut()
        .spawn((Collider::cuboid(50.0, 0.5, 50.0), Transform::from_xyz(0.0, -0.5, 0.0)));
    let blocks: Vec<_> = (0..blocks)
        .map(|i| {
            let half = Vec3::new(0.5, 0.25, 0.5) - 0.03 * i as f32 * Vec3::new(1.0, 0.0, 1.0);
            let at = Vec3::Y * (half.y * (1 + 2 * i) as f32 + 0.01 * (i + 1) as f32);
            // They fall together once all have surfaces: how long each has lain would depend on how long trees take to build.
            spawn_on(&mut app, &slab_cut(half, 2), 1.0, at, GravityScale(0.0))
        })
        .collect();
    for &block in &blocks {
        app.world_mut().entity_mut(block).insert(GravityScale(1.0));
    }
    let (floor, speed) = (0.5 * blocks.len() as f32, 0.25 * blocks.len() as f32);
    run(&mut app, 60);
    let at = Vec3::Y * (floor + 0.26);
    let cuboid = thing(&mut app, Collider::cuboid(0.25, 0.25, 0.25), mass, at, ());
    run(&mut app, 60);
    let at = place(&app, cuboid);
    let mut off_speed = 0.0_f32;
    for frame in 1..=120 {
        for &block in &blocks {
            set_weights(&mut app, block, &[0.0, 0.25 * DT * frame as f32, 0.0, 0.0]);
        }
        run(&mut app, 1);
        if frame > 30 {
            off_speed = off_speed.max((velocity(&app, cuboid).y - speed).abs());
        }
    }
    run(&mut app, 60);
    let end = place(&app, cuboid) - at;
    Stacked {
        too_high: end.y - 2.0 * speed,
        drift: end.xz().length(),
        off_speed,
    }
}

#[test]
fn stacks_of_growing_blocks_stand() {
    for blocks in [1, 2, 4] {
        let stacked = stack(blocks, 1.0);
        println!("{blocks}: {stacked:?}");
        // A stack of four is never quite at rest. Depending on how long each block has lain when the next one comes, it may also fall.
        assert!(stacked.too_high.abs() < 0.03, "{blocks}: {stacked:?}");
        assert!(stacked.drift < 0.25 && stacked.off_speed < 0.3, "{blocks}: {stacked:?}");
    }
    // A box that is five times as heavy as each of four blocks wanders more.
    let heavy = stack(4, 5.0);
    println!("heavy: {heavy:?}");
    assert!(heavy.too_high.abs() < 0.05 && heavy.drift < 0.4, "{heavy:?}");
}
