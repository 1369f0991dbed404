//! Colliders and scenes report when they are ready.

use std::path::PathBuf;

use bevy::ecs::entity_disabling::Disabled;
use bevy::mesh::Indices;
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy::world_serialization::{WorldAsset, WorldInstanceReady};
use bevy_morph_collision::import::{ImportError, MorphTreeProgress};
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::random::random_blob;
use morph_collision_models::gltf::write::{Appearance, to_glb};
use morph_collision_workspace::app::{headless, update_until};

use crate::log::start;
use crate::support::{
    Edits, add_mesh, app, bevy_mesh, cube, diagnostics, fixed_app, move_to, set_weight, settle, spawn, stretching_cube,
    two_cubes,
};

#[derive(Clone, Debug, PartialEq)]
enum Heard {
    Spawned(Entity),
    Ready(Entity),
    Failed(Entity, ImportError),
    Scene(MorphColliderSceneReady),
}

#[derive(Resource, Default)]
struct Log(Vec<Heard>);

fn listen(app: &mut App) {
    app.init_resource::<Log>()
        .add_observer(|spawned: On<WorldInstanceReady>, mut log: ResMut<Log>| {
            log.0.push(Heard::Spawned(spawned.entity));
        })
        .add_observer(|ready: On<MorphColliderReady>, mut log: ResMut<Log>| log.0.push(Heard::Ready(ready.entity)))
        .add_observer(|failed: On<MorphColliderFailed>, mut log: ResMut<Log>| {
            log.0.push(Heard::Failed(failed.entity, failed.reason.clone()));
        })
        .add_observer(|ready: On<MorphColliderSceneReady>, mut log: ResMut<Log>| log.0.push(Heard::Scene(*ready)));
}

/// The events since the last call.
fn heard(app: &mut App) -> Vec<Heard> {
    std::mem::take(&mut app.world_mut().resource_mut::<Log>().0)
}

fn scene_ready(entity: Entity, parts: u32, failed: u32) -> Heard {
    Heard::Scene(MorphColliderSceneReady { entity, parts, failed })
}

/// A mesh that is refused at once.
fn broken() -> Mesh {
    bevy_mesh(&cube()).with_removed_attribute(Mesh::ATTRIBUTE_POSITION)
}

/// A mesh that is refused in the background.
fn incomplete() -> Mesh {
    bevy_mesh(&cube()).with_inserted_indices(Indices::U32(vec![0, 1, 2, 3]))
}

fn replace(app: &mut App, mesh: &Handle<Mesh>, by: Mesh) {
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    meshes.insert(mesh, by).expect("the mesh was there");
}

/// A file with a head of five parts that morph.
fn head_of_five() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("head.glb");
    let mut mesh = random_blob(1, 3, 4, 0.5);
    let fifth = mesh.triangles.len() as u32 / 5;
    mesh.primitives = (0..5).map(|part| part * fifth..(part + 1) * fifth).collect();
    mesh.triangles.truncate(5 * fifth as usize);
    std::fs::write(&file, to_glb(&mesh, &Appearance::default()).unwrap()).unwrap();
    (folder, file)
}

#[test]
fn a_head_of_five_parts_is_ready_once_after_its_last_tree() {
    let (folder, file) = head_of_five();
    let mut app = headless(folder.path());
    start(&mut app);
    listen(&mut app);
    let scene: Handle<WorldAsset> = app.world().resource::<AssetServer>().load("head.glb#Scene0");
    let root = app.spawn((WorldAssetRoot(scene), MorphColliderScene::default()));
    #[derive(Resource, Default)]
    struct TreesThen(usize);
    app.init_resource::<TreesThen>();
    app.world_mut().entity_mut(root).observe(
        |_: On<MorphColliderSceneReady>, trees: Res<MorphTrees>, mut then: ResMut<TreesThen>| {
            then.0 += trees.iter().count();
        },
    );
    let done = |world: &mut World| {
        Ok(world
            .resource::<Log>()
            .0
            .last()
            .is_some_and(|last| matches!(last, Heard::Scene(_))))
    };
    update_until(&mut app, &file, done).unwrap();
    for _ in 0..5 {
        app.update();
    }
    let mut parts = app.world_mut().query_filtered::<Entity, With<MorphCollider>>();
    let mut parts: Vec<Heard> = parts.iter(app.world()).map(Heard::Ready).collect();
    assert_eq!(parts.len(), 5);
    let mut all = heard(&mut app);
    assert_eq!(all.remove(0), Heard::Spawned(root));
    assert_eq!(all.pop(), Some(scene_ready(root, 5, 0)));
    let key = |heard: &Heard| format!("{heard:?}");
    all.sort_by_key(key);
    parts.sort_by_key(key);
    assert_eq!(all, parts);
    assert_eq!(app.world().resource::<TreesThen>().0, 5);

    // New weights do not repeat the event; a new mesh of a part does.
    let mut weights = app.world_mut().query::<&mut MorphWeights>();
    for mut weights in weights.iter_mut(app.world_mut()) {
        weights.weights_mut()[0] = 0.5;
    }
    app.update();
    assert_eq!(heard(&mut app), []);
    let Heard::Ready(part) = parts[0] else { panic!() };
    let other = add_mesh(&mut app, &cube());
    app.insert(part, Mesh3d(other));
    settle(&mut app);
    assert_eq!(heard(&mut app), [Heard::Ready(part), scene_ready(root, 5, 0)]);
}

#[test]
fn a_collider_is_ready_for_its_first_tree_and_for_each_new_one() {
    let mut app = app();
    listen(&mut app);
    let mesh = add_mesh(&mut app, &stretching_cube());
    let collider = spawn(&mut app, &mesh, 0.0);
    let ready = [Heard::Ready(collider)];
    settle(&mut app);
    assert_eq!(heard(&mut app), ready);
    assert_eq!(diagnostics(&app).colliders, 1);

    set_weight(&mut app, collider, 1.0);
    move_to(&mut app, collider, 3.0);
    settle(&mut app);
    assert_eq!(heard(&mut app), [], "it is the same tree");
    let other = add_mesh(&mut app, &cube());
    app.insert(collider, Mesh3d(other));
    settle(&mut app);
    assert_eq!(heard(&mut app), ready, "another mesh");
    app.insert(collider, Mesh3d(mesh.clone()));
    settle(&mut app);
    assert_eq!(heard(&mut app), ready, "the first one again");
    replace(&mut app, &mesh, bevy_mesh(&cube()));
    settle(&mut app);
    assert_eq!(heard(&mut app), ready, "a modified mesh");
    app.insert(collider, MorphTreeOptions { leaf_size: 1 });
    settle(&mut app);
    assert_eq!(heard(&mut app), ready, "other settings");
    app.remove::<MorphCollider>(collider);
    settle(&mut app);
    assert_eq!(heard(&mut app), []);
    app.insert(collider, MorphCollider::default());
    settle(&mut app);
    assert_eq!(heard(&mut app), ready, "a new collider");
    let second = spawn(&mut app, &mesh, 9.0);
    app.insert(second, MorphTreeOptions { leaf_size: 1 });
    app.update();
    assert_eq!(heard(&mut app), [Heard::Ready(second)], "the tree is there already");
}

#[test]
fn a_mesh_that_cannot_be_used_is_told_with_the_reason() {
    let mut app = app();
    listen(&mut app);
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(broken());
    let good = add_mesh(&mut app, &cube());
    let root = app.spawn(MorphColliderScene {
        only_deforming: false,
        ..default()
    });
    let part = app.spawn((Mesh3d(mesh.clone()), ChildOf(root)));
    let other = app.spawn((Mesh3d(good), ChildOf(root)));
    settle(&mut app);
    let all = heard(&mut app);
    assert_eq!(all.len(), 3, "{all:?}");
    assert!(all.contains(&Heard::Failed(part, ImportError::NoPositions)) && all.contains(&Heard::Ready(other)));
    assert_eq!(all[2], scene_ready(root, 2, 1));
    let progress = app.world().resource::<MorphTrees>().progress();
    assert_eq!((progress.requested, progress.built, progress.failed), (2, 1, 1));

    replace(&mut app, &mesh, incomplete());
    settle(&mut app);
    let failed = Heard::Failed(part, ImportError::IncompleteTriangle(4));
    assert_eq!(
        heard(&mut app),
        [failed, scene_ready(root, 2, 1)],
        "it fails in another way"
    );
    replace(&mut app, &mesh, bevy_mesh(&cube()));
    settle(&mut app);
    assert_eq!(heard(&mut app), [Heard::Ready(part), scene_ready(root, 2, 0)]);
    replace(&mut app, &mesh, broken());
    settle(&mut app);
    let failed = Heard::Failed(part, ImportError::NoPositions);
    assert_eq!(heard(&mut app), [failed, scene_ready(root, 2, 1)]);
    assert_eq!(diagnostics(&app).colliders, 2, "its last good shape stays in force");
}

#[test]
fn a_scene_is_ready_again_when_its_parts_are_others() {
    let mut app = app();
    listen(&mut app);
    let mesh = add_mesh(&mut app, &cube());
    let root = app.spawn(MorphColliderScene::default());
    let [a, b] = [(); 2].map(|()| app.spawn((Mesh3d(mesh.clone()), ChildOf(root))));
    app.insert(b, (Name::new("b"), Disabled));
    settle(&mut app);
    assert_eq!(heard(&mut app), [], "nothing in it deforms");
    let edit = |app: &mut App, edit: fn(&mut MorphColliderScene)| {
        edit(&mut app.world_mut().get_mut::<MorphColliderScene>(root).unwrap());
        settle(app);
        heard(app)
    };
    let all = edit(&mut app, |scene| scene.only_deforming = false);
    let [first, second] = [a.min(b), a.max(b)].map(Heard::Ready);
    assert_eq!(all, [first, second, scene_ready(root, 2, 0)]);
    assert_eq!(
        edit(&mut app, |scene| scene.collider.margin = 0.5),
        [],
        "the same trees"
    );
    let all = edit(&mut app, |scene| scene.only_named = vec!["b".into()]);
    assert_eq!(all, [scene_ready(root, 1, 0)]);
    let all = edit(&mut app, |scene| scene.only_named.clear());
    assert_eq!(all, [Heard::Ready(a), scene_ready(root, 2, 0)]);
}

#[test]
fn a_shape_is_ready_at_once() {
    let mut app = app();
    listen(&mut app);
    let shape = app.spawn(MorphShape::default());
    app.update();
    assert_eq!(heard(&mut app), [Heard::Ready(shape)]);
    app.insert(shape, MorphShape::Ball { radius: 2.0 });
    app.update();
    assert_eq!(heard(&mut app), []);
    let mesh = add_mesh(&mut app, &cube());
    app.insert(shape, Mesh3d(mesh));
    settle(&mut app);
    assert_eq!(heard(&mut app), [], "the shape collides still");
    app.remove::<MorphShape>(shape);
    settle(&mut app);
    assert_eq!(heard(&mut app), [Heard::Ready(shape)]);
}

#[test]
fn readiness_does_not_wait_for_a_run() {
    // A tick comes after sixty frames.
    let mut app = fixed_app(60, 1);
    listen(&mut app);
    app.settings().paused = true;
    let mesh = add_mesh(&mut app, &cube());
    let collider = spawn(&mut app, &mesh, 0.0);
    settle(&mut app);
    assert_eq!(heard(&mut app), [Heard::Ready(collider)]);
}

#[test]
fn progress_counts_what_is_requested_built_and_failed() {
    let (mut app, _) = two_cubes(0.8);
    let progress = |app: &App| app.world().resource::<MorphTrees>().progress();
    let is = |app: &App, expected: (usize, usize, usize)| {
        let MorphTreeProgress {
            requested,
            built,
            failed,
        } = progress(app);
        assert_eq!((requested, built, failed), expected);
    };
    is(&app, (1, 1, 0));
    assert!(progress(&app).is_done());
    let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
    spawn(&mut app, &handle, 5.0);
    settle(&mut app);
    is(&app, (2, 1, 0));
    assert!(!progress(&app).is_done() && progress(&app).fraction() == 0.5);
    replace(&mut app, &handle, broken());
    settle(&mut app);
    is(&app, (2, 1, 1));
    assert!(progress(&app).is_done() && progress(&app).fraction() == 1.0);
    replace(&mut app, &handle, bevy_mesh(&cube()));
    settle(&mut app);
    is(&app, (2, 2, 0));
    assert_eq!(MorphTrees::default().progress().fraction(), 1.0);
}

#[test]
fn other_settings_do_not_hide_that_a_mesh_is_bad() {
    let mut app = app();
    listen(&mut app);
    let mesh = add_mesh(&mut app, &cube());
    let cube = spawn(&mut app, &mesh, 0.0);
    settle(&mut app);
    assert_eq!(heard(&mut app), [Heard::Ready(cube)]);
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let mut bad = meshes.get_mut(&mesh).unwrap();
    bad.remove_attribute(Mesh::ATTRIBUTE_POSITION);
    drop(bad);
    settle(&mut app);
    let failed = heard(&mut app);
    assert!(matches!(failed[..], [Heard::Failed(..)]), "{failed:?}");
    app.settings().tree_options.leaf_size = 3;
    settle(&mut app);
    assert_eq!(heard(&mut app), [], "the last good tree is as good as it was");
    assert_eq!(app.world().resource::<MorphTrees>().progress().failed, 1);
}
