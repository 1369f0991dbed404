//! What stops bullets, and what does not.

use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::support::{app, diagnostics, place, put, run, set_weights, slab, spawn, velocity};

/// A bullet above a sheet, on its way down.
fn bullet_above_a_sheet() -> (App, Entity, Entity) {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let bullet = body(&mut app, Collider::ball(0.02), Vec3::new(0.1, 1.0, 0.05));
    let falling = Velocity::linear(Vec3::Y * -20.0);
    app.world_mut().entity_mut(bullet).insert(falling);
    (app, surface, bullet)
}

#[test]
fn what_a_surface_does_not_push_passes() {
    // By collision groups, by solver groups, and because it is put on the other side.
    for way in 0..3 {
        let (mut app, _, bullet) = bullet_above_a_sheet();
        let alone = Group::GROUP_1;
        let mut entity = app.world_mut().entity_mut(bullet);
        match way {
            0 => _ = entity.insert(CollisionGroups::new(alone, Group::NONE)),
            1 => _ = entity.insert(SolverGroups::new(alone, Group::NONE)),
            _ => put(&mut app, bullet, Vec3::new(0.1, -0.5, 0.05)),
        }
        run(&mut app, 20);
        assert!(place(&app, bullet).y < -0.5, "{way}: {}", place(&app, bullet));
    }
}

#[test]
fn a_surface_that_jumps_over_a_bullet_does_not_take_it_along() {
    let (mut app, surface, bullet) = bullet_above_a_sheet();
    app.world_mut()
        .entity_mut(bullet)
        .insert((Velocity::zero(), GravityScale(0.0)));
    set_weights(&mut app, surface, &[2.0, 0.0]);
    run(&mut app, 20);
    assert!((place(&app, bullet).y - 1.0).abs() < 1e-3, "{}", place(&app, bullet));
}

#[test]
fn bullets_leave_a_solid_surface_and_do_not_come_in() {
    let mut app = app();
    let surface = spawn(&mut app, &slab(Vec3::new(1.0, 0.25, 1.0)), ());
    let solid = MorphPhysicsCollider {
        solid: true,
        ..default()
    };
    app.world_mut().entity_mut(surface).insert(solid);
    settle(&mut app);
    let shoot = |app: &mut App, x: f32, y: f32, speed: f32| {
        let bullet = body(app, Collider::ball(0.02), Vec3::new(x, y, 0.05));
        let flight = (Velocity::linear(Vec3::Y * speed), GravityScale(0.0));
        app.world_mut().entity_mut(bullet).insert(flight);
        bullet
    };
    let out = shoot(&mut app, -0.3, 0.1, 20.0);
    let from_above = shoot(&mut app, 0.1, 1.0, -20.0);
    let from_below = shoot(&mut app, 0.4, -1.0, 20.0);
    for step in 1..=30 {
        // Its upper side rises.
        set_weights(&mut app, surface, &[0.0, 2.0 * DT * step as f32, 0.0, 0.0]);
        run(&mut app, 1);
    }
    assert!(place(&app, out).y > 2.0, "{}", place(&app, out));
    assert!(place(&app, from_above).y > 1.25, "{}", place(&app, from_above));
    assert!(place(&app, from_below).y < -0.25, "{}", place(&app, from_below));
}

#[test]
fn a_body_whose_axes_are_locked_stays() {
    let (mut app, surface, bullet) = bullet_above_a_sheet();
    app.world_mut()
        .entity_mut(bullet)
        .insert((Velocity::zero(), LockedAxes::TRANSLATION_LOCKED));
    for step in 1..=60 {
        set_weights(&mut app, surface, &[2.0 * DT * step as f32, 0.0]);
        run(&mut app, 1);
    }
    assert_eq!(place(&app, bullet), Vec3::new(0.1, 1.0, 0.05));
}

#[test]
fn what_lies_on_a_thin_floor_is_not_put_below_it() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    set_weights(&mut app, surface, &[1.0, 0.0]);
    run(&mut app, 5);
    let corners = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let floor = Collider::trimesh(corners.to_vec(), vec![[0, 2, 1], [0, 3, 2]]).unwrap();
    app.world_mut().spawn((floor, Transform::default()));
    let debris: Vec<Entity> = (0..9)
        .map(|i| {
            let at = Vec3::new(0.2 * (i % 3) as f32 + 0.03, 0.05, 0.2 * (i / 3) as f32 + 0.07);
            body(&mut app, Collider::ball(0.05), at)
        })
        .collect();
    run(&mut app, 30);
    for step in 1..=60 {
        set_weights(&mut app, surface, &[1.0 - 2.0 * DT * step as f32, 0.0]);
        run(&mut app, 1);
        let lowest = debris.iter().map(|&ball| place(&app, ball).y).fold(f32::MAX, f32::min);
        assert!(lowest > 0.0, "{lowest} in step {step}");
    }
}

#[test]
fn a_body_with_several_colliders_is_moved_back_once() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let dumbbells: Vec<Entity> = (0..48)
        .map(|i| {
            let at = Vec3::new((i % 8) as f32 - 3.4, 2.5 + 0.04 * i as f32, (i / 8) as f32 - 2.4);
            let speed = if i % 2 == 0 { 20.0 } else { 100.0 };
            let flight = (Transform::from_translation(at), Velocity::linear(Vec3::Y * -speed));
            let dumbbell = (RigidBody::Dynamic, flight, LockedAxes::ROTATION_LOCKED);
            let dumbbell = app.world_mut().spawn(dumbbell).id();
            for x in [-0.1, 0.1] {
                let ball = (
                    Collider::ball(0.02),
                    Transform::from_xyz(x, 0.0, 0.0),
                    ChildOf(dumbbell),
                );
                app.world_mut().spawn(ball);
            }
            dumbbell
        })
        .collect();
    for step in 1..=60 {
        let height = 5.0 * DT * step as f32;
        set_weights(&mut app, surface, &[height, 0.0]);
        run(&mut app, 1);
        for &dumbbell in &dumbbells {
            let above = place(&app, dumbbell).y - height;
            assert!(above > 0.0, "{above} in step {step}");
            // It stops where it arrives.
            let stopped = velocity(&app, dumbbell).y > 0.0;
            assert!(!stopped || above < 0.03, "{above} above the sheet in step {step}");
        }
    }
}

/// A hundred crates on a sheet that slides. Returns the numbers of those that were compared with its triangles and of those for
/// which there was too much to do, in each of a few steps.
fn compared(cells: u32, slide: f32, speed: f32) -> Vec<(u32, u32)> {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(cells), ());
    settle(&mut app);
    for i in 0..100 {
        let at = Vec3::new(0.6 * (i % 10) as f32 - 2.7, 0.101, 0.6 * (i / 10) as f32 - 2.7);
        let load = body(&mut app, Collider::cuboid(0.1, 0.1, 0.1), at);
        let more = (Velocity::linear(Vec3::X * speed), Friction::new(0.0), GravityScale(0.0));
        app.world_mut().entity_mut(load).insert(more);
    }
    let mut counts = Vec::new();
    for step in 1..=4 {
        set_weights(&mut app, surface, &[0.0, slide * DT * step as f32]);
        run(&mut app, 1);
        let counted = diagnostics(&app);
        counts.push((counted.compared_bodies, counted.limited_bodies));
    }
    counts
}

#[test]
fn only_what_moves_fast_relative_to_the_surface_is_compared() {
    // The first step may be a jump.
    assert_eq!(compared(16, 10.0, 10.0)[1..], [(0, 0); 3], "riding crates");
    assert_eq!(compared(16, 10.0, 0.0)[1..], [(100, 0); 3], "crates at rest");
    // A jump passes nothing.
    assert_eq!(compared(16, 1000.0, 0.0)[0], (0, 0), "a jump");
}

#[test]
fn the_work_of_a_step_is_limited() {
    let counts = compared(128, 60.0, 0.0);
    // Then the sheet is away.
    let (some, others) = counts[1];
    assert!(some > 0 && others > 0 && some + others == 100, "{counts:?}");
}

#[test]
fn while_a_game_holds_back_the_step_nothing_is_moved() {
    let (mut app, surface, bullet) = bullet_above_a_sheet();
    app.configure_sets(PostUpdate, PhysicsSet::StepSimulation.run_if(|| false));
    for step in 1..=60 {
        set_weights(&mut app, surface, &[2.0 * DT * step as f32, 0.0]);
        run(&mut app, 1);
    }
    assert_eq!(place(&app, bullet), Vec3::new(0.1, 1.0, 0.05));
}
