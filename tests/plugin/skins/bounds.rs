//! The `Aabb` that Bevy uses to cull skinned meshes.

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{DynamicSkinnedMeshBounds, NoFrustumCulling, VisibilityPlugin};
use bevy::math::Vec3A;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;

use super::{add, boned, limb, put, skeleton, spawn_joints};
use crate::log::start;
use crate::support::{Edits, assets, set_weight, settle, stretching_cube};

fn app() -> App {
    let mut app = headless(&assets());
    app.add_plugins((VisibilityPlugin, MorphBoundsPlugin));
    start(&mut app);
    app
}

/// A skinned mesh with some placement, without a collider.
fn spawn<const N: usize>(app: &mut App, mut mesh: Mesh, joints: [Vec3; N], place: Transform) -> (Entity, [Entity; N]) {
    mesh.generate_skinned_mesh_bounds().expect("it has joints");
    let mesh = add(app, mesh);
    let joints = spawn_joints(app, joints);
    let skin = skeleton(app, &joints);
    let entity = app.spawn((Mesh3d(mesh), skin, place, DynamicSkinnedMeshBounds));
    (entity, joints)
}

/// The world-space box around an entity's box, as Bevy's culling places it; and the box itself.
fn in_world(app: &App, entity: Entity) -> (Vec3, Vec3) {
    let aabb = app.world().get::<Aabb>(entity).unwrap();
    let place = app.world().get::<GlobalTransform>(entity).unwrap().affine();
    let center = place.transform_point3a(aabb.center);
    let radius = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| aabb.relative_radius(&axis.into(), &place.matrix3));
    let radius = Vec3::from_array(radius);
    (Vec3::from(center) - radius, Vec3::from(center) + radius)
}

fn assert_is(app: &App, entity: Entity, (min, max): (Vec3, Vec3)) {
    let (low, high) = in_world(app, entity);
    assert!(
        low.cmple(min).all() && high.cmpge(max).all(),
        "{low} to {high} does not hold {min} to {max}"
    );
    let slack = (low - min).abs().max_element().max((high - max).abs().max_element());
    assert!(slack < 1e-3, "{low} to {high} is not {min} to {max}");
}

#[test]
fn the_box_is_where_joints_and_targets_put_the_mesh() {
    let mut app = app();
    let place = Transform::from_xyz(30.0, -4.0, 0.0).with_scale(Vec3::new(-2.0, 0.5, 10.0));
    let (cube, joints) = spawn(&mut app, boned(&stretching_cube(), |_| 0), [Vec3::X], place);
    settle(&mut app);
    app.update();
    assert_is(&app, cube, (Vec3::new(0.5, -0.5, -0.5), Vec3::new(1.5, 0.5, 0.5)));
    for (weight, y) in [(0.0, 3.0), (2.0, 3.0), (1.0, -7.0)] {
        set_weight(&mut app, cube, weight);
        put(&mut app, joints[0], Transform::from_xyz(0.0, y, 0.0));
        app.update();
        assert_is(
            &app,
            cube,
            (Vec3::new(-0.5, y - 0.5, -0.5), Vec3::new(0.5 + weight, y + 0.5, 0.5)),
        );
    }
    assert!(app.world().get::<MorphCollider>(cube).is_none());
}

#[test]
fn boxes_of_characters_at_rest_are_not_written() {
    let mut app = app();
    // Both entities show one mesh, so one pose serves both.
    let (first, joints) = spawn(&mut app, limb(), [Vec3::ZERO, Vec3::X], Transform::default());
    let mesh = app.world().get::<Mesh3d>(first).unwrap().clone();
    let others = spawn_joints(&mut app, [Vec3::Y, Vec3::X * 3.0]);
    let other = skeleton(&mut app, &others);
    let second = app.spawn((mesh, other));
    settle(&mut app);
    app.update();
    let changed = |app: &App, entity: Entity| app.world().entity(entity).get_ref::<Aabb>().unwrap().last_changed();
    let before = [first, second].map(|entity| changed(&app, entity));
    for _ in 0..3 {
        put(&mut app, joints[1], Transform::from_xyz(1.0, 0.0, 0.0));
        app.update();
    }
    assert_eq!([first, second].map(|entity| changed(&app, entity)), before);
    assert_is(&app, first, (Vec3::splat(-0.5), Vec3::new(1.5, 0.5, 0.5)));
    assert_is(&app, second, (Vec3::splat(-0.5), Vec3::new(3.5, 1.5, 0.5)));
    put(&mut app, joints[1], Transform::from_xyz(2.0, 0.0, 0.0));
    app.update();
    assert_is(&app, first, (Vec3::splat(-0.5), Vec3::new(2.5, 0.5, 0.5)));
    assert_eq!(changed(&app, second), before[1]);
    // The entity's transform moves its box, so the box has to compensate for it.
    put(&mut app, second, Transform::from_xyz(0.0, 0.0, 40.0));
    app.update();
    assert_is(&app, second, (Vec3::splat(-0.5), Vec3::new(3.5, 1.5, 0.5)));
}

#[test]
fn where_a_box_cannot_be_the_mesh_is_never_culled() {
    let mut app = app();
    let flat = Transform::from_scale(Vec3::new(1.0, 0.0, 1.0));
    let (limb, joints) = spawn(&mut app, limb(), [Vec3::ZERO, Vec3::X], flat);
    settle(&mut app);
    let aabb = |app: &App| *app.world().get::<Aabb>(limb).unwrap();
    assert_eq!(aabb(&app).half_extents, Vec3A::INFINITY);
    put(&mut app, limb, Transform::default());
    app.update();
    assert_is(&app, limb, (Vec3::splat(-0.5), Vec3::new(1.5, 0.5, 0.5)));
    // If the joints become unusable, it stays.
    let before = aabb(&app);
    put(&mut app, joints[0], Transform::from_translation(Vec3::NAN));
    app.update();
    assert_eq!(aabb(&app), before);
}

#[test]
fn bevy_keeps_the_box_again_where_the_plugin_no_longer_does() {
    let mut app = app();
    let (limb, joints) = spawn(&mut app, limb(), [Vec3::ZERO, Vec3::X], Transform::default());
    settle(&mut app);
    app.update();
    let is_bevys = |app: &App| app.world().get::<DynamicSkinnedMeshBounds>(limb).is_some();
    assert!(!is_bevys(&app), "both would write it");
    app.insert(limb, NoFrustumCulling);
    app.update();
    assert!(is_bevys(&app));
    app.remove::<NoFrustumCulling>(limb);
    app.update();
    app.update();
    put(&mut app, joints[1], Transform::from_xyz(4.0, 0.0, 0.0));
    app.update();
    assert!(!is_bevys(&app));
    assert_is(&app, limb, (Vec3::splat(-0.5), Vec3::new(4.5, 0.5, 0.5)));
    // Replaces it by a mesh without joints: it gets its own box, in its own space.
    let skin = app.world_mut().entity_mut(limb).take::<SkinnedMesh>().unwrap();
    put(&mut app, limb, Transform::from_xyz(0.0, 6.0, 0.0));
    app.update();
    app.update();
    assert!(is_bevys(&app));
    assert_is(&app, limb, (Vec3::new(-0.5, 5.5, -0.5), Vec3::new(0.5, 6.5, 0.5)));
    app.insert(limb, skin);
    settle(&mut app);
    app.update();
    assert_is(&app, limb, (Vec3::splat(-0.5), Vec3::new(4.5, 0.5, 0.5)));
}
