//! Several skinned meshes at once: what they share, and what is recomputed when joints change.

use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use morph_collision_models::mesh::MorphMesh;

use super::{add, along_x, boned, limb, put, skeleton, spawn_joints, spawn_limb, spawn_skinned};
use crate::support::{Messages, add_mesh, app, cube, diagnostics, settle, spawn, touches};

#[test]
fn a_character_at_rest_costs_no_comparison_and_moves_nothing() {
    let mut app = app();
    let (limb, joints) = spawn_limb(&mut app, 1.0);
    let mesh = add_mesh(&mut app, &cube());
    let wall = spawn(&mut app, &mesh, 1.0);
    settle(&mut app);
    assert!(touches(&app, limb, wall));
    for _ in 0..3 {
        // Writes the same values again, as animation does.
        for (joint, x) in joints.into_iter().zip([0.0, 1.0]) {
            put(&mut app, joint, Transform::from_xyz(x, 0.0, 0.0));
        }
        app.update();
        let diagnostics = diagnostics(&app);
        assert_eq!((diagnostics.candidate_pairs, diagnostics.skipped_unchanged), (1, 1));
        assert_eq!(diagnostics.stats, default());
    }
    put(&mut app, joints[1], Transform::from_xyz(1.0, 0.125, 0.0));
    app.update();
    assert_eq!(diagnostics(&app).skipped_unchanged, 0);
}

#[test]
fn a_joint_that_moves_inside_the_box_of_its_mesh_ends_contacts() {
    let mut app = app();
    // Triangles in two corners determine the box; joint 1 moves the triangle between them.
    let triangle = |at: Vec3| [at, at + Vec3::new(2.0, 0.1, 0.0), at + Vec3::new(2.0, -0.1, 0.1)];
    let positions = [Vec3::splat(-9.0), Vec3::ZERO, Vec3::splat(7.0)].map(triangle).concat();
    let mesh = MorphMesh::rigid("three triangles", positions, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
    let mesh = add(&mut app, boned(&mesh, |p| u16::from(p.abs().max_element() < 3.0)));
    let joints = spawn_joints(&mut app, [Vec3::ZERO; 2]);
    let skin = skeleton(&mut app, &joints);
    let skinned = spawn_skinned(&mut app, &mesh, skin);
    let wall = add_mesh(&mut app, &cube());
    let wall = spawn(&mut app, &wall, 0.0);
    settle(&mut app);
    let mut messages = Messages::default();
    messages.read(&app);
    let box_before = along_x(&mut app, skinned);
    let mut was_touching = true;
    for (x, is_touching) in [(0.0, true), (2.0, false), (-0.5, true), (-4.0, false)] {
        put(&mut app, joints[1], Transform::from_xyz(x, 0.0, 0.0));
        app.update();
        assert_eq!(touches(&app, skinned, wall), is_touching, "at {x}");
        let (starts, ends) = messages.read(&app);
        let changes = [is_touching && !was_touching, was_touching && !is_touching];
        assert_eq!([starts.len(), ends.len()], changes.map(usize::from), "at {x}");
        assert_eq!(along_x(&mut app, skinned), box_before);
        was_touching = is_touching;
    }
}

#[test]
fn meshes_of_one_skeleton_and_instances_of_one_mesh_move_each_by_itself() {
    let mut app = app();
    let mesh = add(&mut app, limb());
    let mut limbs = Vec::new();
    for x in [0.0, 4.0, 8.0] {
        let joints = spawn_joints(&mut app, [Vec3::X * x, Vec3::X * (x + 1.0)]);
        let skin = skeleton(&mut app, &joints);
        let twins = [(); 2].map(|()| spawn_skinned(&mut app, &mesh, skin.clone()));
        limbs.push((joints, twins));
    }
    settle(&mut app);
    assert_eq!(app.world().resource::<MorphTrees>().iter().count(), 1);
    for frame in 0..3 {
        for (i, (joints, twins)) in limbs.iter().enumerate() {
            let x = 4.0 * i as f32;
            for twin in twins {
                let end = x + 1.5 + if i == 1 { frame as f32 } else { 0.0 };
                assert_eq!(along_x(&mut app, *twin), Some((x - 0.5, end)), "{i}, frame {frame}");
            }
            assert!(touches(&app, twins[0], twins[1]));
            if i == 1 {
                put(
                    &mut app,
                    joints[1],
                    Transform::from_xyz(x + 2.0 + frame as f32, 0.0, 0.0),
                );
            }
        }
        app.update();
    }
}

#[test]
fn skeletons_that_share_bind_poses_and_a_joint_are_told_apart() {
    let mut app = app();
    let mesh = add(&mut app, limb());
    let [shared, near, far] = spawn_joints(&mut app, [Vec3::ZERO, Vec3::X, Vec3::X * 6.0]);
    let skin = skeleton(&mut app, &[shared, near]);
    let other = SkinnedMesh {
        joints: vec![shared, far],
        ..skin.clone()
    };
    let limbs = [skin, other].map(|skin| spawn_skinned(&mut app, &mesh, skin));
    settle(&mut app);
    for x in [1.0, 3.0] {
        put(&mut app, near, Transform::from_xyz(x, 0.0, 0.0));
        app.update();
        let found = limbs.map(|limb| along_x(&mut app, limb));
        assert_eq!(found, [Some((-0.5, 0.5 + x)), Some((-0.5, 6.5))]);
    }
}
