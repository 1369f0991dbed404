//! The plugins as an app adds them.

use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy_morph_collision::plugins::MorphCollisionSchedule;
use bevy_morph_collision::prelude::*;

use crate::log::{Errors, start};
use crate::support::{settle, touches};

/// An app with Bevy's plugins only, and two cubes that overlap.
fn without_the_plugin(with: MorphCollider) -> (App, [Entity; 2]) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), MeshPlugin));
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(Cuboid::default());
    let cubes = [0.0, 0.8].map(|x| {
        let cube = (Mesh3d(mesh.clone()), Transform::from_xyz(x, 0.0, 0.0), with);
        app.world_mut().spawn(cube).id()
    });
    (app, cubes)
}

#[test]
fn the_plugin_and_the_group_are_added_by_their_names() {
    for group in [false, true] {
        let (mut app, [a, b]) = without_the_plugin(MorphCollider::default());
        if group {
            app.add_plugins(MorphPlugins);
        } else {
            app.add_plugins(MorphCollisionPlugin);
        }
        start(&mut app);
        settle(&mut app);
        // They were there before the plugin.
        assert!(touches(&app, a, b), "group: {group}");
        let mesh = app.world().get::<Mesh3d>(a).cloned().unwrap();
        let later = (mesh, Transform::from_xyz(-0.8, 0.0, 0.0), MorphCollider::default());
        let later = app.world_mut().spawn(later).id();
        settle(&mut app);
        assert!(touches(&app, a, later), "group: {group}");
    }
}

#[test]
fn a_mesh_that_lists_its_self_collisions_may_come_before_the_plugin() {
    let (mut app, [a, _]) = without_the_plugin(MorphCollider::default());
    app.world_mut().entity_mut(a).insert(MorphSelfCollisions::default());
    app.add_plugins(MorphPlugins);
    start(&mut app);
    settle(&mut app);
    // A cube intersects itself nowhere, and that is known.
    assert!(app.world().get::<MorphSelfCollisions>(a).unwrap().regions().is_empty());
}

#[test]
fn the_group_is_changed_like_any_other() {
    let (mut app, [a, b]) = without_the_plugin(MorphCollider::default());
    app.add_plugins(MorphPlugins.set(MorphCollisionPlugin).disable::<MorphBoundsPlugin>());
    assert!(!app.is_plugin_added::<MorphBoundsPlugin>());
    start(&mut app);
    settle(&mut app);
    assert!(touches(&app, a, b));
}

#[test]
fn another_schedule_is_chosen_with_the_group_or_the_plugin() {
    let counts = [0, 1].map(|which| {
        let (mut app, [a, b]) = without_the_plugin(MorphCollider::default());
        if which == 0 {
            app.add_plugins(MorphPlugins.in_schedule(FixedPostUpdate));
        } else {
            app.add_plugins(MorphCollisionPlugin.in_schedule(FixedPostUpdate));
        }
        // On a slow machine, the schedule would run by itself.
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(
            std::time::Duration::ZERO,
        ));
        start(&mut app);
        settle(&mut app);
        let before = touches(&app, a, b);
        app.world_mut().run_schedule(FixedPostUpdate);
        (before, touches(&app, a, b))
    });
    assert_eq!(counts, [(false, true); 2]);
}

#[test]
fn a_schedule_that_is_chosen_too_late_is_an_error_in_the_log() {
    let (mut app, _) = without_the_plugin(MorphCollider::default());
    Errors::collect(|errors| {
        let (schedule, plugin): (MorphCollisionSchedule, _) = MorphCollisionPlugin.in_schedule(FixedPostUpdate);
        app.add_plugins(plugin).add_plugins(schedule);
        let errors = errors.take();
        assert!(
            errors.len() == 1 && errors[0].contains("MorphCollisionSchedule"),
            "{errors:?}"
        );
    });
}
