//! Missing plugins are named.

use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::{run, says};
use crate::log::{Errors, start};
use crate::support::{add_mesh, cube, settle, spawn, touches};

/// What an app logs that is updated a few times, and how.
fn logged(plugins: impl FnOnce(&mut App)) -> (Vec<String>, Vec<String>) {
    let mut logged = Default::default();
    Errors::collect(|errors| {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins);
        plugins(&mut app);
        start(&mut app);
        run(&mut app, 5);
        logged = (errors.take(), errors.take_warnings());
    });
    logged
}

#[test]
fn an_app_without_assets_or_meshes_names_the_plugin_and_runs_on() {
    let (errors, warnings) = logged(|app| {
        app.add_plugins((TransformPlugin, MorphPlugins));
    });
    assert_eq!((errors.len(), warnings.len()), (1, 0), "{errors:?} {warnings:?}");
    says(
        &errors[0],
        &[
            "nothing collides",
            "`AssetPlugin`, and `MeshPlugin` after it",
            "`DefaultPlugins`",
        ],
    );
    let (errors, warnings) = logged(|app| {
        app.add_plugins((TransformPlugin, AssetPlugin::default(), MorphBoundsPlugin));
    });
    assert_eq!((errors.len(), warnings.len()), (1, 0), "{errors:?} {warnings:?}");
    says(&errors[0], &["the app lacks `MeshPlugin`", "`DefaultPlugins`"]);
}

#[test]
fn an_app_without_transforms_names_the_plugin() {
    let (errors, warnings) = logged(|app| {
        app.add_plugins((AssetPlugin::default(), MeshPlugin, MorphPlugins));
    });
    assert_eq!((errors.len(), warnings.len()), (0, 1), "{errors:?} {warnings:?}");
    says(
        &warnings[0],
        &["`TransformPlugin` is missing", "at the origin", "`DefaultPlugins`"],
    );
}

#[test]
fn a_scene_that_nobody_spawns_names_the_plugin() {
    let (errors, warnings) = logged(|app| {
        app.add_plugins((TransformPlugin, AssetPlugin::default(), MeshPlugin, MorphPlugins))
            .add_systems(Startup, |mut commands: Commands| {
                let scene = (WorldAssetRoot::default(), MorphColliderScene::default());
                commands.spawn((scene, Name::new("Boss")));
            });
    });
    assert_eq!((errors.len(), warnings.len()), (1, 0), "{errors:?} {warnings:?}");
    says(&errors[0], &["`Boss`", "`WorldSerializationPlugin`"]);
}

#[test]
fn colliders_without_the_collision_plugin_are_told() {
    let (errors, warnings) = logged(|app| {
        app.add_plugins((TransformPlugin, AssetPlugin::default(), MeshPlugin, MorphBoundsPlugin))
            .add_systems(Startup, |mut commands: Commands| {
                commands.spawn(MorphCollider::default());
                commands.spawn(MorphColliderScene::default());
            });
    });
    assert_eq!((errors.len(), warnings.len()), (1, 0), "{errors:?} {warnings:?}");
    says(&errors[0], &["`MorphCollider`", "no effect", "`MorphPlugins`"]);
}

#[test]
fn a_complete_app_logs_nothing_in_any_order() {
    Errors::collect(|errors| {
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            MorphPlugins,
            AssetPlugin::default(),
            MeshPlugin,
            TransformPlugin,
        ));
        start(&mut app);
        let mesh = add_mesh(&mut app, &cube());
        let [a, b] = [0.0, 0.8].map(|x| spawn(&mut app, &mesh, x));
        settle(&mut app);
        assert!(touches(&app, a, b));
        assert_eq!((errors.take(), errors.take_warnings()), (vec![], vec![]));
    });
}

#[test]
#[should_panic(expected = "MorphCollisionPlugin: : plugin was already added")]
fn bevy_names_a_plugin_that_is_added_twice() {
    App::new().add_plugins((MorphPlugins, MorphCollisionPlugin));
}
