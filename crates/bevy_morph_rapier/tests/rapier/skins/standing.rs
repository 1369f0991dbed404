//! A limb's place in Rapier, its cost, and limbs on bodies.

use bevy::prelude::*;
use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::{PointQuery, Ray, RayCast};
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{DT, body, settle};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{Arm, TOP, app_with_arm, both};
use crate::support::{
    app, ask, below, collect_errors, diagnostics, global, place, population, run, set_weights, velocity,
};

#[test]
fn rays_and_closest_points_are_those_of_the_skinned_and_morphed_mesh() {
    let mut app = app();
    // The place of its own entity does not matter.
    let own = Transform::from_xyz(3.0, -2.0, 1.0).with_rotation(Quat::from_rotation_x(0.7));
    let arm = Arm::spawn(&mut app, own.with_scale(Vec3::new(2.0, 1.0, 0.5)));
    settle(&mut app);
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut hits = 0;
    for round in 0..6 {
        let mut number = |most: f32| rng.random_range(-most..most);
        let places = [(); 2].map(|()| {
            let turn = Quat::from_euler(EulerRot::XYZ, number(0.8), number(0.8), number(0.8));
            Transform::from_xyz(number(0.3), number(0.3), number(0.3)).with_rotation(turn)
        });
        arm.pose(&mut app, places);
        set_weights(&mut app, arm.surface, &[number(0.5)]);
        if round > 2 {
            let elsewhere = Transform::from_xyz(number(50.0), number(50.0), 0.0);
            app.world_mut().entity_mut(arm.surface).insert(elsewhere);
        }
        run(&mut app, 2);
        let truth = arm.truth(&app);
        for _ in 0..30 {
            let mut point = || Vec3::from_array([(); 3].map(|()| rng.random_range(-3.0..3.0)));
            let (from, to) = (point() * 2.0, point() * 0.5);
            let Some(direction) = (to - from).try_normalize() else {
                continue;
            };
            let (hit, closest) = ask(&mut app, move |context| {
                let filter = QueryFilter::default();
                let hit = context.cast_ray(from, direction, 100.0, true, filter);
                (hit, context.project_point(from, 100.0, false, filter))
            });
            let expected = truth.cast_ray(&Pose::IDENTITY, &Ray::new(from, direction), 100.0, false);
            assert_eq!(hit.is_some(), expected.is_some(), "round {round}");
            if let Some((hit, expected)) = hit.zip(expected) {
                hits += 1;
                assert_eq!(hit.0, arm.surface);
                assert!((hit.1 - expected).abs() < 1e-4, "{hit:?}, not {expected}");
            }
            let distance = truth.distance_to_point(&Pose::IDENTITY, from, false).abs();
            let (_, closest) = closest.expect("it is there");
            let found = closest.point.distance(from);
            assert!((found - distance).abs() < 1e-4, "{found}, not {distance}");
        }
    }
    assert!(hits > 40, "{hits}");
}

#[test]
fn only_what_is_near_a_body_costs() {
    let mut app = app();
    let arms: Vec<Arm> = (0..10).map(|_| Arm::spawn(&mut app, ())).collect();
    let spread = |app: &mut App, arms: &[Arm], height: f32| {
        for (arm, i) in arms.iter().zip(0..) {
            let turned = Transform::from_xyz(0.0, height, 8.0 * i as f32);
            let bent = turned.with_rotation(Quat::from_rotation_y(height));
            arm.pose(app, [turned, bent]);
        }
    };
    spread(&mut app, &arms, 0.0);
    settle(&mut app);
    run(&mut app, 3);
    // All of them move, and nothing is near.
    spread(&mut app, &arms, 0.01);
    run(&mut app, 1);
    let idle = diagnostics(&app);
    assert_eq!((idle.surfaces, idle.moving, idle.parts, idle.blended), (10, 10, 0, 0));
    assert_eq!(population(&mut app), (10, 0));
    // One body is near one of them.
    let ball = body(&mut app, Collider::ball(0.1), Vec3::new(2.0, TOP + 0.12, 24.0));
    app.world_mut().entity_mut(ball).insert(GravityScale(0.0));
    for i in 2..10 {
        spread(&mut app, &arms, 0.01 * i as f32);
        run(&mut app, 1);
        let near = diagnostics(&app);
        assert_eq!(near.moving, 10);
        assert!((1..=8).contains(&near.parts) && near.blended == near.parts, "{near:?}");
        // The colliders of surfaces, ball and parts.
        let parts = near.parts as usize;
        assert_eq!(population(&mut app), (11 + parts, parts));
    }
    // It leaves.
    app.world_mut()
        .entity_mut(ball)
        .insert(Transform::from_xyz(0.0, 50.0, 0.0));
    run(&mut app, 2);
    spread(&mut app, &arms, 0.2);
    run(&mut app, 1);
    assert_eq!(diagnostics(&app).parts, 0);
}

#[test]
fn a_body_asleep_on_a_still_arm_costs_nothing_and_wakes_with_the_joints() {
    let (mut app, arm) = app_with_arm();
    let cuboid = body(
        &mut app,
        Collider::cuboid(0.15, 0.15, 0.15),
        Vec3::new(1.5, TOP + 0.16, 0.0),
    );
    app.world_mut().entity_mut(cuboid).insert(Sleeping::default());
    run(&mut app, 300);
    let asleep = |app: &App| app.world().get::<Sleeping>(cuboid).unwrap().sleeping;
    assert!(asleep(&app));
    let still = diagnostics(&app);
    assert_eq!((still.surfaces, still.moving, still.blended), (1, 0, 0));
    for i in 1..=30 {
        arm.pose(&mut app, both(Transform::from_xyz(0.0, -0.5 * DT * i as f32, 0.0)));
        run(&mut app, 1);
        assert!(!asleep(&app), "asleep in step {i}");
    }
    run(&mut app, 10);
    let height = place(&app, cuboid).y;
    assert!((height - (TOP + 0.15 - 0.25)).abs() < 1e-2, "{height}");
}

/// An arm whose mesh and joints are below a body.
fn arm_on(app: &mut App, kind: RigidBody) -> (Arm, Entity) {
    let root = (kind, Velocity::default(), Transform::default(), Sleeping::default());
    let root = app.world_mut().spawn(root).id();
    let arm = Arm::spawn(app, (Transform::from_xyz(0.5, 0.0, 0.0), ChildOf(root)));
    for joint in arm.joints {
        app.world_mut().entity_mut(joint).insert(ChildOf(root));
    }
    settle(app);
    (arm, root)
}

#[test]
fn an_arm_on_a_kinematic_body_carries_at_the_velocity_of_the_body() {
    for kind in [RigidBody::KinematicVelocityBased, RigidBody::KinematicPositionBased] {
        let mut app = app();
        let (arm, root) = arm_on(&mut app, kind);
        let cuboid = body(
            &mut app,
            Collider::cuboid(0.15, 0.15, 0.15),
            Vec3::new(1.5, TOP + 0.16, 0.0),
        );
        run(&mut app, 60);
        for i in 1..=60 {
            let mut root = app.world_mut().entity_mut(root);
            if kind == RigidBody::KinematicVelocityBased {
                root.insert(Velocity::linear(Vec3::Y * 0.5));
            } else {
                root.insert(Transform::from_xyz(0.0, 0.5 * DT * i as f32, 0.0));
            }
            run(&mut app, 1);
        }
        let gap = arm
            .truth(&app)
            .distance_to_point(&Pose::IDENTITY, place(&app, cuboid), true)
            - 0.15;
        let speed = velocity(&app, cuboid).y;
        // The body moves by 0.008 per step.
        assert!(gap.abs() < 4e-3, "{kind:?}: gap {gap}");
        assert!((speed - 0.5).abs() < 0.025, "{kind:?}: velocity {speed}");
        assert!((place(&app, root).y - 0.5).abs() < 0.02);
    }
}

#[test]
fn an_arm_on_a_dynamic_body_falls_rests_and_sleeps() {
    let mut app = app();
    app.world_mut().spawn((
        RigidBody::Fixed,
        Collider::cuboid(10.0, 0.5, 10.0),
        Transform::from_xyz(0.0, -2.0, 0.0),
    ));
    let (arm, root) = arm_on(&mut app, RigidBody::Dynamic);
    // Bent within the plane in which it lies.
    let bent = Transform::from_rotation(Quat::from_rotation_y(0.8));
    arm.pose(&mut app, [Transform::IDENTITY, bent]);
    run(&mut app, 600);
    let lowest = arm
        .truth(&app)
        .vertices()
        .iter()
        .map(|v| v.y)
        .fold(f32::INFINITY, f32::min);
    assert!((lowest + 1.5).abs() < 2e-2, "its lowest point is at {lowest}");
    assert!(app.world().get::<Sleeping>(root).unwrap().sleeping);
    assert_eq!(
        diagnostics(&app).moving,
        0,
        "what a rotation leaves behind is no motion"
    );
}

#[test]
fn an_arm_on_a_dynamic_body_throws_and_is_thrown_back() {
    let mut app = app();
    let (arm, root) = arm_on(&mut app, RigidBody::Dynamic);
    let weight = MassProperties {
        mass: 5.0,
        principal_inertia: Vec3::new(1.0, 15.0, 15.0),
        ..default()
    };
    app.world_mut().entity_mut(root).insert((
        // It fell a little before it was ready.
        (GravityScale(0.0), Transform::default(), Velocity::default()),
        AdditionalMassProperties::MassProperties(weight),
        Sleeping::disabled(),
    ));
    app.world_mut()
        .entity_mut(arm.surface)
        .insert(ColliderMassProperties::Density(0.0));
    let ball = body(&mut app, Collider::ball(0.3), Vec3::new(1.5, TOP + 0.35, 0.0));
    app.world_mut().entity_mut(ball).insert((
        GravityScale(0.0),
        ColliderMassProperties::Mass(1.0),
        Sleeping::disabled(),
    ));
    run(&mut app, 3);
    for frame in 1..=12 {
        let raised = Transform::from_rotation(Quat::from_rotation_z(2.0 * DT * frame as f32));
        arm.pose(&mut app, [Transform::IDENTITY, raised]);
        run(&mut app, 1);
    }
    run(&mut app, 20);
    let (thrown, back) = (velocity(&app, ball), velocity(&app, root));
    assert!(thrown.y > 1.5 && thrown.y < 3.5, "{thrown}");
    assert!((thrown + 5.0 * back).length() < 0.02, "{thrown} {back}");
}

#[test]
fn joints_that_cannot_be_used_keep_the_last_good_ones_or_leave_it_out() {
    collect_errors(|errors| {
        let mut app = app();
        let arm = Arm::spawn(&mut app, Name::new("arm"));
        let nowhere = Transform::from_translation(Vec3::NAN);
        arm.pose(&mut app, [Transform::IDENTITY, nowhere]);
        settle(&mut app);
        run(&mut app, 3);
        assert_eq!(diagnostics(&app).surfaces, 0);
        assert_eq!(below(&mut app, 1.5, 0.0), None);
        let logged = errors.take();
        assert_eq!(logged.len(), 1, "{logged:?}");
        assert!(logged[0].contains("`arm`"), "{logged:?}");

        arm.pose(&mut app, both(Transform::from_xyz(0.0, 1.0, 0.0)));
        run(&mut app, 2);
        let (hit, height) = below(&mut app, 1.5, 0.0).expect("its joints are good");
        assert!(hit == arm.surface && (height - 1.0 - TOP).abs() < 1e-4, "{height}");
        assert_eq!(diagnostics(&app).surfaces, 1);

        arm.pose(&mut app, [nowhere, Transform::IDENTITY]);
        run(&mut app, 2);
        let (_, height) = below(&mut app, 1.5, 0.0).expect("it stays");
        assert!((height - 1.0 - TOP).abs() < 1e-4, "{height}");
        assert_eq!(errors.take().len(), 1);

        // Without its skeleton it is rigid, at the place of its own entity.
        app.world_mut()
            .entity_mut(arm.surface)
            .remove::<bevy::mesh::skinning::SkinnedMesh>()
            .insert(Transform::from_xyz(0.0, 0.5, 0.0));
        settle(&mut app);
        run(&mut app, 2);
        let (_, height) = below(&mut app, 1.5, 0.0).expect("it is rigid now");
        assert!((height - 0.5 - TOP).abs() < 1e-4, "{height}");
        assert!(global(&app, arm.surface).translation().y == 0.5);
        assert_eq!(errors.take(), [""; 0]);
    });
}
