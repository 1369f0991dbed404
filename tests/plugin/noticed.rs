//! A run looks only at colliders that changed. Here a single thing changes in a crowd at rest, and the next run must notice it.

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;

use crate::support::{
    Edits, add_mesh, app, cube, diagnostics, fixed_app, move_to, settle, spawn, stretching_cube, touches,
};

/// Near enough to touch the first cube, and too far away.
const NEAR: f32 = 0.8;
const FAR: f32 = 1.5;

/// A crowd at rest: two cubes, the second at `x`, and others far away from all, so that two are only a few of them.
fn at_rest(mut app: App, x: f32) -> (App, [Entity; 2]) {
    let mesh = add_mesh(&mut app, &stretching_cube());
    let [a, b] = [0.0, x].map(|x| spawn(&mut app, &mesh, x));
    for i in 0..8 {
        spawn(&mut app, &mesh, 20.0 + 10.0 * i as f32);
    }
    settle(&mut app);
    // In a fixed schedule, the first runs come later.
    (0..8).for_each(|_| app.update());
    rest(&mut app);
    (app, [a, b])
}

/// Runs frames in which nothing happens.
fn rest(app: &mut App) {
    for _ in 0..4 {
        app.update();
    }
    let last = diagnostics(app);
    assert_eq!(last.stats, default(), "the crowd does not rest");
    assert_eq!(last.skipped_unchanged, last.candidate_pairs);
}

fn shared_weights(weight: f32) -> MorphWeights {
    MorphWeights::new(vec![weight], None).expect("one weight is not too many")
}

#[test]
fn weights_of_another_entity() {
    let (mut app, [a, b]) = at_rest(app(), FAR);
    let [first, second] = [0.0, 1.0].map(|weight| app.spawn(shared_weights(weight)));
    app.insert(a, MeshMorphWeights::Reference(first));
    rest(&mut app);
    assert!(!touches(&app, a, b));

    // They change in place.
    let set = |app: &mut App, weight| {
        let mut weights = app.world_mut().get_mut::<MorphWeights>(first).unwrap();
        weights.weights_mut()[0] = weight;
    };
    for (weight, is_touching) in [(1.0, true), (0.0, false)] {
        set(&mut app, weight);
        app.update();
        assert_eq!(touches(&app, a, b), is_touching, "{weight}");
        rest(&mut app);
    }
    // They are replaced.
    app.insert(first, shared_weights(1.0));
    app.update();
    assert!(touches(&app, a, b));
    app.insert(first, shared_weights(0.0));
    rest(&mut app);
    // The collider refers to another entity.
    *app.world_mut().get_mut::<MeshMorphWeights>(a).unwrap() = MeshMorphWeights::Reference(second);
    app.update();
    assert!(touches(&app, a, b));
    rest(&mut app);
    // It has none any more, so it is at rest.
    app.remove::<MeshMorphWeights>(a);
    app.update();
    assert!(!touches(&app, a, b));
}

#[test]
fn weights_that_come_while_the_ones_of_others_go() {
    let (mut app, [a, b]) = at_rest(app(), FAR);
    let source = app.spawn(shared_weights(0.0));
    app.insert(a, MeshMorphWeights::Reference(source));
    rest(&mut app);
    // Another entity takes the place of the first in its table.
    app.world_mut().despawn(source);
    let other = app.spawn(shared_weights(1.0));
    app.insert(a, MeshMorphWeights::Reference(other));
    app.update();
    assert!(touches(&app, a, b));
}

#[test]
fn transforms_of_a_collider_and_of_its_parent() {
    let (mut app, [a, b]) = at_rest(app(), FAR);
    for (x, is_touching) in [(NEAR, true), (FAR, false)] {
        app.world_mut().get_mut::<Transform>(b).unwrap().translation.x = x;
        app.update();
        assert_eq!(touches(&app, a, b), is_touching, "{x}");
        rest(&mut app);
    }
    let parent = app.spawn(Transform::default());
    app.insert(b, ChildOf(parent));
    rest(&mut app);
    app.world_mut().get_mut::<Transform>(parent).unwrap().translation.x = NEAR - FAR;
    app.update();
    assert!(touches(&app, a, b));
}

#[test]
fn layers_that_come_change_and_go() {
    let (mut app, [a, b]) = at_rest(app(), NEAR);
    assert!(touches(&app, a, b));
    app.insert(b, MorphCollisionLayers::NONE);
    app.update();
    assert!(!touches(&app, a, b));
    rest(&mut app);
    for (layers, is_touching) in [(MorphCollisionLayers::ALL, true), (MorphCollisionLayers::NONE, false)] {
        *app.world_mut().get_mut::<MorphCollisionLayers>(b).unwrap() = layers;
        app.update();
        assert_eq!(touches(&app, a, b), is_touching, "{layers:?}");
        rest(&mut app);
    }
    app.remove::<MorphCollisionLayers>(b);
    app.update();
    assert!(touches(&app, a, b));
}

#[test]
fn components_removed_and_added_in_one_frame() {
    let (mut app, [a, b]) = at_rest(app(), NEAR);
    app.insert(b, MorphCollisionLayers::ALL);
    rest(&mut app);
    // The entity moves to another table and back.
    app.remove::<MorphCollisionLayers>(b);
    app.insert(b, MorphCollisionLayers::NONE);
    app.update();
    assert!(!touches(&app, a, b));
    app.remove::<MorphCollisionLayers>(b);
    rest(&mut app);
    assert!(touches(&app, a, b));
    // Its state is gone with the collider, also if the new one is equal.
    let collider = *app.world().get::<MorphCollider>(b).unwrap();
    app.remove::<MorphCollider>(b);
    app.insert(b, collider);
    app.update();
    app.update();
    assert!(touches(&app, a, b));
    rest(&mut app);
    assert_eq!(diagnostics(&app).colliders, 10);
    app.remove::<MorphCollider>(b);
    app.insert(b, MorphCollider::new(MorphCollisionMode::Contacts));
    app.update();
    app.update();
    let contact = app.contact(a, b).expect("they touch");
    assert_eq!(contact.mode, MorphCollisionMode::Contacts);
    assert!(!contact.points.is_empty());
}

#[test]
fn settings_of_a_collider() {
    let (mut app, [a, b]) = at_rest(app(), NEAR);
    let edit = |app: &mut App, edit: fn(&mut MorphCollider)| {
        edit(&mut app.world_mut().get_mut::<MorphCollider>(b).unwrap());
        app.update();
    };
    edit(&mut app, |collider| collider.mode = MorphCollisionMode::Contacts);
    assert!(!app.contact(a, b).expect("they touch").points.is_empty());
    rest(&mut app);
    move_to(&mut app, b, FAR);
    rest(&mut app);
    assert!(!touches(&app, a, b));
    edit(&mut app, |collider| collider.margin = 0.6);
    let contact = app.contact(a, b).expect("their margins touch");
    assert!((contact.distance - 0.5).abs() < 1e-5, "{}", contact.distance);
    rest(&mut app);
    edit(&mut app, |collider| collider.margin = 0.0);
    assert!(!touches(&app, a, b));
}

#[test]
fn a_tree_that_gets_ready() {
    let (mut app, [a, b]) = at_rest(app(), FAR);
    let wide = add_mesh(&mut app, &rigid::box_mesh(Vec3::new(1.2, 0.5, 0.5)));
    app.insert(a, Mesh3d(wide.clone()));
    settle(&mut app);
    assert!(touches(&app, a, b));
    rest(&mut app);
    // The mesh itself is another one.
    let narrow = crate::support::bevy_mesh(&cube());
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&wide).expect("the mesh is loaded") = narrow;
    app.update();
    settle(&mut app);
    app.update();
    assert!(!touches(&app, a, b));
}

#[test]
fn entities_that_take_the_rows_of_others() {
    let (mut app, [a, b]) = at_rest(app(), FAR);
    let mesh = app.world().get::<Mesh3d>(b).unwrap().0.clone();
    let mut last = b;
    for (x, is_touching) in [(NEAR, true), (FAR, false), (-NEAR, true)] {
        app.world_mut().despawn(last);
        // It has the index of the one before, and the same components.
        last = spawn(&mut app, &mesh, x);
        app.update();
        app.update();
        assert_eq!(touches(&app, a, last), is_touching, "{x}");
        assert_eq!(
            app.world().resource::<MorphCollisions>().len(),
            usize::from(is_touching)
        );
        rest(&mut app);
        assert_eq!(diagnostics(&app).colliders, 10);
    }
    // Its row is filled with the last one of the table.
    app.world_mut().despawn(a);
    app.update();
    assert!(app.world().resource::<MorphCollisions>().is_empty());
    assert_eq!(diagnostics(&app).colliders, 9);
    let other = spawn(&mut app, &mesh, 0.0);
    app.update();
    app.update();
    assert!(touches(&app, other, last));
}

#[test]
fn changes_while_no_runs_happen() {
    let (mut app, [a, b]) = at_rest(app(), FAR);
    let source = app.spawn(shared_weights(0.0));
    app.insert(a, MeshMorphWeights::Reference(source));
    rest(&mut app);
    let pause = |app: &mut App, paused| app.settings().paused = paused;
    // A transform, layers and weights: each in the first of several frames without a run.
    type Change = fn(&mut World, Entity, Entity);
    let changes: [(Change, bool); 4] = [
        (
            |world, b, _| world.get_mut::<Transform>(b).unwrap().translation.x = NEAR,
            true,
        ),
        (
            |world, b, _| _ = world.entity_mut(b).insert(MorphCollisionLayers::NONE),
            false,
        ),
        (
            |world, b, _| {
                world.get_mut::<Transform>(b).unwrap().translation.x = FAR;
                *world.get_mut::<MorphCollisionLayers>(b).unwrap() = MorphCollisionLayers::ALL;
            },
            false,
        ),
        (
            |world, _, source| world.get_mut::<MorphWeights>(source).unwrap().weights_mut()[0] = 1.0,
            true,
        ),
    ];
    for (number, (change, is_touching)) in changes.into_iter().enumerate() {
        pause(&mut app, true);
        app.update();
        let before = touches(&app, a, b);
        change(app.world_mut(), b, source);
        for _ in 0..4 {
            app.update();
            assert_eq!(touches(&app, a, b), before, "change {number}");
        }
        pause(&mut app, false);
        app.update();
        assert_eq!(touches(&app, a, b), is_touching, "change {number}");
        rest(&mut app);
    }
}

#[test]
fn changes_in_frames_without_a_tick() {
    // The run is in a fixed schedule, every third frame.
    let (mut app, [a, b]) = at_rest(fixed_app(3, 1), FAR);
    let source = app.spawn(shared_weights(0.0));
    app.insert(a, MeshMorphWeights::Reference(source));
    let tick = |app: &mut App| (0..3).for_each(|_| app.update());
    tick(&mut app);
    tick(&mut app);
    for phase in 0..3 {
        for (x, weight, is_touching) in [
            (NEAR, 0.0, true),
            (FAR, 0.0, false),
            (FAR, 1.0, true),
            (FAR, 0.0, false),
        ] {
            app.world_mut().get_mut::<Transform>(b).unwrap().translation.x = x;
            let mut weights = app.world_mut().get_mut::<MorphWeights>(source).unwrap();
            weights.weights_mut()[0] = weight;
            tick(&mut app);
            assert_eq!(touches(&app, a, b), is_touching, "{x}, {weight}, phase {phase}");
        }
        app.update();
    }
}
