//! All plugins together, with and without the plugins that they work with.

use bevy::diagnostic::DiagnosticsStore;
use bevy::gizmos::GizmoPlugin;
use bevy::gizmos::config::GizmoConfigStore;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::{NoUserData, RapierPhysicsPlugin};

use crate::log::{Errors, start};
use crate::support::{add_mesh, cube, plain_app, settle, spawn, touches};

/// Runs a test with an app and the errors and warnings that it logs.
fn with_app(plugins: impl FnOnce(&mut App), test: impl FnOnce(&mut App, Vec<String>)) {
    Errors::collect(|errors| {
        let mut app = plain_app();
        plugins(&mut app);
        start(&mut app);
        let mesh = add_mesh(&mut app, &cube());
        let [a, b] = [0.0, 0.8].map(|x| spawn(&mut app, &mesh, x));
        settle(&mut app);
        assert!(touches(&app, a, b));
        let logged = errors.take().into_iter().chain(errors.take_warnings()).collect();
        test(&mut app, logged);
    });
}

#[test]
fn the_group_works_in_an_app_without_anything_to_see() {
    with_app(
        |app| {
            app.add_plugins(MorphPlugins);
        },
        |app, logged| {
            assert_eq!(logged, [""; 0]);
            assert!(app.is_plugin_added::<MorphBoundsPlugin>() && app.is_plugin_added::<MorphPickingPlugin>());
            let store = app.world().resource::<DiagnosticsStore>();
            assert!(store.get(&MorphCollisionDiagnosticsPlugin::TOUCHING_PAIRS).is_some());
        },
    );
}

#[test]
fn the_group_brings_what_belongs_to_plugins_that_are_there() {
    with_app(
        |app| {
            app.add_plugins((
                GizmoPlugin,
                RapierPhysicsPlugin::<NoUserData>::default(),
                MorphPlugins,
                MorphRapierPlugin,
            ));
        },
        |app, logged| {
            assert_eq!(logged, [""; 0]);
            assert!(app.world().contains_resource::<MorphPhysicsDiagnostics>());
            let store = app.world().resource::<GizmoConfigStore>();
            assert!(store.get_config::<MorphGizmos>().is_some());
        },
    );
}

#[test]
fn physics_may_come_after_the_group() {
    with_app(
        |app| {
            app.add_plugins((
                MorphPlugins,
                MorphRapierPlugin,
                RapierPhysicsPlugin::<NoUserData>::default(),
            ));
        },
        |app, logged| {
            assert_eq!(logged, [""; 0]);
            assert!(app.world().contains_resource::<MorphPhysicsDiagnostics>());
        },
    );
}

#[test]
fn the_group_runs_in_other_schedules_and_without_some_plugins() {
    #[derive(Resource, Default)]
    struct Runs(usize);
    let mut app = plain_app();
    app.add_plugins(
        MorphPlugins
            .in_schedule(FixedPostUpdate)
            .build()
            .disable::<MorphGizmosPlugin>(),
    );
    let step = Time::<Fixed>::default().timestep();
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(step / 2));
    app.init_resource::<Runs>()
        .add_systems(Last, |run: Res<MorphCollisionDiagnostics>, mut runs: ResMut<Runs>| {
            runs.0 += usize::from(run.is_changed());
        });
    start(&mut app);
    assert!(!app.is_plugin_added::<MorphGizmosPlugin>());
    for _ in 0..20 {
        app.update();
    }
    let runs = app.world().resource::<Runs>().0;
    assert!((9..=11).contains(&runs), "{runs} runs in 20 frames");
}

#[test]
fn one_component_for_physics_takes_effect_in_each_engine() {
    with_app(
        |app| {
            app.add_plugins((
                RapierPhysicsPlugin::<NoUserData>::default(),
                avian3d::prelude::PhysicsPlugins::default(),
                MorphPlugins,
                MorphRapierPlugin,
                bevy_morph_avian::MorphAvianPlugin,
            ))
            .insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(
                std::time::Duration::from_millis(20),
            ));
        },
        |app, logged| {
            assert_eq!(logged, [""; 0]);
            let mesh = add_mesh(app, &cube());
            let surface = (Mesh3d(mesh), MorphPhysicsCollider::default());
            let surface = app.world_mut().spawn(surface).id();
            settle(app);
            for _ in 0..3 {
                app.update();
            }
            let surface = app.world().entity(surface);
            assert!(surface.contains::<bevy_rapier3d::prelude::Collider>());
            assert!(surface.contains::<avian3d::prelude::Collider>());
        },
    );
}
