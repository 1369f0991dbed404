//! How surfaces carry characters.

use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::physics::{DT, settle, sheet};

use super::{OFFSET, STANDING, character, ground, is_grounded, move_by, on_sheet, ride, sliding, walk, walk_once};
use crate::support::{app, place, run, set_weights, spawn};

#[test]
fn a_surface_that_slides_and_rises_carries_a_character() {
    for (mut app, surface, walker) in [on_sheet(()), on_sheet(RigidBody::KinematicPositionBased)] {
        let (grounded, moved, [least, greatest]) = ride(&mut app, surface, walker, Vec2::new(0.5, 1.0), 240);
        let truth = Vec3::new(4.0, 2.0, 0.0);
        assert!(grounded as f32 >= 0.99 * 240.0, "{grounded}");
        assert!((moved - truth).length() < 0.02 * truth.length(), "{moved}");
        assert!(
            least > OFFSET - 0.011 && greatest < OFFSET + 2e-3,
            "{least} to {greatest}"
        );
        let ground = ground(&app, walker);
        assert_eq!(ground.surface, Some(surface));
        assert!(
            (ground.velocity - Vec3::new(1.0, 0.5, 0.0)).length() < 1e-3,
            "{ground:?}"
        );
    }
}

#[test]
fn it_is_carried_while_it_wants_nothing() {
    let (mut app, surface, walker) = on_sheet(());
    let start = place(&app, walker);
    for frame in 1..=120 {
        set_weights(&mut app, surface, &[0.5 * DT * frame as f32, DT * frame as f32]);
        run(&mut app, 1);
    }
    let moved = place(&app, walker) - start;
    assert!((moved - Vec3::new(2.0, 1.0, 0.0)).length() < 0.03, "{moved}");
}

#[test]
fn a_heaving_surface_keeps_its_character() {
    let (mut app, surface, walker) = on_sheet(());
    let mut worst: f32 = 0.0;
    for frame in 1..=240 {
        // Up to 1.9/s, and 12/s^2.
        let rise = 0.3 * (1.0 - (6.3 * DT * frame as f32).cos());
        set_weights(&mut app, surface, &[rise, 0.0]);
        assert!(walk_once(&mut app, walker, Vec3::ZERO), "in frame {frame}");
        worst = worst.max((place(&app, walker).y - STANDING - rise).abs());
    }
    assert!(worst < 12.0 * DT * DT + 2e-3, "{worst}");
}

#[test]
fn carrying_can_be_switched_off() {
    let carry = MorphCharacterCarry {
        enabled: false,
        ..Default::default()
    };
    let (mut app, surface, walker) = on_sheet(carry);
    let (grounded, moved, [least, _]) = ride(&mut app, surface, walker, Vec2::new(0.5, 1.0), 240);
    assert!(grounded >= 238 && moved.x.abs() < 1e-3, "{grounded}, {moved}");
    assert!((moved.y - 2.0).abs() < 0.02 && least > 0.0, "{moved}, {least}");
}

#[test]
fn what_it_merely_brushes_does_not_tow_it() {
    // A character on a floor. A sheet slides along its side, another one just below the floor.
    for kinematic in [false, true] {
        let mut app = app();
        let floor = (Collider::cuboid(10.0, 0.5, 10.0), Transform::from_xyz(0.0, -0.5, 0.0));
        app.world_mut().spawn(floor);
        let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        let wall = Transform::from_xyz(0.0, 0.0, -0.33).with_rotation(upright);
        let below = Transform::from_xyz(0.0, -0.02, 0.0);
        let sheets = [wall, below].map(|at| spawn(&mut app, &sliding(8.0), at));
        if kinematic {
            for sheet in sheets {
                app.world_mut()
                    .entity_mut(sheet)
                    .insert(RigidBody::KinematicPositionBased);
            }
        }
        settle(&mut app);
        let walker = character(&mut app, Vec3::new(0.0, STANDING, 0.0), ());
        walk(&mut app, walker, Vec3::ZERO, 10);
        let start = place(&app, walker);
        for frame in 1..=120 {
            for sheet in sheets {
                if kinematic {
                    app.world_mut().get_mut::<Transform>(sheet).unwrap().translation.x += DT;
                } else {
                    set_weights(&mut app, sheet, &[DT * frame as f32]);
                }
            }
            // It leans against the wall.
            assert!(walk_once(&mut app, walker, Vec3::new(0.0, 0.0, -0.002)));
            assert_eq!(ground(&app, walker), MorphCharacterGround::default());
        }
        let moved = place(&app, walker) - start;
        assert!(moved.length() < 0.03 && moved.x.abs() < 1e-2, "{kinematic}: {moved}");
    }
}

/// Rides a sheet for a second, jumps at 3/s, and lands. Returns how far it was carried in the air, and the number of
/// frames.
fn jump(carry: MorphCharacterCarry, speed: Vec2) -> (Vec3, usize) {
    let (mut app, surface, walker) = on_sheet(carry);
    ride(&mut app, surface, walker, speed, 60);
    let start = place(&app, walker);
    let (mut fall, mut frames) = (3.0, 0);
    let mut last = start;
    loop {
        let [rise, slide] = (speed * DT * (60 + frames + 1) as f32).to_array();
        set_weights(&mut app, surface, &[rise, slide]);
        move_by(&mut app, walker, Vec3::Y * fall * DT);
        run(&mut app, 1);
        fall -= 9.81 * DT;
        frames += 1;
        if frames > 5 && is_grounded(&app, walker) || frames > 100 {
            break;
        }
        last = place(&app, walker);
    }
    (last - start, frames)
}

#[test]
fn a_jump_takes_the_velocity_of_the_surface_along_if_asked() {
    let speed = Vec2::new(0.5, 1.0);
    let (stays, frames) = jump(MorphCharacterCarry::default(), speed);
    // It takes some frames until it is out of reach.
    assert!(stays.x < 3.5 * DT, "{stays} in {frames} frames");
    let keep = MorphCharacterCarry {
        keep_velocity: true,
        ..Default::default()
    };
    let (goes, frames) = jump(keep, speed);
    // The same jump as on a resting surface, seen from the surface.
    let (_, at_rest) = jump(keep, Vec2::ZERO);
    assert!(
        (frames as i32 - at_rest as i32).abs() <= 1,
        "{frames} frames, {at_rest} at rest"
    );
    let time = DT * (frames - 1) as f32;
    assert!((goes.x - time).abs() < 2.5 * DT, "{goes} in {time}");
    assert!(goes.x > 10.0 * stays.x, "{goes}, {stays}");
}

#[test]
fn kept_velocity_ends_at_a_wall_and_on_landing() {
    let keep = MorphCharacterCarry {
        keep_velocity: true,
        ..Default::default()
    };
    let (mut app, surface, walker) = on_sheet(keep);
    app.world_mut()
        .spawn((Collider::cuboid(0.1, 3.0, 3.0), Transform::from_xyz(1.6, 0.0, 0.0)));
    ride(&mut app, surface, walker, Vec2::new(0.0, 1.0), 45);
    for frame in 0..60 {
        set_weights(&mut app, surface, &[0.0, DT * (46 + frame) as f32]);
        move_by(&mut app, walker, Vec3::Y * 0.05);
        run(&mut app, 1);
    }
    let at = place(&app, walker);
    assert!(at.x < 1.5 - 0.3 && at.x > 1.5 - 0.3 - 0.05, "{at}");
    assert!(
        ground(&app, walker).velocity.x.abs() < 1e-3,
        "{:?}",
        ground(&app, walker)
    );
}

#[test]
fn walls_stop_what_carries_it() {
    let (mut app, surface, walker) = on_sheet(());
    let wall = (Collider::cuboid(0.1, 3.0, 3.0), Transform::from_xyz(1.6, 0.0, 0.0));
    app.world_mut().spawn(wall);
    let (grounded, _, _) = ride(&mut app, surface, walker, Vec2::new(0.0, 1.0), 180);
    let at = place(&app, walker);
    assert!((at.x - (1.5 - 0.3 - OFFSET)).abs() < 5e-3, "{at}");
    assert!(grounded >= 178 && (at.y - STANDING).abs() < 5e-3, "{grounded}, {at}");
}

#[test]
fn a_surface_on_a_kinematic_body_carries_it_once() {
    // The body moves, and the surface on it moves too.
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), RigidBody::KinematicPositionBased);
    settle(&mut app);
    let walker = character(&mut app, Vec3::new(0.1, STANDING, 0.05), ());
    walk(&mut app, walker, Vec3::ZERO, 10);
    let start = place(&app, walker);
    for frame in 1..=120 {
        let time = DT * frame as f32;
        app.world_mut().get_mut::<Transform>(surface).unwrap().translation = Vec3::new(0.0, 0.25 * time, 0.5 * time);
        set_weights(&mut app, surface, &[0.25 * time, 0.5 * time]);
        assert!(walk_once(&mut app, walker, Vec3::ZERO), "in frame {frame}");
    }
    let moved = place(&app, walker) - start;
    assert!((moved - Vec3::new(1.0, 1.0, 1.0)).length() < 0.035, "{moved}");
}

/// A mesh that rises along `X`.
fn tilted(mut mesh: MorphMesh, slope: f32) -> MorphMesh {
    for position in &mut mesh.positions {
        position.y += slope * position.x;
    }
    mesh
}

#[test]
fn it_stays_where_it_is_on_a_slope_that_rises() {
    let mut app = app();
    let surface = spawn(&mut app, &tilted(sheet(16), 0.4), ());
    settle(&mut app);
    let walker = character(&mut app, Vec3::new(0.0, STANDING + 0.1, 0.0), ());
    walk(&mut app, walker, Vec3::ZERO, 20);
    let start = place(&app, walker);
    for frame in 1..=120 {
        set_weights(&mut app, surface, &[0.5 * DT * frame as f32, 0.0]);
        assert!(walk_once(&mut app, walker, Vec3::ZERO), "in frame {frame}");
    }
    let moved = place(&app, walker) - start;
    assert!(moved.xz().length() < 0.02 && (moved.y - 1.0).abs() < 0.02, "{moved}");
}

#[test]
fn a_slope_that_it_cannot_stand_on_does_not_carry_it() {
    for (steepest, carried) in [(0.2, false), (0.5, true)] {
        let mut app = app();
        let surface = spawn(&mut app, &tilted(sheet(16), 0.4), ());
        settle(&mut app);
        let walker = character(&mut app, Vec3::new(0.0, STANDING + 0.1, 0.0), ());
        let mut controller = app.world_mut().get_mut::<KinematicCharacterController>(walker).unwrap();
        controller.max_slope_climb_angle = steepest;
        walk(&mut app, walker, Vec3::ZERO, 20);
        let start = place(&app, walker);
        for frame in 1..=60 {
            set_weights(&mut app, surface, &[0.0, DT * frame as f32]);
            assert!(walk_once(&mut app, walker, Vec3::ZERO), "in frame {frame}");
            assert_eq!(ground(&app, walker).surface.is_some(), carried);
        }
        let moved = place(&app, walker).x - start.x;
        assert!(
            (moved - if carried { 1.0 } else { 0.0 }).abs() < 0.03,
            "{steepest}: {moved}"
        );
    }
}

#[test]
fn a_surface_that_jumps_does_not_throw_it() {
    let (mut app, surface, walker) = on_sheet(());
    let start = place(&app, walker);
    set_weights(&mut app, surface, &[0.0, 3.0]);
    walk(&mut app, walker, Vec3::ZERO, 30);
    assert!((place(&app, walker) - start).length() < 5e-3, "{}", place(&app, walker));
}

#[test]
fn a_surface_on_a_dynamic_body_is_stood_on() {
    let mut app = app();
    let body = (
        RigidBody::Dynamic,
        GravityScale(0.0),
        Transform::from_xyz(0.0, 3.0, 0.0),
        Velocity::linear(Vec3::X),
    );
    let surface = spawn(&mut app, &sheet(16), body);
    settle(&mut app);
    let start = place(&app, surface);
    let controller = KinematicCharacterController {
        apply_impulse_to_dynamic_bodies: false,
        ..Default::default()
    };
    let walker = character(&mut app, start + Vec3::Y * STANDING, ());
    app.world_mut().entity_mut(walker).insert(controller);
    walk(&mut app, walker, Vec3::ZERO, 5);
    let start = place(&app, walker);
    for frame in 1..=60 {
        set_weights(&mut app, surface, &[0.0, DT * frame as f32]);
        assert!(walk_once(&mut app, walker, Vec3::ZERO), "in frame {frame}");
    }
    // Like on any dynamic body, it is not carried.
    assert!((place(&app, walker) - start).length() < 1e-2 && place(&app, surface).x > 0.9);
    let ground = ground(&app, walker);
    assert_eq!((ground.surface, ground.velocity), (Some(surface), Vec3::ZERO));
}
