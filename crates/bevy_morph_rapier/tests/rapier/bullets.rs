//! What stops bullets, and what does not.

use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::support::{app, place, put, run, set_weights, slab, spawn};

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
fn while_a_game_holds_back_the_step_nothing_is_moved() {
    let (mut app, surface, bullet) = bullet_above_a_sheet();
    app.configure_sets(PostUpdate, PhysicsSet::StepSimulation.run_if(|| false));
    for step in 1..=60 {
        set_weights(&mut app, surface, &[2.0 * DT * step as f32, 0.0]);
        run(&mut app, 1);
    }
    assert_eq!(place(&app, bullet), Vec3::new(0.1, 1.0, 0.05));
}
