//! One tree per mesh asset, for as long as the mesh stays the same.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::morph_collision::{MorphBvh, Pose};
use bevy_morph_collision::prelude::*;

use crate::log::{Errors, start};
use crate::support::{
    Edits, add_mesh, bevy_mesh, cube, diagnostics, fixed_app, move_to, settle, spawn, stretching_cube, touches,
    two_cubes,
};
use morph_collision_models::generated::rigid;

fn mesh_of(app: &App, entity: Entity) -> AssetId<Mesh> {
    app.world().get::<Mesh3d>(entity).expect("it has a mesh").id()
}

pub(crate) fn replace(app: &mut App, id: AssetId<Mesh>, mesh: Mesh) {
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    meshes.insert(id, mesh).expect("the mesh was there");
}

#[test]
fn instances_of_a_mesh_share_one_tree() {
    let (mut app, [a, b]) = two_cubes(0.8);
    assert_eq!(app.world().resource::<MorphTrees>().iter().count(), 1);
    let tree = app.world().resource::<MorphTrees>().get(mesh_of(&app, a)).cloned();
    let tree = tree.expect("the tree is ready");
    // One here, one in the resource, one in each instance.
    assert_eq!(Arc::strong_count(&tree), 4);
    app.world_mut().despawn(b);
    assert_eq!(Arc::strong_count(&tree), 3);
}

#[test]
fn a_modified_mesh_gets_a_new_tree() {
    let (mut app, [a, b]) = two_cubes(1.5);
    assert!(!touches(&app, a, b));
    let mesh = mesh_of(&app, a);
    replace(&mut app, mesh, bevy_mesh(&rigid::box_mesh(Vec3::splat(0.9))));
    settle(&mut app);
    assert!(touches(&app, a, b));
    assert_eq!(app.world().resource::<MorphTrees>().iter().count(), 1);
}

#[test]
fn a_mesh_may_come_back_with_other_targets() {
    let (mut app, [a, b]) = two_cubes(1.2);
    let mesh = mesh_of(&app, a);
    replace(&mut app, mesh, bevy_mesh(&stretching_cube()));
    settle(&mut app);
    assert!(!touches(&app, a, b));
    crate::support::set_weight(&mut app, a, 1.0);
    app.update();
    assert!(touches(&app, a, b));
}

#[test]
fn a_mesh_that_breaks_keeps_its_last_good_tree() {
    Errors::collect(|errors| {
        let (mut app, [a, b]) = two_cubes(0.8);
        let mesh = mesh_of(&app, a);
        let mut broken = bevy_mesh(&cube());
        broken.insert_attribute(Mesh::ATTRIBUTE_POSITION, vec![Vec3::NAN; 8]);
        replace(&mut app, mesh, broken);
        settle(&mut app);
        assert!(touches(&app, a, b));
        assert!(app.world().resource::<MorphTrees>().error(mesh).is_some());
        let logged = errors.take();
        assert_eq!(logged.len(), 1);
        assert!(logged[0].contains("last good"), "{logged:?}");

        replace(&mut app, mesh, bevy_mesh(&cube()));
        settle(&mut app);
        assert!(app.world().resource::<MorphTrees>().error(mesh).is_none());
    });
}

#[test]
fn a_removed_mesh_takes_its_tree_and_colliders_along() {
    let (mut app, [a, b]) = two_cubes(0.8);
    let mesh = mesh_of(&app, a);
    app.world_mut().resource_mut::<Assets<Mesh>>().remove(mesh);
    app.update();
    app.update();
    assert!(!touches(&app, a, b));
    assert_eq!(diagnostics(&app).colliders, 0);
    assert_eq!(app.world().resource::<MorphTrees>().iter().count(), 0);
}

#[test]
fn a_mesh_nobody_shows_any_more_is_forgotten() {
    let (mut app, cubes) = two_cubes(0.8);
    for cube in cubes {
        app.world_mut().despawn(cube);
    }
    for _ in 0..3 {
        app.update();
    }
    assert_eq!(app.world().resource::<MorphTrees>().iter().count(), 0);
}

#[test]
fn another_mesh_on_the_same_entity_is_taken_up() {
    let (mut app, [a, b]) = two_cubes(1.2);
    assert!(!touches(&app, a, b));
    let large = add_mesh(&mut app, &rigid::box_mesh(Vec3::splat(1.0)));
    app.insert(a, Mesh3d(large));
    settle(&mut app);
    assert!(touches(&app, a, b));
    app.remove::<Mesh3d>(a);
    app.update();
    assert!(!touches(&app, a, b));
}

#[test]
fn another_mesh_is_taken_up_in_a_fixed_schedule_too() {
    let mut app = fixed_app(1, 1);
    let meshes = [
        cube(),
        rigid::box_mesh(Vec3::splat(0.8)),
        rigid::box_mesh(Vec3::splat(0.9)),
    ];
    let [small, large, larger] = meshes.map(|mesh| add_mesh(&mut app, &mesh));
    let [a, b, c] = [(&small, 0.0), (&small, 1.2), (&larger, 2.5)].map(|(mesh, x)| spawn(&mut app, mesh, x));
    app.insert(c, MorphShape::Ball { radius: 0.1 });
    settle(&mut app);
    assert!(!touches(&app, a, b) && !touches(&app, b, c));
    // The plugin sees both changes in the fixed schedule first, before trees are requested.
    app.insert(a, Mesh3d(large));
    settle(&mut app);
    assert!(touches(&app, a, b));
    app.remove::<MorphShape>(c);
    settle(&mut app);
    assert!(touches(&app, b, c));
}

#[test]
fn a_collider_waits_for_its_mesh() {
    let (mut app, [a, _]) = two_cubes(5.0);
    let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
    let waiting = spawn(&mut app, &handle, 0.5);
    settle(&mut app);
    assert_eq!(diagnostics(&app).colliders, 2);
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    meshes
        .insert(&handle, bevy_mesh(&cube()))
        .expect("the handle is reserved");
    settle(&mut app);
    assert!(touches(&app, a, waiting));
    move_to(&mut app, waiting, 2.5);
    app.update();
    assert_eq!(app.world().resource::<MorphCollisions>().len(), 0);
}

#[test]
fn a_mesh_that_is_modified_every_frame_still_gets_trees() {
    let (mut app, [a, _]) = two_cubes(5.0);
    let mesh = mesh_of(&app, a);
    let reach = |app: &App| {
        app.world()
            .resource::<MorphTrees>()
            .get(mesh)
            .map(|tree| reach_at_rest(tree).to_bits())
    };
    let mut trees = std::collections::HashSet::new();
    let mut size = 0.5;
    // A busy machine builds few trees in many frames.
    for frame in 1..5000 {
        size = 0.5 + 0.001 * (frame % 500) as f32;
        replace(&mut app, mesh, bevy_mesh(&rigid::box_mesh(Vec3::splat(size))));
        app.update();
        trees.extend(reach(&app));
        if trees.len() > 3 {
            break;
        }
    }
    assert!(trees.len() > 3, "{} trees", trees.len());
    settle(&mut app);
    let tree = app.world().resource::<MorphTrees>().get(mesh).unwrap().clone();
    let reach = reach_at_rest(&tree);
    assert!((reach - size).abs() < 1e-4, "the last one is in force: {reach}");
}

/// Settings with a leaf size.
fn leaves_of(leaf_size: u8) -> MorphTreeOptions {
    MorphTreeOptions { leaf_size }
}

fn tree_count(app: &App) -> usize {
    app.world().resource::<MorphTrees>().iter().count()
}

#[test]
fn trees_with_settings_that_nobody_uses_any_more_are_dropped() {
    let (mut app, [a, b]) = two_cubes(0.8);
    for leaf_size in 1..=20 {
        app.insert(a, leaves_of(leaf_size));
        // Changes the settings again both before and after the tree is done.
        match leaf_size % 2 {
            0 => settle(&mut app),
            _ => app.update(),
        }
        let trees = app.world().resource::<MorphTrees>();
        assert!(tree_count(&app) + trees.building() <= 2, "{trees:?} at {leaf_size}");
        assert!(trees.get(mesh_of(&app, a)).is_some(), "the other cube uses it");
    }
    assert!(touches(&app, a, b));
    // Settings of disabled or excluded colliders are used too.
    app.insert(b, (leaves_of(30), MorphColliderDisabled));
    settle(&mut app);
    app.insert(b, bevy::ecs::entity_disabling::Disabled);
    app.insert(a, leaves_of(31));
    settle(&mut app);
    assert_eq!(tree_count(&app), 2);
    app.remove::<MorphTreeOptions>(a);
    settle(&mut app);
    assert_eq!(tree_count(&app), 2);
    app.world_mut().despawn(b);
    app.update();
    assert_eq!(tree_count(&app), 1);
}

#[test]
fn the_last_trees_of_a_mesh_stay_for_what_is_spawned_next() {
    let (mut app, [a, b]) = two_cubes(0.8);
    app.insert(b, leaves_of(1));
    settle(&mut app);
    let mesh = app.world().get::<Mesh3d>(a).unwrap().0.clone();
    let trees = |app: &App| {
        let trees = app.world().resource::<MorphTrees>();
        [None, Some(leaves_of(1))].map(|settings| trees.with_options(mesh.id(), settings).map(Arc::as_ptr))
    };
    let before = trees(&app);
    assert!(before.iter().all(Option::is_some));
    for cube in [a, b] {
        app.world_mut().despawn(cube);
    }
    app.update();
    let [a, b] = [0.0, 0.8].map(|x| spawn(&mut app, &mesh, x));
    app.insert(b, leaves_of(1));
    app.update();
    assert!(touches(&app, a, b), "at once");
    assert_eq!(trees(&app), before);
}

#[test]
fn bounds_keep_the_tree_that_they_use() {
    use bevy::camera::visibility::VisibilityPlugin;
    let mut app = morph_collision_workspace::app::headless(&crate::support::assets());
    app.add_plugins((VisibilityPlugin, MorphBoundsPlugin));
    start(&mut app);
    let mesh = add_mesh(&mut app, &stretching_cube());
    let collider = spawn(&mut app, &mesh, 0.0);
    crate::support::set_weight(&mut app, collider, 0.0);
    settle(&mut app);
    app.insert(collider, leaves_of(1));
    settle(&mut app);
    assert_eq!(tree_count(&app), 2);
    crate::support::set_weight(&mut app, collider, 3.0);
    app.update();
    let bounds = app.world().get::<bevy::camera::primitives::Aabb>(collider).unwrap();
    assert!(bounds.max().x >= 3.5, "{bounds:?}");
}

#[test]
fn trees_with_other_settings_share_the_mesh() {
    let (mut app, [a, b]) = two_cubes(0.8);
    let mesh = mesh_of(&app, a);
    // The asset's content no longer matters.
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let taken = meshes.get_mut_untracked(mesh).unwrap().take_gpu_data();
    taken.expect("the data is still there");
    app.insert(b, leaves_of(1));
    settle(&mut app);
    assert!(touches(&app, a, b));
    let trees = app.world().resource::<MorphTrees>();
    let [default, other] = [None, Some(leaves_of(1))].map(|settings| trees.with_options(mesh, settings).unwrap());
    assert!(!Arc::ptr_eq(default, other));
    assert!(Arc::ptr_eq(default.model(), other.model()));
}

/// How far a mesh at rest reaches.
fn reach_at_rest(tree: &Arc<MorphBvh>) -> f32 {
    Pose::new(tree.clone()).bounds().max.x
}
