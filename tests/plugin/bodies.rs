//! Colliders that are parts of one body.

use bevy::gltf::Gltf;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::load_gltf;

use crate::support::{
    Edits, Messages, add_mesh, app, assets, cube, diagnostics, settle, spawn, stretching_cube, touches,
};

#[test]
fn parts_of_one_body_collide_with_others_but_not_with_each_other() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let root = app.spawn(MorphColliderScene {
        only_deforming: false,
        ..default()
    });
    let parts = [0.0, 0.5].map(|x| {
        let part = (Mesh3d(mesh.clone()), Transform::from_xyz(x, 0.0, 0.0), ChildOf(root));
        app.spawn(part)
    });
    let other = spawn(&mut app, &mesh, 0.8);
    settle(&mut app);

    let collisions = app.world().resource::<MorphCollisions>();
    assert_eq!(collisions.len(), 2);
    for part in parts {
        let contact = collisions.get(part, other).expect("both parts touch the other body");
        let bodies = [(contact.collider1, contact.body1), (contact.collider2, contact.body2)];
        assert!(bodies.contains(&(part, root)) && bodies.contains(&(other, other)));
    }
}

#[test]
fn the_same_body_named_by_hand_keeps_colliders_apart() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let [a, b] = [0.0, 0.5].map(|x| spawn(&mut app, &mesh, x));
    settle(&mut app);
    assert!(touches(&app, a, b));
    let root = app.world_mut().spawn_empty().id();
    for part in [a, b] {
        app.insert(part, MorphColliderOf { body: root });
    }
    app.update();
    assert!(!touches(&app, a, b));
    app.remove::<MorphColliderOf>(b);
    app.update();
    assert!(touches(&app, a, b), "two bodies again, though nothing moved");
}

#[test]
fn rigid_parts_are_left_out_unless_asked_for() {
    let mut app = app();
    let (rigid, morphing) = (add_mesh(&mut app, &cube()), add_mesh(&mut app, &stretching_cube()));
    let root = app.spawn(MorphColliderScene::default());
    let rigid = app.spawn((Mesh3d(rigid), ChildOf(root)));
    let weights = bevy::mesh::morph::MeshMorphWeights::Value { weights: vec![0.0] };
    let morphing = app.spawn((Mesh3d(morphing), weights, ChildOf(root)));
    settle(&mut app);
    assert!(app.world().get::<MorphCollider>(rigid).is_none());
    assert_eq!(body_of(&app, morphing), Some(root));
    assert_eq!(diagnostics(&app).colliders, 1);
}

#[test]
fn a_mesh_that_comes_into_the_scene_later_becomes_a_part() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let scene = MorphColliderScene {
        only_deforming: false,
        ..default()
    };
    let root = app.spawn(scene);
    let branch = app.spawn(Transform::default());
    let part = app.spawn((Mesh3d(mesh), ChildOf(branch)));
    settle(&mut app);
    assert!(app.world().get::<MorphCollider>(part).is_none());
    app.insert(branch, ChildOf(root));
    app.update();
    assert_eq!(body_of(&app, part), Some(root));
}

/// The body that a collider belongs to.
fn body_of(app: &App, collider: Entity) -> Option<Entity> {
    app.world().get::<MorphColliderOf>(collider).map(|of| of.body)
}

/// Spawns the dolphin's scene from the asset server.
fn spawn_dolphin(app: &mut App, bundle: impl Bundle) -> Entity {
    let gltf = load_gltf(app, &assets().join("dolphin_564.glb")).expect("the dolphin comes with the repository");
    let files = app.world().resource::<Assets<Gltf>>();
    let scene = files.get(&gltf).and_then(|gltf| gltf.default_scene.clone());
    let scene = scene.expect("the dolphin's file has a scene");
    app.spawn((WorldAssetRoot(scene), bundle))
}

fn bodies(app: &mut App) -> Vec<Entity> {
    let mut parts = app
        .world_mut()
        .query_filtered::<&MorphColliderOf, With<MorphCollider>>();
    parts.iter(app.world()).map(|of| of.body).collect()
}

#[test]
fn a_loaded_scene_collides_whether_the_component_comes_before_or_after_it() {
    let mut app = app();
    let early = spawn_dolphin(&mut app, MorphColliderScene::default());
    settle(&mut app);
    assert_eq!(bodies(&mut app), [early]);

    let late = spawn_dolphin(&mut app, Transform::default());
    settle(&mut app);
    assert_eq!(bodies(&mut app), [early]);
    app.insert(
        late,
        MorphColliderScene {
            events: true,
            ..default()
        },
    );
    app.update();
    assert_eq!(diagnostics(&app).touching_pairs, 1, "they are in the same place");
    let mut with_events = app
        .world_mut()
        .query_filtered::<&MorphColliderOf, With<MorphCollisionEventsEnabled>>();
    let with_events: Vec<_> = with_events.iter(app.world()).map(|of| of.body).collect();
    assert_eq!(with_events, [late]);

    let mut messages = Messages::default();
    messages.read(&app);
    app.remove::<MorphColliderScene>(late);
    app.update();
    assert_eq!(bodies(&mut app), [early]);
    assert_eq!(messages.read(&app).1.len(), 1);
}

#[test]
fn a_scene_takes_back_what_it_gave_and_no_more() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let scene = MorphColliderScene {
        only_deforming: false,
        events: true,
        ..default()
    };
    let root = app.spawn(scene);
    let made = app.spawn((Mesh3d(mesh.clone()), ChildOf(root)));
    let own = (
        Mesh3d(mesh.clone()),
        MorphCollider::new(MorphCollisionMode::First),
        ChildOf(root),
    );
    let own = app.spawn(own);
    let hitbox = (MorphShape::Ball { radius: 1.0 }, MorphColliderOf { body: root });
    let hitbox = app.spawn(hitbox);
    settle(&mut app);
    assert!(app.world().get::<MorphCollider>(made).is_some());
    app.remove::<MorphColliderScene>(root);
    app.update();
    let world = app.world();
    assert!(world.get::<MorphCollider>(made).is_none() && world.get::<MorphCollisionEventsEnabled>(made).is_none());
    assert_eq!(
        world.get::<MorphCollider>(own),
        Some(&MorphCollider::new(MorphCollisionMode::First))
    );
    assert_eq!(body_of(&app, own), None);
    assert!(world.get::<MorphCollider>(hitbox).is_some() && body_of(&app, hitbox) == Some(root));
}

#[test]
fn a_part_goes_over_to_the_scene_that_it_is_hung_on() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let scene = || MorphColliderScene {
        only_deforming: false,
        ..default()
    };
    let knights = [0, 1].map(|_| app.spawn(scene()));
    let sword = app.spawn((Mesh3d(mesh), ChildOf(knights[0])));
    settle(&mut app);
    let body = |app: &App| body_of(app, sword);
    assert_eq!(body(&app), Some(knights[0]));
    app.insert(sword, ChildOf(knights[1]));
    app.update();
    assert_eq!(body(&app), Some(knights[1]));
    app.remove::<ChildOf>(sword);
    app.update();
    assert_eq!(body(&app), None);
    assert!(app.world().get::<MorphCollider>(sword).is_none());
}
