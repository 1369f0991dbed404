//! Bodies that can lie on a surface, and bodies that can have surfaces.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::generated::{random, rigid};
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::support::{app, below, place, population, run, set_weights, spawn, velocity};

#[test]
fn every_shape_rests_on_it_and_rises_with_it() {
    let corners: Vec<Vec3> = (0..8)
        .map(|i| {
            Vec3::new(
                (i & 1) as f32 - 0.5,
                (i >> 1 & 1) as f32 - 0.5,
                (i >> 2 & 1) as f32 - 0.5,
            )
        })
        .collect();
    let cube = rigid::box_mesh(Vec3::splat(0.5));
    let shapes = [
        ("ball", Collider::ball(0.5)),
        ("cuboid", Collider::cuboid(0.5, 0.5, 0.5)),
        ("capsule", Collider::capsule_x(0.5, 0.5)),
        ("cylinder", Collider::cylinder(0.5, 0.4)),
        ("cone", Collider::cone(0.5, 0.4)),
        ("round cuboid", Collider::round_cuboid(0.4, 0.4, 0.4, 0.1)),
        ("convex hull", Collider::convex_hull(&corners).unwrap()),
        (
            "mesh",
            Collider::trimesh(cube.positions.clone(), cube.triangles.clone()).unwrap(),
        ),
        (
            "compound",
            Collider::compound(vec![
                (Vec3::X, Quat::IDENTITY, Collider::ball(0.5)),
                (-Vec3::X, Quat::IDENTITY, Collider::cuboid(0.5, 0.5, 0.5)),
            ]),
        ),
    ];
    for (name, shape) in shapes {
        let mut app = app();
        let surface = spawn(&mut app, &sheet(16), ());
        settle(&mut app);
        let it = body(&mut app, shape, Vec3::new(0.1, 0.51, 0.05));
        run(&mut app, 60);
        for i in 1..=60 {
            set_weights(&mut app, surface, &[0.5 * DT * i as f32, 0.0]);
            run(&mut app, 1);
        }
        let (height, speed) = (place(&app, it).y, velocity(&app, it).y);
        assert!((height - 1.0).abs() < 1e-2, "{name} is at {height}");
        assert!((speed - 0.5).abs() < 0.025, "{name} rises at {speed}");
    }
}

#[test]
fn a_morphing_body_falls_on_a_morphing_surface() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    let mut cube = rigid::box_mesh(Vec3::splat(0.5));
    cube.targets = vec![cube.positions.iter().map(|p| Vec3::Y * p.y).collect()];
    let jelly = spawn(
        &mut app,
        &cube,
        (
            RigidBody::Dynamic,
            Velocity::default(),
            Transform::from_xyz(0.1, 0.6, 0.05),
        ),
    );
    settle(&mut app);
    run(&mut app, 90);
    let rests = place(&app, jelly);
    assert!((rests.y - 0.5).abs() < 1e-2, "it rests at {rests}");
    // It slowly grows to twice its height and stands on the surface all the time.
    for i in 1..=120 {
        set_weights(&mut app, jelly, &[i as f32 / 120.0]);
        run(&mut app, 1);
    }
    run(&mut app, 30);
    let rests = place(&app, jelly);
    assert!((rests.y - 1.0).abs() < 2e-2, "it stands at {rests}");
    let turned = app.world().get::<Transform>(jelly).unwrap().rotation * Vec3::Y;
    assert!(turned.y > 0.995, "it leans to {turned}");
    for i in 1..=60 {
        set_weights(&mut app, surface, &[0.5 * DT * i as f32, 0.0]);
        run(&mut app, 1);
    }
    let (height, speed) = (place(&app, jelly).y, velocity(&app, jelly).y);
    assert!(
        (height - 1.5).abs() < 2e-2 && (speed - 0.5).abs() < 0.03,
        "{height}, {speed}"
    );
}

#[test]
fn a_surface_on_a_kinematic_body_carries() {
    for kind in [RigidBody::KinematicVelocityBased, RigidBody::KinematicPositionBased] {
        let mut app = app();
        let platform = spawn(&mut app, &sheet(16), (kind, Velocity::default(), Transform::default()));
        settle(&mut app);
        let cuboid = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(0.1, 0.31, 0.05));
        run(&mut app, 60);
        // It slides at 1/s as a body and rises at 0.5/s by morphing.
        for i in 1..=60 {
            if kind == RigidBody::KinematicVelocityBased {
                app.world_mut().get_mut::<Velocity>(platform).unwrap().linear = Vec3::X;
            } else {
                app.world_mut().get_mut::<Transform>(platform).unwrap().translation.x = DT * i as f32;
            }
            set_weights(&mut app, platform, &[0.5 * DT * i as f32, 0.0]);
            run(&mut app, 1);
        }
        let speed = velocity(&app, cuboid);
        assert!((speed - Vec3::new(1.0, 0.5, 0.0)).length() < 0.05, "{kind:?}: {speed}");
        assert!(
            (place(&app, cuboid).y - 0.8).abs() < 1e-2,
            "{kind:?}: {}",
            place(&app, cuboid)
        );
    }
}

#[test]
fn a_surface_below_other_entities_stands_where_they_put_it() {
    let mut app = app();
    let root = Transform::from_xyz(0.0, 1.0, 0.0).with_scale(Vec3::new(2.0, 3.0, 0.5));
    let body_above = app.world_mut().spawn((RigidBody::Fixed, root)).id();
    let tilted = Transform::from_rotation(Quat::from_rotation_y(0.5)).with_scale(Vec3::new(0.5, 1.0, 2.0));
    let surface = spawn(&mut app, &sheet(16), (tilted, ChildOf(body_above)));
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.3), Vec3::new(0.1, 1.5, 0.05));
    run(&mut app, 90);
    assert!((place(&app, ball).y - 1.3).abs() < 1e-2, "{}", place(&app, ball));
    // The target's unit is three world units.
    for i in 1..=30 {
        set_weights(&mut app, surface, &[0.2 * DT * i as f32, 0.0]);
        run(&mut app, 1);
    }
    let (height, speed) = (place(&app, ball).y, velocity(&app, ball).y);
    assert!(
        (height - 1.6).abs() < 1e-2 && (speed - 0.6).abs() < 0.03,
        "{height}, {speed}"
    );
}

#[test]
fn bodies_lie_on_a_random_surface_stretched_and_mirrored() {
    let blob = random::random_blob(3, 3, 2, 0.3);
    let place_of = Transform::from_xyz(1.0, -1.0, 0.5)
        .with_rotation(Quat::from_rotation_x(0.4))
        .with_scale(Vec3::new(-4.0, 2.0, 3.0));
    let mut app = app();
    let surface = spawn(&mut app, &blob, place_of);
    settle(&mut app);
    let balls: Vec<Entity> = (0..20)
        .map(|i| {
            let at = Vec3::new(0.2 * i as f32 - 1.0, 4.0 + 0.3 * i as f32, 0.5);
            body(&mut app, Collider::ball(0.2), at)
        })
        .collect();
    for i in 0..120 {
        let time = i as f32 * DT;
        let weights = [0.5 * (3.0 * time).sin(), 0.5 * (2.0 * time).sin()];
        set_weights(&mut app, surface, &weights);
        run(&mut app, 1);
        let inside = |ball: &Entity| {
            let at = place(&app, *ball);
            at.is_finite() && (at - place_of.translation).length() < 0.5
        };
        assert!(!balls.iter().any(inside), "a ball fell in, step {i}");
    }
}

#[test]
fn a_collider_that_is_not_asked_into_physics_any_more_has_nothing_there() {
    let mut app = app();
    let mesh = spawn(&mut app, &sheet(4), ());
    settle(&mut app);
    assert!(app.world().entity(mesh).contains::<Collider>());
    assert_eq!(population(&mut app), (1, 0));
    assert_eq!(below(&mut app, 0.1, 0.2).map(|(entity, _)| entity), Some(mesh));
    app.world_mut().entity_mut(mesh).remove::<MorphPhysicsCollider>();
    // At once and for good, although it is still a collider of the collision plugin.
    assert!(!app.world().entity(mesh).contains::<Collider>());
    run(&mut app, 3);
    let entity = app.world().entity(mesh);
    assert!(!entity.contains::<Collider>() && entity.contains::<MorphCollider>());
    assert_eq!(population(&mut app), (0, 0));
    assert_eq!(below(&mut app, 0.1, 0.2), None);
}

#[test]
fn two_bodies_may_share_a_surface() {
    let mut app = app();
    let cube = rigid::box_mesh(Vec3::splat(0.5));
    let dynamic = |at: Vec3| (RigidBody::Dynamic, Velocity::default(), Transform::from_translation(at));
    let one = spawn(&mut app, &cube, dynamic(Vec3::new(0.0, 0.51, 0.0)));
    app.world_mut()
        .spawn((Collider::cuboid(5.0, 1.0, 5.0), Transform::from_xyz(0.0, -1.0, 0.0)));
    settle(&mut app);
    let collider = app.world().get::<Collider>(one).unwrap().clone();
    let other = app
        .world_mut()
        .spawn((collider, dynamic(Vec3::new(0.1, 1.6, 0.1))))
        .id();
    run(&mut app, 90);
    assert!((place(&app, one).y - 0.5).abs() < 2e-2, "{}", place(&app, one));
    assert!((place(&app, other).y - 1.5).abs() < 2e-2, "{}", place(&app, other));
}
