//! Meshes that joints move carry and throw the bodies on them.

use avian3d::prelude::*;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use morph_collision_workspace::physics::{bevy_mesh, settle, sheet};

use crate::support::{DT, all_below, app, body, is_asleep, place, population, run, set_weights, velocity};

/// A sheet of which joint 0 moves the side at -x, joint 1 the side at +x, and both the part near the origin. The place of its own
/// entity does not matter.
fn flap(app: &mut App) -> (Entity, [Entity; 2]) {
    let mesh = sheet(32);
    let share = |p: &Vec3| (p.x + 0.5).clamp(0.0, 1.0);
    let weights: Vec<[f32; 4]> = mesh
        .positions
        .iter()
        .map(|p| [1.0 - share(p), share(p), 0.0, 0.0])
        .collect();
    let joints = vec![[0, 1, 0, 0]; weights.len()];
    let shown = bevy_mesh(&mesh)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints))
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    let world = app.world_mut();
    let joints = [(); 2].map(|()| world.spawn(Transform::default()).id());
    let shown = world.resource_mut::<Assets<Mesh>>().add(shown);
    let mut bind_poses = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
    let skin = SkinnedMesh {
        inverse_bindposes: bind_poses.add(SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2])),
        joints: joints.to_vec(),
    };
    let weights = MeshMorphWeights::Value { weights: vec![0.0; 2] };
    let place = Transform::from_xyz(30.0, 20.0, 10.0).with_rotation(Quat::from_rotation_x(0.7));
    let bundle = (Mesh3d(shown), weights, skin, MorphPhysicsCollider::default(), place);
    let surface = world.spawn(bundle).id();
    settle(app);
    (surface, joints)
}

/// The flap with a box on it that has come to rest.
fn box_on_flap() -> (App, Entity, [Entity; 2], Entity) {
    let mut app = app();
    let (surface, joints) = flap(&mut app);
    let cuboid = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(2.0, 0.16, 0.3));
    run(&mut app, 30);
    assert!((place(&app, cuboid).y - 0.15).abs() < 1e-2, "{}", place(&app, cuboid));
    (app, surface, joints, cuboid)
}

fn pose(app: &mut App, joint: Entity, place: Transform) {
    app.world_mut().entity_mut(joint).insert(place);
}

#[test]
fn a_box_on_a_joint_that_rises_and_slides_is_carried() {
    let (mut app, surface, joints, cuboid) = box_on_flap();
    for i in 1..=90 {
        let time = DT * i as f32;
        for joint in joints {
            pose(&mut app, joint, Transform::from_xyz(time, 0.3 * time, 0.0));
        }
        // Its targets move it too.
        set_weights(&mut app, surface, &[0.2 * time, 0.0]);
        run(&mut app, 1);
        if i > 40 {
            let gap = place(&app, cuboid).y - 0.15 - 0.5 * time;
            assert!(gap.abs() < 1e-2, "gap {gap} in step {i}");
            let speed = velocity(&app, cuboid);
            assert!(speed.distance(Vec3::new(1.0, 0.5, 0.0)) < 0.02, "{speed} in step {i}");
        }
    }
    let hits = all_below(&mut app, -1.0, 1.0);
    assert!(hits.len() == 1 && (hits[0].1 - 0.75).abs() < 1e-4, "{hits:?}");
}

#[test]
fn a_box_on_a_joint_that_turns_moves_as_its_own_place_does() {
    let (mut app, _, joints, cuboid) = box_on_flap();
    const TURN: f32 = 0.3;
    for i in 1..=60 {
        let turned = Transform::from_rotation(Quat::from_rotation_z(TURN * DT * i as f32));
        pose(&mut app, joints[1], turned);
        run(&mut app, 1);
        if i > 20 {
            let speed = velocity(&app, cuboid);
            let expected = Vec3::Z.cross(place(&app, cuboid)) * TURN;
            assert!(speed.distance(expected) < 0.05, "{speed} in step {i}, not {expected}");
        }
    }
}

#[test]
fn a_joint_that_strikes_throws_and_one_that_jumps_does_not() {
    let (mut app, _, joints, cuboid) = box_on_flap();
    for i in 1..=6 {
        pose(&mut app, joints[1], Transform::from_xyz(0.0, i as f32 / 12.0, 0.0));
        run(&mut app, 1);
    }
    let speed = velocity(&app, cuboid).y;
    assert!((4.5..5.5).contains(&speed), "thrown at {speed}");

    let (mut app, _, joints, cuboid) = box_on_flap();
    pose(&mut app, joints[1], Transform::from_xyz(0.0, 0.2, 0.0));
    let mut highest: f32 = 0.0;
    for _ in 0..60 {
        run(&mut app, 1);
        highest = highest.max(place(&app, cuboid).y);
    }
    assert!(highest < 0.45, "thrown to {highest}");
}

#[test]
fn a_body_asleep_on_joints_that_rest_wakes_with_them() {
    let (mut app, _, joints, cuboid) = box_on_flap();
    run(&mut app, 120);
    assert!(is_asleep(&app, cuboid));
    for i in 1..=30 {
        pose(&mut app, joints[1], Transform::from_xyz(0.0, -0.5 * DT * i as f32, 0.0));
        run(&mut app, 1);
        assert!(!is_asleep(&app, cuboid), "asleep in step {i}");
    }
    run(&mut app, 10);
    assert!((place(&app, cuboid).y + 0.1).abs() < 1e-2, "{}", place(&app, cuboid));
    assert_eq!(population(&mut app).1, 1);
}
