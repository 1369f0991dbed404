//! On the ground.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::DT;

use super::{HALF, floating, grounded, spawn_on, thing};
use crate::support::{place, run, set_weights, slab_cut, velocity};

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
        // They slide on the same surface, whose body goes back.
        assert!((box_speed.x - slab.x - 1.0).abs() < 0.05, "{mass}: {box_speed} {slab}");
        assert!(
            (mass * box_speed.x + 30.0 * slab.x).abs() < 0.05 * mass,
            "{mass}: {box_speed} {slab}"
        );
    }
}

/// A box on blocks that each grow at 0.25/s for two seconds: how far off its height ends, the fastest it was, and its drift.
fn stack(blocks: usize, mass: f32, times: usize, solid: bool, shrink: f32, grows: f32) -> (f32, f32, f32) {
    let mut app = crate::support::app();
    app.world_mut()
        .spawn((Collider::cuboid(50.0, 0.5, 50.0), Transform::from_xyz(0.0, -0.5, 0.0)));
    let blocks: Vec<_> = (0..blocks)
        .map(|i| {
            let half = Vec3::new(0.5 - shrink * i as f32, 0.25, 0.5 - shrink * i as f32);
            let at = Vec3::Y * half.y * (1 + 2 * i) as f32;
            let block = spawn_on(&mut app, &slab_cut(half, times), 1.0, at, ());
            app.world_mut()
                .entity_mut(block)
                .insert(MorphRapierCollider { solid, ..default() });
            block
        })
        .collect();
    let floor = 0.5 * blocks.len() as f32;
    let cuboid = thing(
        &mut app,
        Collider::cuboid(0.25, 0.25, 0.25),
        mass,
        Vec3::Y * (floor + 0.25),
        (),
    );
    run(&mut app, 60);
    let mut fastest = 0.0_f32;
    for frame in 1..=120 {
        for &block in &blocks {
            set_weights(&mut app, block, &[0.0, grows * DT * frame as f32, 0.0, 0.0]);
        }
        run(&mut app, 1);
        if frame > 30 {
            fastest = fastest.max((velocity(&app, cuboid).y - grows * blocks.len() as f32).abs());
        }
    }
    run(&mut app, 60);
    let end = place(&app, cuboid);
    (
        end.y - floor - 0.25 - 2.0 * grows * blocks.len() as f32,
        fastest,
        end.xz().length(),
    )
}

#[test]
fn stacks_of_growing_blocks_stand() {
    for (times, solid, shrink, grows) in [
        (2, false, 0.0, 0.0),
        (2, false, 0.0, 0.25),
        (2, true, 0.0, 0.0),
        (2, true, 0.0, 0.25),
        (2, false, 0.03, 0.0),
        (2, false, 0.03, 0.25),
        (2, true, 0.03, 0.25),
        (3, true, 0.03, 0.25),
    ] {
        for (blocks, mass) in [(1, 1.0), (2, 1.0), (3, 1.0), (4, 1.0), (4, 5.0)] {
            let start = std::time::Instant::now();
            let (error, shake, drift) = stack(blocks, mass, times, solid, shrink, grows);
            println!(
                "cut {times} solid {solid} shrink {shrink} grows {grows} {blocks} {mass}: {error:.4} {shake:.4} {drift:.4} {:?}",
                start.elapsed()
            );
        }
    }
}
