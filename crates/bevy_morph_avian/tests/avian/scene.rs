//! Scenes with Avian's bodies, and from files.

use std::path::Path;

use avian3d::prelude::*;
use bevy::gltf::Gltf;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use morph_collision_workspace::app::{headless, load_gltf, update_until};
use morph_collision_workspace::physics::{settle, sheet};

use crate::any_engine::scene::part;
use crate::log::start;
use crate::support::{all_below, app, body, place, run, velocity};

#[test]
fn the_parts_of_a_scene_on_a_body_move_with_it() {
    let mut app = app();
    let root = app
        .world_mut()
        .spawn((
            MorphPhysicsScene::default(),
            RigidBody::Kinematic,
            LinearVelocity(Vec3::X),
            Transform::default(),
        ))
        .id();
    let parts = [-10.0, 10.0].map(|x| part(&mut app, root, "part", &sheet(16), Vec3::X * x));
    settle(&mut app);
    run(&mut app, 3);
    for part in parts {
        let body = app.world().get::<ColliderOf>(part).map(|of| of.body);
        assert_eq!(body, Some(root));
    }
    let from = place(&app, root).x;
    let boxes = [-10.0, 10.0].map(|x| {
        body(
            &mut app,
            Collider::cuboid(0.6, 0.6, 0.6),
            Vec3::new(from + x, 0.31, 0.0),
        )
    });
    run(&mut app, 90);
    for cuboid in boxes {
        let velocity = velocity(&app, cuboid);
        assert!((velocity - Vec3::X).length() < 0.02, "it is carried at {velocity}");
        assert!((place(&app, cuboid).y - 0.3).abs() < 1e-2);
    }
}

#[test]
fn a_gltf_file_is_in_physics_once_it_is_spawned() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    let file = assets.join("dolphin_564.glb");
    let mut app = headless(&assets);
    app.add_plugins((PhysicsPlugins::default(), MorphAvianPlugin));
    start(&mut app);
    let gltf = load_gltf(&mut app, &file).expect("it comes with the repository");
    let scene = app.world().resource::<Assets<Gltf>>().get(&gltf).unwrap().scenes[0].clone();
    app.world_mut()
        .spawn((WorldAssetRoot(scene), MorphPhysicsScene::default()));
    update_until(&mut app, &file, |world| {
        Ok(world.resource::<MorphPhysicsDiagnostics>().surfaces == 1)
    })
    .expect("it comes into physics");
    run(&mut app, 2);
    let hits = all_below(&mut app, 0.0, 0.0);
    let mut parts = app
        .world_mut()
        .query_filtered::<Entity, (With<MeshMorphWeights>, With<MorphPhysicsCollider>)>();
    let mesh = parts.single(app.world()).expect("there is one mesh");
    assert!(hits.first().is_some_and(|&(entity, _)| entity == mesh), "{hits:?}");
}
