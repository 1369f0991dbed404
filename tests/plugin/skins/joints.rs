//! Where joints put a mesh, in all circumstances.

use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;

use super::{add, along_x, boned, extent, limb, put, skeleton, spawn_joints, spawn_limb, spawn_skinned};
use crate::log::Errors;
use crate::support::{
    Edits, Messages, add_mesh, app, cube, fixed_app, move_to, set_weight, settle, spawn, stretching_cube, touches,
};

#[test]
fn a_mesh_collides_where_its_joints_are_and_not_where_its_entity_is() {
    let mut app = app();
    let (limb, joints) = spawn_limb(&mut app, 0.0);
    let mesh = add_mesh(&mut app, &cube());
    let wall = spawn(&mut app, &mesh, 2.0);
    settle(&mut app);
    assert!(!touches(&app, limb, wall));
    let mut messages = Messages::default();
    messages.read(&app);

    put(&mut app, joints[1], Transform::from_xyz(1.25, 0.0, 0.0));
    app.update();
    let (starts, ends) = messages.read(&app);
    assert!(starts.len() == 1 && ends.is_empty(), "{starts:?} {ends:?}");
    assert!((starts[0].point.x - 1.5).abs() < 0.26, "{:?}", starts[0].point);
    assert_eq!(along_x(&mut app, limb), Some((-0.5, 1.75)));

    // Its own place does not matter, even if it is invalid.
    put(
        &mut app,
        limb,
        Transform::from_translation(Vec3::NAN).with_scale(Vec3::ZERO),
    );
    app.update();
    assert!(touches(&app, limb, wall));
    put(&mut app, joints[1], Transform::default());
    app.update();
    assert_eq!(messages.read(&app).1.len(), 1);
}

#[test]
fn targets_move_vertices_before_joints_do() {
    let mut app = app();
    let mesh = add(&mut app, boned(&stretching_cube(), |_| 0));
    let joints = spawn_joints(&mut app, [Vec3::ZERO]);
    let skin = skeleton(&mut app, &joints);
    let cube = spawn_skinned(&mut app, &mesh, skin);
    set_weight(&mut app, cube, 2.0);
    // A quarter turn takes +X to +Y.
    let turned = Transform::from_xyz(5.0, 0.0, 0.0).with_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    put(&mut app, joints[0], turned);
    settle(&mut app);
    let (min, max) = extent(&mut app, cube).unwrap();
    assert!(min.distance(Vec3::new(4.5, -0.5, -0.5)) < 1e-5, "{min}");
    assert!(max.distance(Vec3::new(5.5, 2.5, 0.5)) < 1e-5, "{max}");
}

#[test]
fn a_skeleton_comes_changes_and_goes() {
    let mut app = app();
    let (limb, _) = spawn_limb(&mut app, 1.0);
    put(&mut app, limb, Transform::from_xyz(0.0, 0.0, 10.0));
    let skin = app.world().get::<SkinnedMesh>(limb).unwrap().clone();
    settle(&mut app);
    assert_eq!(along_x(&mut app, limb), Some((-0.5, 1.5)));

    // Other joints, the same number of them, from the next frame on.
    let others = spawn_joints(&mut app, [Vec3::X * 3.0, Vec3::X * 5.0]);
    let other = skeleton(&mut app, &others);
    app.insert(limb, other);
    app.update();
    assert_eq!(along_x(&mut app, limb), Some((2.5, 5.5)));

    // A different number, once there is a tree for it.
    let three = spawn_joints(&mut app, [Vec3::X * 7.0, Vec3::X * 8.0, Vec3::ZERO]);
    let three = skeleton(&mut app, &three);
    app.insert(limb, three);
    settle(&mut app);
    assert_eq!(along_x(&mut app, limb), Some((6.5, 8.5)));
    let trees = |app: &App| app.world().resource::<MorphTrees>().iter().count();
    assert_eq!(trees(&app), 1, "nothing uses the other one");

    app.remove::<SkinnedMesh>(limb);
    settle(&mut app);
    let (min, max) = extent(&mut app, limb).unwrap();
    assert_eq!(
        (min, max),
        (Vec3::new(-0.5, -0.5, 9.5), Vec3::new(0.5, 0.5, 10.5)),
        "its own transform counts again"
    );
    assert_eq!(trees(&app), 1);

    app.insert(limb, skin);
    settle(&mut app);
    assert_eq!(along_x(&mut app, limb), Some((-0.5, 1.5)));
}

#[test]
fn a_joint_that_never_was_leaves_the_mesh_and_one_that_is_gone_stays() {
    let mut app = app();
    let mesh = add(&mut app, limb());
    let [there, gone] = spawn_joints(&mut app, [Vec3::X * -1.0, Vec3::X * 9.0]);
    app.world_mut().despawn(gone);
    let skin = skeleton(&mut app, &[there, gone]);
    let limb = spawn_skinned(&mut app, &mesh, skin);
    settle(&mut app);
    // Like the identity.
    assert_eq!(along_x(&mut app, limb), Some((-1.5, 0.5)));
    app.world_mut().despawn(there);
    app.update();
    assert_eq!(along_x(&mut app, limb), Some((-1.5, 0.5)));
    app.update();
    assert_eq!(along_x(&mut app, limb), Some((-1.5, 0.5)));
}

#[test]
fn without_inverse_bind_poses_vertices_stay_where_they_are() {
    let mut app = app();
    let mesh = add(&mut app, limb());
    let joints = spawn_joints(&mut app, [Vec3::X * -2.0, Vec3::X * 3.0]);
    // There is one bind pose for two joints.
    let mut skin = skeleton(&mut app, &joints[..1]);
    skin.joints = joints.to_vec();
    let short = spawn_skinned(&mut app, &mesh, skin.clone());
    skin.inverse_bindposes = Handle::default();
    let none = spawn_skinned(&mut app, &mesh, skin.clone());
    settle(&mut app);
    assert_eq!(along_x(&mut app, short), Some((-2.5, 0.5)));
    assert_eq!(along_x(&mut app, none), Some((-0.5, 0.5)));

    // Inverse bind poses are applied before the joints.
    let poses = [1.0, 10.0].map(|x| Mat4::from_translation(Vec3::X * x));
    let mut assets = app.world_mut().resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
    skin.inverse_bindposes = assets.add(SkinnedMeshInverseBindposes::from(poses.to_vec()));
    app.insert(none, skin);
    app.update();
    assert_eq!(along_x(&mut app, none), Some((-1.5, 13.5)));
}

#[test]
fn bad_joints_are_logged_once_per_skeleton_and_the_mesh_stays() {
    Errors::collect(|log| {
        let mut app = app();
        let (limb, joints) = spawn_limb(&mut app, 1.0);
        let (mesh, skin) = (
            app.world().get::<Mesh3d>(limb).unwrap().0.clone(),
            app.world().get::<SkinnedMesh>(limb).unwrap().clone(),
        );
        spawn_skinned(&mut app, &mesh, skin.clone());
        app.insert(joints[1], Name::new("elbow"));
        settle(&mut app);
        for bad in [
            Transform::from_xyz(f32::NAN, 0.0, 0.0),
            Transform::from_scale(Vec3::splat(f32::INFINITY)),
            Transform::from_xyz(0.0, 1e35, 0.0),
        ] {
            // The valid joint does not move the mesh on its own.
            put(&mut app, joints[0], Transform::from_xyz(-3.0, 0.0, 0.0));
            put(&mut app, joints[1], bad);
            for _ in 0..3 {
                app.update();
            }
            assert_eq!(along_x(&mut app, limb), Some((-0.5, 1.5)), "{bad:?}");
            let logged = log.take();
            assert_eq!(logged.len(), 1, "{bad:?}: {logged:?}");
            for part in ["elbow", "joint 1", "the last good ones stay in force"] {
                assert!(logged[0].contains(part), "{logged:?} does not say {part}");
            }
            put(&mut app, joints[0], Transform::default());
            put(&mut app, joints[1], Transform::from_xyz(1.0, 0.0, 0.0));
            app.update();
            assert_eq!(log.take(), [""; 0]);
        }

        // A mesh whose joints were never valid is left out until they are.
        put(&mut app, joints[1], Transform::from_translation(Vec3::NAN));
        app.update();
        log.take();
        let others = spawn_joints(&mut app, [Vec3::ZERO, Vec3::NAN]);
        let other = skeleton(&mut app, &others);
        let new = spawn_skinned(&mut app, &mesh, other);
        settle(&mut app);
        assert_eq!(extent(&mut app, new), None);
        assert_eq!(log.take().len(), 1);
        put(&mut app, others[1], Transform::from_xyz(2.0, 0.0, 0.0));
        app.update();
        assert_eq!(along_x(&mut app, new), Some((-0.5, 2.5)));
        // A skeleton that is invalid from the beginning: the pose of the previous one stays.
        let bad = spawn_joints(&mut app, [Vec3::INFINITY; 2]);
        let bad = skeleton(&mut app, &bad);
        app.insert(new, bad);
        app.update();
        assert_eq!(along_x(&mut app, new), Some((-0.5, 2.5)));
        assert_eq!(log.take().len(), 1);
    });
}

#[test]
fn joints_are_read_after_parents_have_moved_them() {
    for mut app in [app(), fixed_app(1, 1)] {
        let (limb, joints) = spawn_limb(&mut app, 0.0);
        let parent = app.spawn(Transform::default());
        app.insert(joints[0], ChildOf(parent));
        app.insert(joints[1], ChildOf(joints[0]));
        settle(&mut app);
        for x in [1.0, -7.0] {
            move_to(&mut app, parent, x);
            app.update();
            assert_eq!(along_x(&mut app, limb), Some((x - 0.5, x + 0.5)));
        }
        // Another parent for both.
        let other = app.spawn(Transform::from_xyz(0.0, 3.0, 0.0));
        app.insert(joints[0], ChildOf(other));
        app.update();
        assert_eq!(along_x(&mut app, limb), Some((-0.5, 0.5)));
        app.world_mut().despawn(other);
        app.update();
        assert_eq!(
            along_x(&mut app, limb),
            Some((-0.5, 0.5)),
            "what is gone stays where it was"
        );
    }
}
