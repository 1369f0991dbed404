//! `docs/scene.schema.json` describes exactly the scenes that can be read.

use std::path::Path;

use morph_collision_models::scenes::{BodyState, Scene, SceneBody};
use morph_collision_models::weight_list::WeightList;
use serde_json::{Map, Value, json};

fn schema() -> Value {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scene.schema.json"));
    let text = std::fs::read_to_string(path).expect("the schema is there");
    serde_json::from_str(&text).expect("it is JSON")
}

/// A scene in which everything is given.
fn full() -> Value {
    let text = || Some("text".to_owned());
    let scene = Scene {
        schema: text(),
        name: text(),
        comment: text(),
        bodies: vec![SceneBody {
            model: "a.glb".into(),
            mesh: 1,
            node: Some(2),
            instance: Some(1),
            name: text(),
            comment: text(),
        }],
        frames: vec![vec![BodyState {
            weights: WeightList::Named(vec![("a".into(), 1.0)]),
            rotation: Some([0.0, 0.0, 0.0, 1.0]),
            translation: Some([1.0; 3]),
            scale: Some([1.0; 3]),
            clip: text(),
            time: Some(0.5),
            comment: text(),
        }]],
        ..Scene::default()
    };
    serde_json::to_value(scene).expect("it can be written")
}

fn reads(scene: &Value) -> bool {
    Scene::parse(scene.to_string().as_bytes(), Path::new("scene.json")).is_ok()
}

/// The three kinds of objects: where they are in a scene, and their schemas.
fn objects(schema: &Value) -> [(&'static str, &Value); 3] {
    [
        ("", schema),
        ("/bodies/0", &schema["$defs"]["body"]),
        ("/frames/0/0", &schema["$defs"]["state"]),
    ]
}

fn object<'a>(scene: &'a mut Value, at: &str) -> &'a mut Map<String, Value> {
    scene
        .pointer_mut(at)
        .and_then(Value::as_object_mut)
        .expect("there is an object")
}

fn keys(object: &Value) -> Vec<String> {
    let mut keys: Vec<String> = object.as_object().into_iter().flat_map(Map::keys).cloned().collect();
    keys.sort_unstable();
    keys
}

#[test]
fn it_has_the_same_keys_and_requires_the_same() {
    let schema = schema();
    for (at, described) in objects(&schema) {
        let mut scene = full();
        assert!(reads(&scene));
        assert_eq!(
            keys(&described["properties"]),
            keys(scene.pointer(at).expect("it is there")),
            "{at}"
        );
        for key in keys(&described["properties"]) {
            let mut without = full();
            object(&mut without, at).remove(&key);
            let required = described["required"]
                .as_array()
                .is_some_and(|keys| keys.contains(&json!(key)));
            assert_eq!(reads(&without), !required, "{at}/{key}");
        }
        assert_eq!(described["additionalProperties"], false);
        object(&mut scene, at).insert("other".into(), json!(1));
        assert!(!reads(&scene), "{at}");
    }
}

#[test]
fn values_have_the_types_that_it_says() {
    let schema = schema();
    // Every value is tried for every key, and is read if the schema allows its type.
    let values = [
        json!("text"),
        json!(1),
        json!(-1),
        json!(0.5),
        json!([0, 0, 0]),
        json!([0, 0, 0, 1]),
        json!([]),
        json!({"a": 1}),
        json!(true),
    ];
    for (at, described) in objects(&schema) {
        for key in keys(&described["properties"]) {
            // Their elements are checked as bodies and states.
            if key == "bodies" || key == "frames" {
                continue;
            }
            for value in &values {
                let mut scene = full();
                object(&mut scene, at).insert(key.clone(), value.clone());
                let allowed = allows(&schema, &described["properties"][&key], value);
                assert_eq!(reads(&scene), allowed, "{at}/{key}: {value}");
            }
        }
    }
}

/// Whether a schema allows a value; knows the words that are used.
fn allows(root: &Value, schema: &Value, value: &Value) -> bool {
    if let Some(name) = schema["$ref"].as_str().and_then(|path| path.strip_prefix('#')) {
        return root.pointer(name).is_some_and(|schema| allows(root, schema, value));
    }
    if let Some(choices) = schema["oneOf"].as_array() {
        return choices.iter().filter(|schema| allows(root, schema, value)).count() == 1;
    }
    if !schema["const"].is_null() {
        return schema["const"] == *value;
    }
    match schema["type"].as_str() {
        Some("string") => value.is_string(),
        Some("number") => value.is_number(),
        Some("integer") => value
            .as_i64()
            .is_some_and(|number| number >= schema["minimum"].as_i64().unwrap_or(i64::MIN)),
        Some("array") => value.as_array().is_some_and(|list| {
            let length = list.len() as u64;
            let fits = (schema["minItems"].as_u64().unwrap_or(0)..=schema["maxItems"].as_u64().unwrap_or(u64::MAX))
                .contains(&length);
            fits && list.iter().all(|element| allows(root, &schema["items"], element))
        }),
        Some("object") => value.as_object().is_some_and(|object| {
            object
                .values()
                .all(|value| allows(root, &schema["additionalProperties"], value))
        }),
        other => panic!("the test does not know the type {other:?}"),
    }
}
