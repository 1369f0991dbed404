//! Bodies on a surface that moves.

use bevy::prelude::*;
use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::PointQuery;
use bevy_rapier3d::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::support::{app, global, place, run, set_weights, spawn, truth, velocity};

#[test]
fn what_is_swept_rises_with_the_surface_below_it() {
    for shape in [
        Collider::ball(0.1),
        Collider::cuboid(0.1, 0.1, 0.1),
        Collider::capsule_x(0.1, 0.1),
    ] {
        let mut app = app();
        let sheet = spawn(&mut app, &sheet(32), ());
        settle(&mut app);
        let swept = body(&mut app, shape, Vec3::new(0.1, 0.11, 0.05));
        app.world_mut().entity_mut(swept).insert(Ccd::enabled());
        run(&mut app, 60);
        let mut height = 0.0;
        for i in 1..=120_u8 {
            // It gets faster and faster, until it is swept in each step.
            let speed = (0.2 * f32::from(i)).min(8.0);
            height += speed * DT;
            set_weights(&mut app, sheet, &[height, 0.0]);
            run(&mut app, 1);
            let (gap, rises) = (place(&app, swept).y - 0.1 - height, velocity(&app, swept).y);
            assert!(gap.abs() < 1e-2, "gap {gap} in step {i}");
            assert!(
                (rises - speed).abs() < 0.02 * speed,
                "velocity {rises} of {speed} in step {i}"
            );
        }
    }
}

#[test]
fn contacts_of_what_rested_follow_a_surface_that_tilts_in_place() {
    let mut app = app();
    let corners = vec![
        Vec3::new(-4.0, 0.0, -2.0),
        Vec3::new(0.0, 0.0, 4.0),
        Vec3::new(4.0, 0.0, -2.0),
    ];
    let mut mesh = MorphMesh::rigid("triangle", corners, vec![[0, 1, 2]]);
    mesh.targets = vec![mesh.positions.iter().map(|p| 0.3 * p.x * Vec3::Y).collect()];
    mesh.target_names = vec!["tilt".into()];
    let surface = spawn(&mut app, &mesh, Friction::coefficient(1.0));
    settle(&mut app);
    let cuboid = body(&mut app, Collider::cuboid(0.5, 0.5, 0.5), Vec3::new(0.8, 0.5, 0.0));
    app.world_mut()
        .entity_mut(cuboid)
        .insert((LockedAxes::ROTATION_LOCKED, Sleeping::disabled()));
    run(&mut app, 60);
    // At once and about its middle, so the part's body stays where it is.
    set_weights(&mut app, surface, &[1.0]);
    run(&mut app, 60);
    let height = place(&app, cuboid).y;
    assert!(height > 0.85, "{height}");
}

/// A bowl that waves slowly.
fn bowl() -> MorphMesh {
    let mut bowl = sheet(32);
    for vertex in &mut bowl.positions {
        vertex.y = 0.1 * (vertex.x * vertex.x + vertex.z * vertex.z);
    }
    let wave = |axis: Vec3| move |p: &Vec3| Vec3::Y * 0.15 * (1.5 * axis.dot(*p)).sin();
    bowl.targets = vec![
        bowl.positions.iter().map(wave(Vec3::X)).collect(),
        bowl.positions.iter().map(wave(Vec3::new(0.3, 0.0, -1.0))).collect(),
    ];
    bowl
}

#[test]
fn a_ball_stays_on_a_surface_that_morphs_slowly() {
    let bowl = bowl();
    let mut app = app();
    let surface = spawn(&mut app, &bowl, ());
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.4), Vec3::new(0.3, 1.0, 0.2));
    app.world_mut().entity_mut(ball).insert(Damping {
        linear_damping: 1.0,
        angular_damping: 1.0,
    });
    let mut worst: f32 = 0.0;
    for i in 0..600 {
        let time = i as f32 * DT;
        let weights = [(0.7 * time).sin(), (0.9 * time).sin()];
        set_weights(&mut app, surface, &weights);
        run(&mut app, 1);
        if i >= 120 {
            let mesh = truth(&bowl, &weights, &global(&app, surface));
            let distance = mesh.distance_to_point(&Pose::IDENTITY, place(&app, ball), true);
            worst = worst.max((distance - 0.4).abs());
        }
    }
    assert!(worst < 1e-2, "off the surface by {worst}");
}

#[test]
fn a_long_body_is_not_carried_by_a_surface_that_turns_different_ways() {
    // Both halves slide towards the middle.
    let mut mesh = sheet(32);
    mesh.targets = vec![
        mesh.positions
            .iter()
            .map(|p| Vec3::X * -p.x.clamp(-0.2, 0.2) * 5.0)
            .collect(),
    ];
    let mut app = app();
    let surface = spawn(&mut app, &mesh, ());
    settle(&mut app);
    let plank = body(&mut app, Collider::cuboid(2.5, 0.1, 0.2), Vec3::new(0.0, 0.11, 0.03));
    let left = body(&mut app, Collider::cuboid(0.1, 0.1, 0.1), Vec3::new(-2.0, 0.11, 2.0));
    run(&mut app, 30);
    for i in 1..=60 {
        set_weights(&mut app, surface, &[0.5 * DT * i as f32]);
        run(&mut app, 1);
    }
    assert!(velocity(&app, plank).length() < 0.05, "{}", velocity(&app, plank));
    assert!((velocity(&app, left).x - 0.5).abs() < 0.05, "{}", velocity(&app, left));
    assert!((place(&app, plank).y - 0.1).abs() < 1e-2, "{}", place(&app, plank));
}
