//! All types that editors see.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use avian3d::prelude::PhysicsPlugins;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent, ReflectResource};
use bevy::gizmos::GizmoPlugin;
use bevy::prelude::*;
use bevy_morph_avian::MorphAvianPlugin;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::MorphRapierPlugin;
use bevy_rapier3d::prelude::{NoUserData, RapierPhysicsPlugin};
use serde_json::{Value, json};

use super::remote::Remote;
use crate::support::plain_app;

/// Components and resources that a game writes.
const WRITTEN: &[&str] = &[
    "MorphActiveCollisionHooks",
    "MorphAvianCarry",
    "MorphBodyRoot",
    "MorphCharacterCarry",
    "MorphCollider",
    "MorphColliderDisabled",
    "MorphColliderScene",
    "MorphCollidingEntities",
    "MorphCollisionEventsEnabled",
    "MorphCollisionLayers",
    "MorphCollisionSettings",
    #[cfg(feature = "diagnostic_ui")]
    "MorphDiagnosticsUiSettings",
    "MorphPairCosts",
    "MorphPhysicsCollider",
    "MorphPhysicsScene",
    "MorphPickingSettings",
    "MorphRayCaster",
    "MorphSelfCollisions",
    "MorphShape",
    "MorphShapeCaster",
    "MorphSurfaceAnchor",
    "MorphTeleported",
    "MorphTreeOptions",
];

/// Those that can be inserted, but not changed in place: a relationship, and a handle, which Bevy's protocol cannot write.
const INSERTED: &[&str] = &["MorphColliderOf", "MorphTreeFrom"];

/// Those that only the plugin writes.
const REPORTED: &[&str] = &[
    #[cfg(feature = "diagnostic_ui")]
    "MorphDiagnosticsUi",
    "MorphAvianPart",
    "MorphCharacterGround",
    "MorphColliders",
    "MorphCollisionDiagnostics",
    "MorphCollisions",
    "MorphPhysicsDiagnostics",
    "MorphRayHits",
    "MorphShapeHits",
    "MorphTrees",
];

/// Those that are one value for the memory of a game, without a text.
const OPAQUE: &[&str] = &["MorphCollisionState"];

/// Public, but nothing that can be edited: the choice of a schedule while the app is built, and what the crates of physics engines share.
const NOT_REFLECTED: &[&str] = &[
    "FromScene",
    "InFixedLoop",
    "MeshLayouts",
    "MorphCollisionSchedule",
    "PhysicsSurface",
    "ScenePart",
    "Skeletons",
];

/// Apps with all plugins, one for each physics engine. Bevy's automatic registration, which a feature enables, is undone.
fn apps() -> [App; 2] {
    let new = || {
        let mut app = plain_app();
        app.insert_resource(AppTypeRegistry::default());
        app.add_plugins((GizmoPlugin, bevy::diagnostic::DiagnosticsPlugin));
        app.add_plugins((MorphPlugins, MorphTreeFilesPlugin::default()));
        #[cfg(feature = "diagnostic_ui")]
        app.add_plugins(MorphDiagnosticsUiPlugin);
        app
    };
    let (mut rapier, mut avian) = (new(), new());
    rapier.add_plugins((RapierPhysicsPlugin::<NoUserData>::default(), MorphRapierPlugin));
    avian.add_plugins((PhysicsPlugins::default(), MorphAvianPlugin));
    for app in [&mut rapier, &mut avian] {
        // Bevy's own, which entities of our types have.
        app.register_type::<Entity>().register_type::<Name>();
        app.finish();
        app.cleanup();
    }
    [rapier, avian]
}

/// The paths of our components and resources in the registry of an app, by their short names.
fn ours(app: &App) -> BTreeMap<String, String> {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let ours = registry.iter().filter(|registration| {
        let path = registration.type_info().type_path();
        path.starts_with("bevy_morph_") && registration.data::<ReflectComponent>().is_some()
    });
    ours.map(|registration| {
        let info = registration.type_info();
        assert!(registration.data::<ReflectDefault>().is_some() || info.type_path().ends_with("MorphAvianPart"));
        (
            info.type_path_table().short_path().to_owned(),
            info.type_path().to_owned(),
        )
    })
    .collect()
}

/// The names of public components and resources in the sources of the plugin's crates, and whether they derive `Reflect`.
fn in_sources(folder: &Path, found: &mut BTreeMap<String, bool>) {
    for entry in std::fs::read_dir(folder).expect("it is a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            in_sources(&path, found);
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("sources are text");
        let mut attributes = String::new();
        for line in text.lines() {
            if line.starts_with("#[") {
                attributes += line;
            } else if let Some(rest) = line
                .strip_prefix("pub struct ")
                .or_else(|| line.strip_prefix("pub enum "))
            {
                let derives = |what: &str| attributes.split(['(', ' ', ',', ')']).any(|word| word == what);
                if derives("Component") || derives("Resource") {
                    let name = rest.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
                    found.insert(name.to_owned(), derives("Reflect"));
                }
                attributes.clear();
            } else {
                attributes.clear();
            }
        }
    }
}

#[test]
fn no_type_is_missing() {
    let registered: BTreeSet<String> = apps().iter().flat_map(|app| ours(app).into_keys()).collect();
    let listed: BTreeSet<String> = [WRITTEN, INSERTED, REPORTED, OPAQUE]
        .concat()
        .into_iter()
        .map(str::to_owned)
        .collect();
    assert_eq!(
        registered, listed,
        "a type is not registered, or not in the lists of this test"
    );

    let mut sources = BTreeMap::new();
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    for name in ["collision", "physics", "rapier", "avian"] {
        in_sources(&crates.join(format!("bevy_morph_{name}/src")), &mut sources);
    }
    assert!(sources.len() > 35, "{sources:?}");
    for (name, is_reflected) in &sources {
        let is_excepted = NOT_REFLECTED.contains(&name.as_str());
        assert_ne!(*is_reflected, is_excepted, "`{name}`");
        let feature = cfg!(feature = "diagnostic_ui") || !name.starts_with("MorphDiagnosticsUi");
        assert!(
            is_excepted || !feature || registered.contains(name),
            "`{name}` is not registered"
        );
    }
}

/// Another value of the same type, for a field of that name.
fn other(name: &str, value: &Value, entity: Entity) -> Value {
    match (name, value) {
        ("mask", Value::Null) => json!(5),
        ("excluded_entities", _) => json!([entity]),
        ("collider", Value::Number(_)) => json!(entity),
        ("only_named", _) => json!(["jaw"]),
        ("mode", _) => json!("Contacts"),
        // With nothing in it, there is nothing to change.
        ("regions" | "pairs" | "0", Value::Array(list)) if list.is_empty() => value.clone(),
        ("every_deforming_mesh", _) => json!({ "mode": "First", "margin": 0.5, "tolerance": 0.25, "continuous": true }),
        (_, Value::Bool(is)) => json!(!is),
        (_, Value::Number(number)) if number.is_f64() => json!(f64::from(u8::from(number.as_f64() == Some(0.0)))),
        (_, Value::Number(number)) => json!(u8::from(number.as_u64() == Some(0))),
        (_, Value::Array(list)) => list.iter().map(|value| other("", value, entity)).collect(),
        (_, Value::Object(fields)) => {
            let fields = fields
                .iter()
                .map(|(name, value)| (name.clone(), other(name, value, entity)));
            Value::Object(fields.collect())
        }
        _ => panic!("no other value is known for `{name}`: {value}"),
    }
}

#[test]
fn every_field_can_be_read_and_changed() {
    let mut fields = 0;
    for mut app in apps() {
        let target = app.world_mut().spawn_empty().id();
        for (name, path) in ours(&app) {
            if OPAQUE.contains(&name.as_str()) {
                continue;
            }
            let registry = app.world().resource::<AppTypeRegistry>().clone();
            let registry = registry.read();
            let registration = registry.get_with_type_path(&path).expect("it is ours");
            let resource = registration.data::<ReflectResource>().is_some();
            let entity = if resource {
                let world = app.world();
                let id = world.components().get_id(registration.type_id());
                let Some(entity) = id.and_then(|id| world.resource_entities().get(id)) else {
                    panic!("the app has no {name}");
                };
                entity
            } else {
                app.world_mut().spawn_empty().id()
            };
            if INSERTED.contains(&name.as_str()) {
                let value = match name.as_str() {
                    "MorphColliderOf" => json!({ "body": target }),
                    _ => continue,
                };
                assert_eq!(app.insert_json(entity, &path, &value), Ok(()));
                assert_eq!(app.get(entity, &path), Ok(value));
                continue;
            }
            if REPORTED.contains(&name.as_str()) {
                assert!(
                    !resource || app.get(entity, &path).is_ok(),
                    "{name}: {:?}",
                    app.get(entity, &path)
                );
                continue;
            }
            if !resource {
                // All fields have defaults.
                let empty = if name == "MorphShape" {
                    json!({ "Ball": {} })
                } else {
                    json!({})
                };
                let empty = if name == "MorphCollidingEntities" {
                    json!([])
                } else {
                    empty
                };
                assert_eq!(app.insert_json(entity, &path, &empty), Ok(()), "{name}");
            }
            let whole = app.get(entity, &path).unwrap_or_else(|error| panic!("{name}: {error}"));
            let Value::Object(parts) = &whole else { continue };
            let parts = if name == "MorphShape" {
                &json!({ "radius": 0.5 })
            } else {
                &Value::Object(parts.clone())
            };
            for (field, value) in parts.as_object().expect("it has fields") {
                let wanted = other(field, value, target);
                let done = app.mutate(entity, &path, &format!(".{field}"), &wanted);
                assert_eq!(done, Ok(()), "{name}.{field} = {wanted}");
                let now = app.get(entity, &path).expect("it was read before");
                let now = if name == "MorphShape" {
                    &now["Ball"][field]
                } else {
                    &now[field]
                };
                assert_eq!(*now, wanted, "{name}.{field}");
                fields += 1;
            }
            // The whole value at once, in another variant for an enum.
            if name == "MorphShape" {
                let capsule = json!({ "Capsule": { "half_length": 2.0, "radius": 0.25 } });
                assert_eq!(app.mutate(entity, &path, "", &capsule), Ok(()));
                assert_eq!(app.get(entity, &path), Ok(capsule));
                let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                let hull = json!({ "ConvexHull": corners });
                assert_eq!(app.mutate(entity, &path, "", &hull), Ok(()));
                assert_eq!(
                    app.get(entity, &path).expect("it was read before")["ConvexHull"]
                        .as_array()
                        .map(Vec::len),
                    Some(4)
                );
                let sphere = |points: u32| {
                    let points = (0..points).map(|i| {
                        let (sin, cos) = (i as f32).sin_cos();
                        let z = (i as f32 * 0.37).sin();
                        json!([cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z])
                    });
                    Value::Array(points.collect())
                };
                for (points, says) in [
                    (json!([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), "no volume"),
                    (
                        json!([[0.0, 0.0, 0.0], [1e38, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
                        "point 1",
                    ),
                    (
                        json!([[0.0, 0.0, null], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
                        "null",
                    ),
                    (sphere(20_000), "more than 4096 corners"),
                    (
                        Value::Array(vec![json!([0.0, 0.0, 0.0]); 65_537]),
                        "at most 65536 points",
                    ),
                ] {
                    let refused = app.mutate(entity, &path, "", &json!({ "ConvexHull": points }));
                    let error = refused.expect_err("it is no hull");
                    assert!(error.contains(says), "{error}");
                }
            }
        }
    }
    assert!(fields > 90, "{fields} fields");
}
