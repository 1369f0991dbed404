//! Trees that are being built, or are gone, when the plugin goes back.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::support::{Edits, Messages, add_mesh, app, cube, settle, spawn, touches, two_cubes};

/// The pairs that started and ended since the last call.
fn read(messages: &mut Messages, app: &App) -> (usize, usize) {
    let (starts, ends) = messages.read(app);
    (starts.len(), ends.len())
}

#[test]
fn a_tree_that_is_ready_since_then_is_used_at_once() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let cubes = [0.0, 0.5].map(|x| spawn(&mut app, &mesh, x));
    // Nothing collides yet.
    MorphCollisionState::save(app.world_mut());
    settle(&mut app);
    let mut messages = Messages::default();
    assert_eq!(read(&mut messages, &app), (1, 0));
    MorphCollisionState::restore(app.world_mut());
    assert!(!touches(&app, cubes[0], cubes[1]));
    app.update();
    assert_eq!(read(&mut messages, &app), (1, 0));
    assert!(touches(&app, cubes[0], cubes[1]));
}

#[test]
fn contacts_of_a_mesh_that_is_gone_since_then_end() {
    let (mut app, [a, b]) = two_cubes(0.5);
    let mut messages = Messages::default();
    read(&mut messages, &app);
    MorphCollisionState::save(app.world_mut());
    let mesh = app.world().get::<Mesh3d>(a).unwrap().0.clone();
    app.world_mut().resource_mut::<Assets<Mesh>>().remove(mesh.id());
    let mut ends = 0;
    for _ in 0..3 {
        app.update();
        ends += read(&mut messages, &app).1;
    }
    assert_eq!(ends, 1);
    MorphCollisionState::restore(app.world_mut());
    assert!(touches(&app, a, b));
    app.update();
    assert_eq!(read(&mut messages, &app), (0, 1));
}

#[test]
fn without_a_saved_state_it_goes_back_to_before_the_first_run() {
    let (mut app, [a, b]) = two_cubes(0.5);
    let mut messages = Messages::default();
    read(&mut messages, &app);
    MorphCollisionState::restore(app.world_mut());
    assert!(!touches(&app, a, b));
    app.update();
    assert_eq!(read(&mut messages, &app), (1, 0));
    // Without the plugin, both systems do nothing.
    let mut world = World::new();
    MorphCollisionState::save(&mut world);
    MorphCollisionState::restore(&mut world);
    assert!(!world.contains_resource::<MorphCollisionState>());
}

#[test]
fn messages_that_nobody_has_read_are_dropped_and_sent_again() {
    let (mut app, [a, _]) = two_cubes(0.5);
    let mut messages = Messages::default();
    read(&mut messages, &app);
    MorphCollisionState::save(app.world_mut());
    app.insert(a, Transform::from_xyz(9.0, 0.0, 0.0));
    app.update();
    MorphCollisionState::restore(app.world_mut());
    assert_eq!(read(&mut messages, &app), (0, 0));
    app.update();
    assert_eq!(read(&mut messages, &app), (0, 1));
}
