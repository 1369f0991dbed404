//! Which meshes form one body if every deforming mesh collides, in levels with several characters.

use bevy::gltf::Gltf;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::load_gltf;

use crate::support::{Edits, add_mesh, app, assets, settle, stretching_cube, touches};

fn collide(app: &mut App) {
    app.settings().every_deforming_mesh = Some(MorphCollider::default());
    settle(app);
}

fn body_of(app: &App, mesh: Entity) -> Entity {
    app.world().get::<MorphColliderOf>(mesh).map_or(mesh, |of| of.body)
}

fn weights() -> MeshMorphWeights {
    MeshMorphWeights::Value { weights: vec![0.0] }
}

/// A morphing cube below another entity.
fn mesh_below(app: &mut App, parent: Entity, x: f32) -> Entity {
    let mesh = add_mesh(app, &stretching_cube());
    let place = Transform::from_xyz(x, 0.0, 0.0);
    app.spawn((Mesh3d(mesh), weights(), place, ChildOf(parent)))
}

#[test]
fn two_gltf_scenes_under_one_root_are_two_bodies() {
    let mut app = app();
    let gltf = load_gltf(&mut app, &assets().join("dolphin_564.glb")).expect("the dolphin comes with the repository");
    let files = app.world().resource::<Assets<Gltf>>();
    let scene = files.get(&gltf).and_then(|gltf| gltf.default_scene.clone());
    let scene = scene.expect("the dolphin's file has a scene");
    let level = app.spawn(Transform::default());
    let dolphins = [0, 1].map(|_| app.spawn((WorldAssetRoot(scene.clone()), ChildOf(level))));
    collide(&mut app);
    let collisions = app.world().resource::<MorphCollisions>();
    assert!(
        collisions.contains_bodies(dolphins[0], dolphins[1]),
        "they are in the same place"
    );
    for dolphin in dolphins {
        assert!(
            app.world()
                .get::<MorphColliders>(dolphin)
                .is_some_and(|parts| !parts.is_empty())
        );
    }
    assert!(app.world().get::<MorphColliders>(level).is_none());
}

/// A character without its own root: joints and two meshes side by side in the level. Each mesh lists different joints.
fn spawn_character(app: &mut App, level: Entity) -> (Entity, [Entity; 2]) {
    let mesh = add_mesh(app, &stretching_cube());
    let world = app.world_mut();
    let armature = world.spawn((Transform::default(), ChildOf(level))).id();
    let hips = world.spawn((Transform::default(), ChildOf(armature))).id();
    let neck = world.spawn((Transform::default(), ChildOf(hips))).id();
    let meshes = [vec![hips, neck], vec![neck]].map(|joints| {
        let skin = SkinnedMesh { joints, ..default() };
        world.spawn((Mesh3d(mesh.clone()), skin, ChildOf(level))).id()
    });
    (hips, meshes)
}

#[test]
fn two_characters_under_one_root_are_two_bodies() {
    let mut app = app();
    let level = app.spawn(Transform::default());
    let (hips, meshes): (Vec<_>, Vec<_>) = [0, 1].map(|_| spawn_character(&mut app, level)).into_iter().unzip();
    collide(&mut app);
    for (hips, meshes) in hips.iter().zip(&meshes) {
        assert_eq!(meshes.map(|mesh| body_of(&app, mesh)), [*hips; 2]);
        assert!(!touches(&app, meshes[0], meshes[1]));
    }
    let collisions = app.world().resource::<MorphCollisions>();
    assert!(collisions.contains_bodies(hips[0], hips[1]));
    assert_eq!(collisions.collisions_between_bodies(hips[0], hips[1]).count(), 4);
}

#[test]
fn meshes_that_share_weights_are_one_body_and_others_are_bodies_of_their_own() {
    let mut app = app();
    let level = app.spawn(Transform::default());
    let shared = MorphWeights::new(vec![0.0], None).expect("one weight is not too many");
    let node = app.spawn((shared, Transform::default(), ChildOf(level)));
    let primitives = [0.0, 0.5].map(|x| mesh_below(&mut app, node, x));
    for primitive in primitives {
        app.insert(primitive, MeshMorphWeights::Reference(node));
    }
    let alone = mesh_below(&mut app, level, 0.8);
    collide(&mut app);
    assert_eq!(primitives.map(|mesh| body_of(&app, mesh)), [node; 2]);
    assert!(!touches(&app, primitives[0], primitives[1]));
    assert_eq!(body_of(&app, alone), alone);
    assert!(touches(&app, alone, primitives[1]));
}

#[test]
fn a_marker_makes_a_body_whenever_it_comes_and_goes() {
    let mut app = app();
    // A level that is a single glTF scene.
    let level = app.spawn(WorldAssetRoot::default());
    let knights = [0, 1].map(|_| app.spawn((Transform::default(), ChildOf(level))));
    let parts = [(0, 0.0), (0, 0.5), (1, 0.7)].map(|(knight, x)| mesh_below(&mut app, knights[knight], x));
    collide(&mut app);
    let bodies = |app: &App| parts.map(|part| body_of(app, part));
    assert_eq!(bodies(&app), [level; 3]);
    for knight in knights {
        app.insert(knight, MorphBodyRoot);
    }
    app.update();
    assert_eq!(bodies(&app), [knights[0], knights[0], knights[1]]);
    assert!(touches(&app, parts[1], parts[2]) && !touches(&app, parts[0], parts[1]));
    // A sword moves to the other knight. A body that the user set stays.
    app.insert(parts[1], ChildOf(knights[1]));
    app.update();
    assert_eq!(bodies(&app), [knights[0], knights[1], knights[1]]);
    let mine = app.world_mut().spawn_empty().id();
    app.insert(parts[0], MorphColliderOf { body: mine });
    for knight in knights {
        app.remove::<MorphBodyRoot>(knight);
    }
    app.update();
    assert_eq!(bodies(&app), [mine, level, level]);
    app.insert(
        knights[1],
        MorphColliderScene {
            only_named: vec!["nobody".into()],
            ..default()
        },
    );
    app.update();
    assert_eq!(bodies(&app), [mine, knights[1], knights[1]], "a scene is a body, too");

    app.settings().every_deforming_mesh = None;
    app.update();
    assert_eq!(bodies(&app), [mine, parts[1], parts[2]], "what was given is taken back");
}

#[test]
fn a_root_that_is_a_mesh_itself_has_no_relationship_to_itself() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let root = (Mesh3d(mesh), weights(), MorphColliderScene::default());
    let root = app.spawn(root);
    let part = mesh_below(&mut app, root, 0.5);
    settle(&mut app);
    assert!(app.world().get::<MorphColliderOf>(root).is_none());
    assert_eq!(body_of(&app, part), root);
    assert!(app.world().get::<MorphCollider>(root).is_some() && !touches(&app, root, part));
    // A part becomes a root and leaves the other body.
    app.insert(part, MorphColliderScene::default());
    app.update();
    assert!(app.world().get::<MorphColliderOf>(part).is_none() && touches(&app, root, part));
    app.remove::<MorphColliderScene>(part);
    app.update();
    assert_eq!(body_of(&app, part), root);
}
