//! Scenes that make no colliders, or fewer than wanted.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::world_serialization::WorldAsset;
use bevy_morph_collision::prelude::*;

use super::{PATIENCE, files, is_fine, load, only_warning, run, says, spawn_scene, warning_about, with_app};
use crate::support::{Edits, add_mesh, cube, stretching_cube};

/// The warning about the scene of a file, logged as soon as the scene is spawned.
fn warning_about_file(file: &str, scene: MorphColliderScene) -> String {
    let (_folder, path) = files();
    let mut warning = None;
    with_app(&path, |app, errors| {
        let root = spawn_scene(app, file, scene);
        load(app, root);
        let warnings = errors.take_warnings();
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        run(app, PATIENCE);
        assert_eq!((errors.take_warnings(), errors.take()), (vec![], vec![]), "once");
        warning = warnings.into_iter().next();
    });
    warning.unwrap()
}

fn named(names: &[&str]) -> MorphColliderScene {
    MorphColliderScene {
        only_named: names.iter().map(|&name| name.into()).collect(),
        ..default()
    }
}

fn with_rigid(scene: MorphColliderScene) -> MorphColliderScene {
    MorphColliderScene {
        only_deforming: false,
        ..scene
    }
}

#[test]
fn a_scene_of_rigid_meshes_says_how_to_include_them() {
    let warning = warning_about_file("rigid.glb#Scene0", MorphColliderScene::default());
    says(
        &warning,
        &[
            "`Boss`",
            "rigid.glb#Scene0",
            "morph targets or joints",
            "`MorphColliderScene::only_deforming` to false",
        ],
    );
    let (_folder, path) = files();
    with_app(&path, |app, errors| {
        let root = spawn_scene(app, "rigid.glb#Scene0", with_rigid(default()));
        load(app, root);
        run(app, PATIENCE);
        assert_eq!((errors.take_warnings(), errors.take()), (vec![], vec![]));
        // Editing it into the same mistake is told, too.
        app.world_mut()
            .get_mut::<MorphColliderScene>(root)
            .unwrap()
            .only_deforming = true;
        says(&only_warning(app, errors), &["rigid.glb#Scene0"]);
    });
}

#[test]
fn a_name_that_no_mesh_has_is_told_with_the_names_that_there_are() {
    let (_folder, path) = files();
    let mut known = String::new();
    with_app(&path, |app, _| {
        let root = spawn_scene(app, "morphs.glb#Scene0", MorphColliderScene::default());
        load(app, root);
        let mut parts = app.world_mut().query_filtered::<&Name, With<MorphCollider>>();
        known = parts.single(app.world()).unwrap().to_string();
    });
    let warning = warning_about_file("morphs.glb#Scene0", named(&["Jaw", &known, "Eye"]));
    says(
        &warning,
        &[
            "`only_named`".trim_matches('`'),
            "morphs.glb#Scene0",
            "`Jaw`, `Eye`",
            &format!("`{known}`"),
        ],
    );
}

#[test]
fn names_of_rigid_meshes_only_are_told() {
    let warning = warning_about(|app| {
        let [rigid, morphs] = [cube(), stretching_cube()].map(|mesh| add_mesh(app, &mesh));
        let weights = MeshMorphWeights::Value { weights: vec![0.0] };
        let scene = named(&["Sword", "Arm"]);
        let sword = (Name::new("Sword"), children![Mesh3d(rigid)]);
        let arm = (Name::new("Arm"), children![(Mesh3d(morphs), weights)]);
        app.spawn((Name::new("Knight"), scene, children![sword, arm]));
    });
    says(
        &warning,
        &[
            "`Knight`",
            "no colliders of `Sword`,",
            "`MorphColliderScene::only_deforming` to false",
        ],
    );
    // A collider of the game's own is a part.
    is_fine(|app| {
        let rigid = add_mesh(app, &cube());
        let sword = (Name::new("Sword"), Mesh3d(rigid), MorphCollider::default());
        app.spawn((named(&["Sword"]), children![sword]));
    });
}

#[test]
fn a_scene_without_meshes_is_told_after_some_time() {
    let warning = warning_about(|app| {
        app.spawn((Name::new("Spawner"), MorphColliderScene::default()));
    });
    says(&warning, &["`Spawner`", "no meshes at or below", "`WorldAssetRoot`"]);
    // A scene below it may bring them.
    is_fine(|app| {
        let reserved = app.world().resource::<Assets<WorldAsset>>().reserve_handle();
        let root = (MorphColliderScene::default(), children![WorldAssetRoot(reserved)]);
        app.spawn(root);
    });
    is_fine(|app| {
        let root = app.spawn(MorphColliderScene::default());
        run(app, 250);
        let mesh = add_mesh(app, &stretching_cube());
        let weights = MeshMorphWeights::Value { weights: vec![0.0] };
        app.spawn((Mesh3d(mesh), weights, ChildOf(root)));
    });
}

#[test]
fn many_names_are_cut_short() {
    let warning = warning_about(|app| {
        let root = app.spawn(with_rigid(named(&["Head"])));
        let mesh = add_mesh(app, &cube());
        for i in 0..50 {
            let bone = (Name::new(format!("Bone {i:02}")), Mesh3d(mesh.clone()), ChildOf(root));
            app.spawn(bone);
        }
    });
    says(&warning, &["`Head`", "`Bone 00`, `Bone 01`", "`Bone 19` and 30 more"]);
}
