//! Bodies on a surface that moves.

use std::time::Duration;

use avian3d::prelude::*;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::prelude::*;
use morph_collision_workspace::physics::{settle, sheet};

use crate::log::start;
use crate::support::{
    DT, app, body, is_asleep, on_the_sheet, place, population, run, set_weights, spawn, unfinished, velocity,
};

/// The state of a body after each step: height above the surface, and upward velocity.
#[derive(Resource, Default)]
struct Steps(Vec<(f32, f32)>);

/// The smallest and the largest number.
fn range(numbers: impl Iterator<Item = f32>) -> (f32, f32) {
    numbers.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    })
}

#[test]
fn a_ball_on_a_rising_surface_has_its_velocity_in_every_step() {
    // Steps of 1/64 s: one per frame, three per two frames, and one per three frames.
    for frame in [1.0 / 64.0, 1.0 / 43.0, 1.0 / 192.0] {
        let mut app = unfinished();
        app.insert_resource(Time::<Fixed>::from_hz(64.0))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(frame)))
            .init_resource::<Steps>();
        let frames = |seconds: f64| (seconds / frame).ceil() as usize;
        start(&mut app);
        let surface = spawn(&mut app, &sheet(32), ());
        settle(&mut app);
        let ball = body(&mut app, Collider::sphere(0.5), Vec3::new(0.1, 0.52, 0.05));
        run(&mut app, frames(1.0));
        let rise = move |mut weights: Query<&mut MeshMorphWeights>, time: Res<Time>, mut height: Local<f32>| {
            *height += 0.5 * time.delta_secs();
            let weights_now = vec![*height, 0.0];
            *weights.get_mut(surface).unwrap() = MeshMorphWeights::Value { weights: weights_now };
        };
        let measure = move |bodies: Query<(&Position, &LinearVelocity)>,
                            weights: Query<&MeshMorphWeights>,
                            mut steps: ResMut<Steps>| {
            let Ok(MeshMorphWeights::Value { weights }) = weights.get(surface) else {
                panic!("weights are values");
            };
            let (place, velocity) = bodies.get(ball).unwrap();
            steps.0.push((place.y - 0.5 - weights[0], velocity.y));
        };
        app.add_systems(FixedUpdate, rise).add_systems(FixedLast, measure);
        run(&mut app, frames(3.0));
        let steps = &app.world().resource::<Steps>().0;
        assert!(steps.len() > 150, "{} steps", steps.len());
        let (slowest, fastest) = range(steps[30..].iter().map(|step| step.1));
        let (lowest, highest) = range(steps[30..].iter().map(|step| step.0));
        println!("frames of {frame:.4} s: velocity {slowest:.4} to {fastest:.4}, gap {lowest:.4} to {highest:.4}");
        assert!(slowest > 0.49 && fastest < 0.51, "velocity {slowest} to {fastest}");
        assert!(lowest > -1e-2 && highest < 1e-2, "gap {lowest} to {highest}");
    }
}

#[test]
fn a_change_that_comes_too_fast_to_be_a_motion_is_the_surfaces_own_to_define() {
    // The same jump, treated as a motion.
    let (mut app, sheet, ball) = on_the_sheet(Collider::sphere(0.5));
    let trusting = MorphPhysicsCollider {
        max_acceleration: f32::INFINITY,
        ..default()
    };
    app.world_mut().entity_mut(sheet).insert(trusting);
    set_weights(&mut app, sheet, &[0.2, 0.0]);
    run(&mut app, 2);
    assert!(velocity(&app, ball).y > 5.0, "{}", velocity(&app, ball));
}

#[test]
fn a_body_that_is_carried_slowly_is_not_put_to_sleep() {
    // Slower than Avian's sleep threshold.
    let (mut app, sheet, ball) = on_the_sheet(Collider::sphere(0.5));
    for i in 1..=240 {
        set_weights(&mut app, sheet, &[0.05 * DT * i as f32, 0.0]);
        run(&mut app, 1);
        assert!(i < 5 || !is_asleep(&app, ball), "asleep in step {i}");
        let (gap, speed) = (place(&app, ball).y - 0.5 - 0.05 * DT * i as f32, velocity(&app, ball).y);
        assert!(gap.abs() < 5e-3, "gap {gap} in step {i}");
        assert!(i < 30 || (speed - 0.05).abs() < 0.002, "velocity {speed} in step {i}");
    }
}

#[test]
fn contacts_are_not_those_of_the_shape_before() {
    // A dent as wide as the ball forms under it. The places of the ball and of the surface under it stay almost the same in each
    // step.
    let mut mesh = sheet(32);
    let dent = |p: &Vec3| Vec3::Y * -(1.0 - p.length() / 2.0).max(0.0);
    mesh.targets = vec![mesh.positions.iter().map(dent).collect()];
    for speed in [0.02, 0.2] {
        let mut app = app();
        let surface = spawn(&mut app, &mesh, ());
        settle(&mut app);
        let ball = body(&mut app, Collider::sphere(0.3), Vec3::new(0.0, 0.31, 0.0));
        app.world_mut()
            .entity_mut(ball)
            .insert((SleepingDisabled, AngularDamping(10.0)));
        run(&mut app, 30);
        for i in 1..=60 {
            let depth = speed * DT * i as f32;
            set_weights(&mut app, surface, &[depth]);
            run(&mut app, 1);
            if i > 10 {
                // The sides of the dent have a slope of depth / 2.
                let gap = place(&app, ball).y - 0.3 * (1.0 + depth * depth / 4.0).sqrt() + depth;
                assert!(gap.abs() < 5e-3, "gap {gap} at {depth}");
            }
        }
    }
}

#[test]
fn a_surface_on_a_kinematic_body_carries_at_the_velocity_of_the_body() {
    let mut app = app();
    let root = (
        RigidBody::Kinematic,
        Transform::from_xyz(0.5, 0.0, 0.0),
        Visibility::default(),
    );
    let root = app.world_mut().spawn(root).id();
    let on_it = (
        Transform::from_xyz(-0.5, 0.2, 0.0).with_scale(Vec3::new(1.0, 2.0, 1.0)),
        ChildOf(root),
    );
    let surface = spawn(&mut app, &sheet(32), on_it);
    settle(&mut app);
    let cuboid = body(&mut app, Collider::cuboid(1.0, 1.0, 1.0), Vec3::new(0.1, 0.71, 0.05));
    run(&mut app, 30);
    assert!((place(&app, cuboid).y - 0.7).abs() < 1e-2, "{}", place(&app, cuboid));
    app.world_mut()
        .entity_mut(root)
        .insert(LinearVelocity(Vec3::new(1.0, 1.0, 0.0)));
    for i in 1..=60 {
        // The scale doubles it.
        set_weights(&mut app, surface, &[0.1 * DT * i as f32, 0.0]);
        run(&mut app, 1);
    }
    let speed = velocity(&app, cuboid);
    assert!(speed.distance(Vec3::new(1.0, 1.2, 0.0)) < 0.03, "{speed}");
    // Avian wakes the body in the first of these steps and moves it from the second on.
    let surface = place(&app, root).y + 0.2 + 0.2;
    assert!(
        surface > 1.3 && (place(&app, cuboid).y - 0.5 - surface).abs() < 5e-3,
        "{}",
        place(&app, cuboid)
    );
}

#[test]
fn a_fast_body_does_not_pass_through_a_surface_that_moves() {
    for thrown in [-20.0, -60.0] {
        let mut app = app();
        let surface = spawn(&mut app, &sheet(16), ());
        settle(&mut app);
        let ball = body(&mut app, Collider::sphere(0.1), Vec3::new(0.1, 3.0, 0.05));
        app.world_mut()
            .entity_mut(ball)
            .insert(LinearVelocity(Vec3::Y * thrown));
        for i in 1..=60 {
            set_weights(&mut app, surface, &[0.5 * DT * i as f32, 0.0]);
            run(&mut app, 1);
        }
        assert!(place(&app, ball).y > 0.4, "{thrown}: {}", place(&app, ball));
        let (_, parts) = population(&mut app);
        assert!(parts <= 8, "{parts}");
    }
}

#[test]
fn a_surface_throws_a_ball_that_it_would_pass_in_one_step() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::sphere(0.05), Vec3::new(0.1, 2.5, 0.05));
    app.world_mut()
        .entity_mut(ball)
        .insert((GravityScale(0.0), SleepingDisabled));
    // Speeds up to 12 per second in a third of a second. Then it moves by 0.2 per step, twice the ball's diameter.
    let (mut height, mut speed) = (0.0, 0.0_f32);
    for _ in 0..40 {
        speed = (speed + 0.6).min(12.0);
        height += speed * DT;
        set_weights(&mut app, surface, &[height, 0.0]);
        run(&mut app, 1);
    }
    assert!(place(&app, ball).y > height, "{} below {height}", place(&app, ball));
    let thrown = velocity(&app, ball).y;
    assert!((11.0..13.0).contains(&thrown), "thrown at {thrown}");
}
