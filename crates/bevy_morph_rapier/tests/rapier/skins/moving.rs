//! Bodies on a moving limb.

use bevy::prelude::*;
use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::PointQuery;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{DT, body};

use super::{Arm, TOP, app_with_arm, both};
use crate::support::{diagnostics, place, run, set_weights, velocity};

const HALF: f32 = 0.15;

/// An arm with a box that has come to rest at some place along it.
fn box_on_arm(x: f32) -> (App, Arm, Entity) {
    let (mut app, arm) = app_with_arm();
    let cuboid = Collider::cuboid(HALF, HALF, HALF);
    let cuboid = body(&mut app, cuboid, Vec3::new(x, TOP + HALF + 0.01, 0.0));
    run(&mut app, 60);
    assert!(gap(&app, &arm, cuboid).abs() < 1e-2 && velocity(&app, cuboid).length() < 1e-2);
    (app, arm, cuboid)
}

/// The true distance above the surface of a box that lies on one of its sides.
fn gap(app: &App, arm: &Arm, cuboid: Entity) -> f32 {
    arm.truth(app)
        .distance_to_point(&Pose::IDENTITY, place(app, cuboid), true)
        - HALF
}

#[test]
fn a_box_on_a_rising_arm_has_its_velocity() {
    let (mut app, arm, cuboid) = box_on_arm(1.5);
    for i in 1..=90 {
        arm.pose(&mut app, both(Transform::from_xyz(0.0, 0.5 * DT * i as f32, 0.0)));
        run(&mut app, 1);
        if i > 10 {
            let (gap, speed) = (gap(&app, &arm, cuboid), velocity(&app, cuboid).y);
            assert!(gap.abs() < 1e-2, "gap {gap} in step {i}");
            assert!((speed - 0.5).abs() < 0.025, "velocity {speed} in step {i}");
        }
    }
}

#[test]
fn a_box_on_an_arm_that_slides_is_carried() {
    let (mut app, arm, cuboid) = box_on_arm(-1.0);
    for i in 1..=90 {
        arm.pose(&mut app, both(Transform::from_xyz(DT * i as f32, 0.0, 0.0)));
        run(&mut app, 1);
    }
    let speed = velocity(&app, cuboid);
    assert!(speed.distance(Vec3::X) < 0.05, "velocity {speed}");
    let lag = -1.0 + 1.5 - place(&app, cuboid).x;
    assert!(lag.abs() < 0.15, "behind by {lag}");
}

#[test]
fn a_box_on_a_forearm_that_turns_moves_as_its_own_place_does() {
    let (mut app, arm, cuboid) = box_on_arm(2.0);
    const TURN: f32 = 0.3;
    for i in 1..=60 {
        let turned = Transform::from_rotation(Quat::from_rotation_z(TURN * DT * i as f32));
        arm.pose(&mut app, [Transform::IDENTITY, turned]);
        run(&mut app, 1);
        if i > 15 {
            let (gap, speed) = (gap(&app, &arm, cuboid), velocity(&app, cuboid));
            let expected = Vec3::Z.cross(place(&app, cuboid)) * TURN;
            assert!(gap.abs() < 1e-2, "gap {gap} in step {i}");
            assert!(speed.distance(expected) < 0.05, "{speed} in step {i}, not {expected}");
        }
    }
}

#[test]
fn a_punch_throws_a_ball_at_the_speed_of_the_fist() {
    let (mut app, arm) = app_with_arm();
    let ball = body(&mut app, Collider::ball(0.2), Vec3::new(2.5, 0.0, -1.5));
    app.world_mut().entity_mut(ball).insert(GravityScale(0.0));
    run(&mut app, 5);
    assert_eq!(velocity(&app, ball), Vec3::ZERO);
    // Sideways about the elbow: speeds up to 3 radians per second in a sixth of a second, then keeps that speed.
    let (mut angle, mut turn) = (0.0, 0.0_f32);
    let mut hit_at = None;
    for i in 0..60 {
        turn = (turn + 0.3).min(3.0);
        angle += turn * DT;
        let turned = Transform::from_rotation(Quat::from_rotation_y(angle));
        arm.pose(&mut app, [Transform::IDENTITY, turned]);
        run(&mut app, 1);
        if hit_at.is_none() && velocity(&app, ball).length() > 0.1 {
            hit_at = Some((i, place(&app, ball), velocity(&app, ball)));
        }
    }
    let (step, at, speed) = hit_at.expect("the fist meets the ball");
    assert!(step >= 10, "hit in step {step}");
    // The velocity of the arm's side there:
    let fist = Vec3::Y.cross(at) * 3.0;
    assert!(fist.length() > 7.0, "{fist}");
    // The ball moves in the direction that the arm's side faces, as fast as the arm moves in that direction.
    let along = fist.dot(speed.normalize());
    assert!(along > 0.9 * fist.length(), "thrown at {speed} by {fist}");
    assert!(
        (speed.length() - along).abs() < 0.1 * along,
        "thrown at {speed} by {fist}"
    );
    let after = velocity(&app, ball);
    assert!(after.length() > 0.9 * speed.length(), "{after} in the end");
}

#[test]
fn a_fist_throws_a_ball_that_it_would_pass_in_one_step() {
    let (mut app, arm) = app_with_arm();
    let at = Quat::from_rotation_y(2.55) * (Vec3::X * 2.5);
    let ball = body(&mut app, Collider::ball(0.1), at);
    app.world_mut().entity_mut(ball).insert(GravityScale(0.0));
    run(&mut app, 5);
    // Speeds up to 12 radians per second in a third of a second. The ball's place then moves by 0.5 per step, five
    // times its radius.
    let (mut angle, mut turn) = (0.0, 0.0_f32);
    let mut thrown = None;
    for _ in 0..30 {
        turn = (turn + 0.6).min(12.0);
        angle += turn * DT;
        let turned = Transform::from_rotation(Quat::from_rotation_y(angle));
        arm.pose(&mut app, [Transform::IDENTITY, turned]);
        run(&mut app, 1);
        if thrown.is_none() && velocity(&app, ball).length() > 1.0 {
            thrown = Some(velocity(&app, ball));
        }
        // As the arm turns on, the ball slides along its front until it leaves at its end.
        let in_arm = Quat::from_rotation_y(-angle) * place(&app, ball);
        assert!(in_arm.x > 3.0 || in_arm.z < -0.4, "it passes the arm at {in_arm}");
    }
    let (thrown, fist) = (thrown.expect("the fist meets it"), Vec3::Y.cross(at) * 12.0);
    let along = thrown.dot(fist.normalize());
    assert!(along > 0.7 * fist.length(), "thrown at {thrown} by {fist}");
}

/// The places and velocities of a ball that a forearm throws, and whether the arm was awake. If a `guard` hovers in an empty edge of the upper
/// arm's box, the arm cannot sleep. For some frames, time may stand still while the arm turns on.
fn punched(guard: bool, paused: std::ops::Range<i32>) -> (Vec<[Vec3; 2]>, Vec<u32>) {
    let (mut app, arm) = app_with_arm();
    let ball = body(&mut app, Collider::ball(0.2), Vec3::new(1.5, 0.0, -2.6));
    app.world_mut().entity_mut(ball).insert(GravityScale(0.0));
    if guard {
        let hovering = body(&mut app, Collider::ball(0.01), Vec3::new(-2.9, 0.485, 0.485));
        app.world_mut().entity_mut(hovering).insert(GravityScale(0.0));
    }
    let (mut states, mut awake) = (Vec::new(), Vec::new());
    for i in 0..60 {
        if i == paused.start {
            app.world_mut().resource_mut::<Time<Virtual>>().pause();
        } else if i == paused.end {
            app.world_mut().resource_mut::<Time<Virtual>>().unpause();
        }
        let turned = Transform::from_rotation(Quat::from_rotation_y(0.0008 * (i * i) as f32));
        set_weights(&mut app, arm.surface, &[0.1 * (0.3 * i as f32).sin()]);
        arm.pose(&mut app, [Transform::IDENTITY, turned]);
        run(&mut app, 1);
        states.push([place(&app, ball), velocity(&app, ball)]);
        awake.push(diagnostics(&app).awake);
    }
    (states, awake)
}

#[test]
fn an_arm_wakes_as_if_it_had_never_slept() {
    for paused in [100..100, 20..25, 33..36] {
        let (slept, awake) = punched(false, paused.clone());
        let (guarded, always) = punched(true, paused.clone());
        assert!(slept.iter().any(|[_, velocity]| velocity.length() > 1.0), "{slept:?}");
        assert!(awake[..10] == [0; 10] && awake.contains(&1), "{awake:?}");
        let steps = (0..60).zip(&always).filter(|(i, _)| *i > 3 && !paused.contains(i));
        assert!(steps.map(|(_, awake)| *awake).all(|awake| awake == 1), "{always:?}");
        for (frame, (slept, guarded)) in slept.iter().zip(&guarded).enumerate() {
            assert_eq!(slept, guarded, "in frame {frame}, paused in {paused:?}");
        }
    }
}

#[test]
fn an_arm_that_stops_between_frames_is_at_rest() {
    let (mut app, arm) = app_with_arm();
    app.insert_resource(TimestepMode::Interpolated {
        dt: DT,
        time_scale: 1.0,
        substeps: 1,
    });
    let mut moving = Vec::new();
    for i in 0..20 {
        let turned = Transform::from_rotation(Quat::from_rotation_y(0.02 * i.min(10) as f32));
        arm.pose(&mut app, [Transform::IDENTITY, turned]);
        run(&mut app, 1);
        moving.push(diagnostics(&app).moving);
    }
    assert_eq!((moving[8], &moving[15..]), (1, &[0; 5][..]), "{moving:?}");
}

#[test]
fn an_arm_that_swells_throws_what_lies_on_it() {
    let (mut app, arm, cuboid) = box_on_arm(1.5);
    // Its top rises by 0.46 within a tenth of a second, while its joints stay.
    for i in 1..=6 {
        set_weights(&mut app, arm.surface, &[i as f32 / 6.0]);
        run(&mut app, 1);
    }
    let speed = velocity(&app, cuboid).y;
    assert!((3.7..5.5).contains(&speed), "thrown at {speed}");
}

#[test]
fn joints_that_jump_do_not_throw() {
    let (mut app, arm, cuboid) = box_on_arm(1.5);
    arm.pose(&mut app, both(Transform::from_xyz(0.0, 0.2, 0.0)));
    let mut highest: f32 = 0.0;
    for _ in 0..90 {
        run(&mut app, 1);
        highest = highest.max(place(&app, cuboid).y);
    }
    assert!(highest < TOP + HALF + 0.25, "thrown to {highest}");
    let gap = gap(&app, &arm, cuboid);
    assert!(gap.abs() < 1e-2, "gap {gap}");
}
