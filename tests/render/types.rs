//! A program that registers only the types of `view::types` spawns the same scenes as one that registers all types.

use std::path::Path;

use bevy::ecs::name::NameOrEntity;
use bevy::gltf::Gltf;
use bevy::prelude::*;
use bevy::reflect::TypeRegistryArc;
use morph_collision_workspace::app::{load_gltf, ready, without_collisions};
use morph_collision_workspace::view::types;

/// A scene of everything that the loader makes and that none of the models in `assets` has.
const CAMERAS_AND_LIGHTS: &str = r#"{
    "asset": { "version": "2.0" },
    "extensionsUsed": ["KHR_lights_punctual"],
    "extensions": { "KHR_lights_punctual": { "lights": [
        { "type": "directional", "name": "sun", "extras": { "hour": 12 } },
        { "type": "point", "name": "bulb" },
        { "type": "spot", "name": "torch", "spot": {} }
    ] } },
    "cameras": [
        { "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } },
        { "type": "orthographic", "orthographic": { "xmag": 1.0, "ymag": 1.0, "znear": 0.1, "zfar": 9.0 } }
    ],
    "nodes": [
        { "name": "a", "camera": 0, "extras": { "lens": "long" } },
        { "name": "b", "camera": 1 },
        { "name": "c", "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "name": "d", "extensions": { "KHR_lights_punctual": { "light": 1 } } },
        { "name": "e", "extensions": { "KHR_lights_punctual": { "light": 2 } } }
    ],
    "scenes": [{ "name": "set", "nodes": [0, 1, 2, 3, 4], "extras": { "act": 1 } }]
}"#;

/// The components of every entity of the file's first scene, after it was spawned, with the entities' names.
fn spawned(file: &Path, registry: Option<AppTypeRegistry>) -> Vec<(String, Vec<String>)> {
    let mut app = without_collisions(file.parent().unwrap());
    if let Some(registry) = registry {
        // This also removes what plugins registered; handles of meshes are needed again.
        app.insert_resource(registry);
        app.register_type::<Handle<Mesh>>();
    }
    ready(&mut app);
    let gltf = load_gltf(&mut app, file).unwrap();
    let scene = app.world().resource::<Assets<Gltf>>().get(&gltf).unwrap().scenes[0].clone();
    let root = app.world_mut().spawn(WorldAssetRoot(scene)).id();
    (0..3).for_each(|_| app.update());
    let world = app.world_mut();
    let mut entities: Vec<_> = world
        .query_filtered::<(Entity, NameOrEntity), With<ChildOf>>()
        .iter(world)
        .map(|(entity, name)| (entity, name.name.map_or_else(String::new, ToString::to_string)))
        .collect();
    assert!(world.get::<Children>(root).is_some(), "nothing was spawned");
    let components = |entity| {
        let mut names: Vec<_> = world
            .inspect_entity(entity)
            .unwrap()
            .map(|(_, of)| of.name().to_string())
            .collect();
        names.sort_unstable();
        names
    };
    entities.sort_by(|a, b| a.1.cmp(&b.1));
    entities
        .into_iter()
        .map(|(entity, name)| (name, components(entity)))
        .collect()
}

#[test]
fn a_scene_needs_no_other_types() {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().join("set.gltf");
    std::fs::write(&set, CAMERAS_AND_LIGHTS).unwrap();
    let character = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/mh_character_low.glb");
    for file in [set, character] {
        let few = AppTypeRegistry(TypeRegistryArc::default());
        types::register(&mut few.write());
        let (all, few) = (spawned(&file, None), spawned(&file, Some(few)));
        assert!(all.len() > 4);
        assert_eq!(all, few);
    }
}
