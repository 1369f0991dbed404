//! Bodies other than a plain slab.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{DT, bevy_mesh, body, settle};

use super::{HALF, floating, grounded, mass_of, spawn_on, thing};
use crate::support::{app, diagnostics, place, population, run, set_weights, slab, slab_cut, spawn, velocity};

/// Raises the upper side by `speed` for some frames.
fn rise(app: &mut App, surface: Entity, frames: usize, speed: f32) {
    for frame in 1..=frames {
        set_weights(app, surface, &[0.0, speed * DT * frame as f32, 0.0, 0.0]);
        run(app, 1);
    }
}

fn spin(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<Velocity>(entity).unwrap().angular
}

fn is_asleep(app: &App, entity: Entity) -> bool {
    app.world().get::<Sleeping>(entity).unwrap().sleeping
}

#[test]
fn a_morphing_body_alone_moves_as_a_plain_one() {
    for substeps in [1, 3] {
        let mut app = app();
        app.insert_resource(TimestepMode::Fixed { dt: DT, substeps });
        // The centre of mass is off the middle. Another body, far away, shows the motion without morphing.
        let weight = |mass| MassProperties {
            local_center_of_mass: Vec3::new(0.3, 0.1, -0.2),
            ..mass_of(mass, HALF)
        };
        let motion = Velocity {
            linear: Vec3::new(1.0, 0.5, 0.0),
            angular: Vec3::new(0.3, 2.0, 0.1),
        };
        let damping = Damping {
            linear_damping: 0.5,
            angular_damping: 0.3,
        };
        let bodies = [0.0, 50.0].map(|x| {
            let more = (GravityScale(0.1), damping);
            let body = spawn_on(&mut app, &slab(HALF), 3.0, Vec3::X * x, more);
            app.world_mut()
                .entity_mut(body)
                .insert(AdditionalMassProperties::MassProperties(weight(3.0)));
            // A contact with something of negligible weight.
            let tiny = Collider::ball(0.05);
            thing(
                &mut app,
                tiny,
                1e-6,
                Vec3::new(x, HALF.y + 0.06, 0.0),
                GravityScale(0.0),
            );
            body
        });
        run(&mut app, 3);
        for (body, x) in bodies.into_iter().zip([0.0, 50.0]) {
            app.world_mut()
                .entity_mut(body)
                .insert((motion, Transform::from_xyz(x, 0.0, 0.0)));
        }
        let mut parts = 0;
        for frame in 1..=60 {
            // The outline stays the same, and nothing else changes.
            set_weights(&mut app, bodies[0], &[0.0, 0.0, 1e-3 * frame as f32, 0.0]);
            run(&mut app, 1);
            parts += diagnostics(&app).parts;
        }
        assert!(parts > 0, "there was nothing to push");
        let [a, b] = bodies.map(|body| place(&app, body));
        let [v, w] = bodies.map(|body| (velocity(&app, body), spin(&app, body)));
        println!("{substeps}: {a} {b} {v:?} {w:?} {parts}");
        assert!(a.distance(b - 50.0 * Vec3::X) < 0.02, "{substeps}: {a} {b}");
        assert!(
            v.0.distance(w.0) < 0.02 && v.1.distance(w.1) < 0.03,
            "{substeps}: {v:?} {w:?}"
        );
    }
}

#[test]
fn locked_axes_stay_locked() {
    let (mut app, surface) = floating(3.0);
    app.world_mut()
        .entity_mut(surface)
        .insert(LockedAxes::TRANSLATION_LOCKED | LockedAxes::ROTATION_LOCKED);
    let ball = thing(
        &mut app,
        Collider::ball(0.3),
        1.0,
        Vec3::new(0.7, HALF.y + 0.4, 0.0),
        GravityScale(0.0),
    );
    rise(&mut app, surface, 12, 5.0);
    println!("{} {}", velocity(&app, ball), velocity(&app, surface));
    assert!((velocity(&app, ball).y - 5.0).abs() < 0.1, "{}", velocity(&app, ball));
    assert!(velocity(&app, surface).length() + spin(&app, surface).length() < 1e-4);
    assert!(place(&app, surface).length() < 1e-4);
}

#[test]
fn after_it_came_to_rest_it_sleeps_and_wakes() {
    let (mut app, surface) = grounded(3.0);
    let cuboid = thing(
        &mut app,
        Collider::cuboid(0.3, 0.3, 0.3),
        1.0,
        Vec3::new(0.0, 0.8, 0.1),
        (),
    );
    for body in [surface, cuboid] {
        app.world_mut().entity_mut(body).insert(Sleeping::default());
    }
    run(&mut app, 1);
    let (_, parts) = population(&mut app);
    rise(&mut app, surface, 60, 0.3);
    assert!(population(&mut app).1 > parts);
    run(&mut app, 180);
    assert!(is_asleep(&app, surface) && is_asleep(&app, cuboid));
    assert_eq!(population(&mut app).1, parts, "parts are left behind");
    assert!((place(&app, cuboid).y - 1.1).abs() < 1e-2, "{}", place(&app, cuboid));
    set_weights(&mut app, surface, &[0.0, 0.31, 0.0, 0.0]);
    run(&mut app, 3);
    assert!(!is_asleep(&app, surface) && !is_asleep(&app, cuboid));
}

#[test]
fn a_scaled_one_throws() {
    let mut app = app();
    let surface = spawn_on(&mut app, &slab(HALF), 3.0, Vec3::ZERO, GravityScale(0.0));
    let scaled = Transform::from_scale(Vec3::new(2.0, 2.0, 0.5)).with_rotation(Quat::from_rotation_x(0.5));
    app.world_mut().entity_mut(surface).insert(scaled);
    let up = scaled.rotation * Vec3::Y;
    let ball = thing(
        &mut app,
        Collider::ball(0.3),
        1.0,
        up * (2.0 * HALF.y + 0.35),
        GravityScale(0.0),
    );
    run(&mut app, 3);
    rise(&mut app, surface, 12, 2.5);
    run(&mut app, 30);
    let (ball, slab) = (velocity(&app, ball), velocity(&app, surface));
    println!("{ball} {slab}");
    assert!(
        (ball.dot(up) - 3.75).abs() < 0.19 && (ball + 3.0 * slab).length() < 1e-2,
        "{ball} {slab}"
    );
}

#[test]
fn a_body_in_joints_pushes() {
    for multibody in [false, true] {
        let (mut app, surface) = grounded(3.0);
        let post = app
            .world_mut()
            .spawn((RigidBody::Fixed, Transform::from_xyz(0.0, 0.25, 0.0)))
            .id();
        let slider = PrismaticJointBuilder::new(Vec3::Y);
        let mut entity = app.world_mut().entity_mut(surface);
        if multibody {
            entity.insert(MultibodyJoint::new(post, slider.build()));
        } else {
            entity.insert(ImpulseJoint::new(post, slider.build()));
        }
        let ball = thing(&mut app, Collider::ball(0.3), 1.0, Vec3::new(0.0, 0.8, 0.05), ());
        run(&mut app, 20);
        rise(&mut app, surface, 60, 0.5);
        println!("{multibody} {} {}", place(&app, ball), velocity(&app, ball));
        assert!(
            (place(&app, ball).y - 1.3).abs() < 0.1,
            "{multibody}: {}",
            place(&app, ball)
        );
        if !multibody {
            assert!((velocity(&app, ball).y - 0.5).abs() < 0.05, "{}", velocity(&app, ball));
        }
        assert!((place(&app, surface).y - 0.25).abs() < 0.02, "{}", place(&app, surface));
    }
}

#[test]
fn what_a_joint_spares_is_not_pushed() {
    let (mut app, surface) = floating(3.0);
    let at = Vec3::new(0.0, HALF.y + 0.32, 0.0);
    let ball = thing(&mut app, Collider::ball(0.3), 1.0, at, GravityScale(0.0));
    let near = at + Vec3::X * 0.5;
    let pushed = thing(
        &mut app,
        Collider::ball(0.1),
        1.0,
        near - Vec3::Y * 0.2,
        GravityScale(0.0),
    );
    let mut joint = GenericJoint::new(JointAxesMask::empty());
    joint.set_contacts_enabled(false);
    app.world_mut()
        .entity_mut(ball)
        .insert(ImpulseJoint::new(surface, joint));
    run(&mut app, 3);
    rise(&mut app, surface, 20, 1.0);
    assert!(velocity(&app, ball).length() < 1e-3, "{}", velocity(&app, ball));
    assert!(velocity(&app, pushed).y > 0.5, "{}", velocity(&app, pushed));
}

#[test]
fn it_may_go_while_it_morphs() {
    type Change = fn(&mut App, Entity);
    let changes: [Change; 7] = [
        |app, entity| _ = app.world_mut().despawn(entity),
        |app, entity| _ = app.world_mut().entity_mut(entity).remove::<MorphPhysicsCollider>(),
        |app, entity| _ = app.world_mut().entity_mut(entity).insert(MorphColliderDisabled),
        |app, entity| _ = app.world_mut().entity_mut(entity).insert(RigidBodyDisabled),
        |app, entity| {
            _ = app
                .world_mut()
                .entity_mut(entity)
                .insert(RigidBody::KinematicPositionBased);
        },
        |app, entity| _ = app.world_mut().entity_mut(entity).remove::<RigidBody>(),
        |app, entity| {
            let mesh = app
                .world_mut()
                .resource_mut::<Assets<Mesh>>()
                .add(bevy_mesh(&slab(HALF * 0.9)));
            app.world_mut().entity_mut(entity).insert(Mesh3d(mesh));
            settle(app);
        },
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let (mut app, surface) = grounded(3.0);
        let ball = thing(&mut app, Collider::ball(0.3), 1.0, Vec3::new(0.0, 0.8, 0.05), ());
        run(&mut app, 10);
        rise(&mut app, surface, 20, 0.5);
        assert!(diagnostics(&app).parts > 0);
        change(&mut app, surface);
        for frame in 20..60 {
            if app.world().get_entity(surface).is_ok() {
                set_weights(&mut app, surface, &[0.0, 0.5 * DT * frame as f32, 0.0, 0.0]);
            }
            run(&mut app, 1);
        }
        assert!(place(&app, ball).is_finite(), "{number}");
        let joints = app.world_mut().query::<&RapierContextJoints>().single(app.world());
        assert_eq!(joints.unwrap().multibody_joints.iter().count(), 0, "{number}");
    }
}

#[test]
fn two_surfaces_on_one_body_push_together() {
    let mut app = app();
    let root = (
        RigidBody::Dynamic,
        Velocity::default(),
        GravityScale(0.0),
        AdditionalMassProperties::MassProperties(mass_of(3.0, Vec3::new(3.0, 0.25, 1.0))),
        Transform::default(),
        Sleeping::disabled(),
    );
    let root = app.world_mut().spawn(root).id();
    let sides = [-2.0, 2.0].map(|x| {
        let weight = ColliderMassProperties::Density(0.0);
        spawn(
            &mut app,
            &slab(HALF),
            (weight, Transform::from_xyz(x, 0.0, 0.0), ChildOf(root)),
        )
    });
    settle(&mut app);
    let balls = [-2.0, 2.0].map(|x| {
        let at = Vec3::new(x, HALF.y + 0.4, 0.0);
        thing(&mut app, Collider::ball(0.3), 0.5, at, GravityScale(0.0))
    });
    for frame in 1..=12 {
        for side in sides {
            set_weights(&mut app, side, &[0.0, 5.0 * DT * frame as f32, 0.0, 0.0]);
        }
        run(&mut app, 1);
    }
    run(&mut app, 20);
    let momentum = 0.5 * (velocity(&app, balls[0]) + velocity(&app, balls[1])) + 3.0 * velocity(&app, root);
    println!("{:?} {momentum}", balls.map(|ball| velocity(&app, ball)));
    for ball in balls {
        assert!((velocity(&app, ball).y - 3.75).abs() < 0.2, "{}", velocity(&app, ball));
    }
    assert!(momentum.length() < 5e-3, "{momentum}");
}

#[test]
fn a_fast_body_does_not_pass_and_a_jump_throws_nothing() {
    let (mut app, surface) = floating(100.0);
    let bullet = thing(
        &mut app,
        Collider::ball(0.05),
        0.1,
        Vec3::new(0.1, 3.0, 0.2),
        GravityScale(0.0),
    );
    app.world_mut()
        .entity_mut(bullet)
        .insert(Velocity::linear(Vec3::Y * -60.0));
    rise(&mut app, surface, 30, 0.2);
    assert!(place(&app, bullet).y > HALF.y, "{}", place(&app, bullet));

    let (mut app, surface) = floating(3.0);
    let ball = thing(
        &mut app,
        Collider::ball(0.3),
        1.0,
        Vec3::Y * (HALF.y + 0.31),
        GravityScale(0.0),
    );
    run(&mut app, 3);
    set_weights(&mut app, surface, &[0.0, 0.2, 0.0, 0.0]);
    run(&mut app, 60);
    println!("{}", velocity(&app, ball));
    // It is pushed out at most at Rapier's own speed for that.
    assert!(velocity(&app, ball).y < 3.5, "{}", velocity(&app, ball));
}

#[test]
fn a_body_jumps_off_the_ground_with_its_own_leg() {
    let mut app = app();
    app.world_mut()
        .spawn((Collider::cuboid(50.0, 0.5, 50.0), Transform::from_xyz(0.0, -0.5, 0.0)));
    let mut mesh = slab(HALF);
    let leg = mesh
        .positions
        .iter()
        .map(|p| if p.y < 0.0 { -Vec3::Y } else { Vec3::ZERO });
    mesh.targets[3] = leg.collect();
    let body = spawn_on(&mut app, &mesh, 3.0, Vec3::Y * (HALF.y + 0.02), ());
    run(&mut app, 60);
    for frame in 1..=12 {
        set_weights(&mut app, body, &[0.0, 0.0, 0.0, 3.0 * DT * frame as f32]);
        run(&mut app, 1);
    }
    let speed = velocity(&app, body).y;
    println!("{speed} {}", place(&app, body));
    assert!((speed - 3.0).abs() < 0.3, "{speed}");
}

#[test]
fn a_body_that_slept_before_its_surface_came_falls_and_holds() {
    let mut app = app();
    app.world_mut()
        .spawn((Collider::cuboid(5.0, 0.5, 5.0), Transform::from_xyz(0.0, -0.5, 0.0)));
    let above = Transform::from_xyz(0.0, HALF.y + 0.1, 0.0);
    let early = app
        .world_mut()
        .spawn((RigidBody::Dynamic, above, Velocity::default()))
        .id();
    // As long as a model loads.
    run(&mut app, 150);
    let surface = spawn(&mut app, &slab_cut(HALF, 2), ());
    let parts = app.world_mut().entity_mut(surface).take::<(Mesh3d, MeshMorphWeights)>();
    app.world_mut()
        .entity_mut(early)
        .insert((parts.unwrap(), MorphPhysicsCollider::default()));
    app.world_mut().despawn(surface);
    settle(&mut app);
    run(&mut app, 60);
    let height = place(&app, early).y;
    assert!((height - HALF.y).abs() < 1e-2, "it stays at {height}");
    let ball = body(&mut app, Collider::ball(0.2), Vec3::new(0.1, 2.0 * HALF.y + 0.25, 0.05));
    run(&mut app, 60);
    let height = place(&app, ball).y;
    assert!((height - 2.0 * HALF.y - 0.2).abs() < 1e-2, "the ball is at {height}");
}

#[test]
fn a_slab_whose_sides_stand_straight_on_the_ground_stays_where_it_is() {
    for locked in [
        LockedAxes::ROTATION_LOCKED,
        LockedAxes::ROTATION_LOCKED | LockedAxes::TRANSLATION_LOCKED_X,
    ] {
        let mut app = app();
        app.world_mut()
            .spawn((Collider::cuboid(5.0, 0.5, 5.0), Transform::from_xyz(0.0, -0.5, 0.0)));
        let above = Transform::from_xyz(0.0, HALF.y + 0.01, 0.0);
        let surface = spawn(
            &mut app,
            &slab(HALF),
            (RigidBody::Dynamic, above, Velocity::default(), locked),
        );
        settle(&mut app);
        let ball = body(&mut app, Collider::ball(0.2), Vec3::new(0.1, 2.0 * HALF.y + 0.25, 0.05));
        // It touches the ground exactly, and falls asleep.
        run(&mut app, 60);
        rise(&mut app, surface, 60, 0.5);
        let at = place(&app, surface);
        assert!(at.distance(Vec3::Y * HALF.y) < 5e-3, "{locked:?}: {at}");
        let speed = velocity(&app, ball).y;
        assert!((speed - 0.5).abs() < 0.01, "{locked:?}: {speed}");
    }
}
