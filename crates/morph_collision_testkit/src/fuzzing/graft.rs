//! Adds parts to glTF files that random changes hardly ever make: scenes, hidden nodes, instances, animation pointers, further sets of
//! influences, names of targets, expressions of avatars, compression that is not required, and integers that are written as floats.

use rand::{Rng, RngExt};
use serde_json::{Map, Value, json};

/// Numbers of sets of influences, some of which no file has.
const SETS: [&str; 8] = ["0", "1", "2", "3", "9", "01", "99999999", "18446744073709551616"];

/// Parts of pointers.
const POINTERS: [&str; 11] = [
    "weights",
    "weights",
    "translation",
    "rotation",
    "scale",
    "weights/0",
    "matrix",
    "extensions/KHR_node_visibility/visible",
    "",
    "weights/",
    "~0weights",
];

/// Adds one part, or changes one for another of its kind.
pub(super) fn graft(json: &mut Value, rng: &mut impl Rng) {
    if !json.is_object() {
        return;
    }
    match rng.random_range(0..9) {
        0 => scenes(json, rng),
        1 => visibility(json, rng),
        2 => instances(json, rng),
        3 => pointer(json, rng),
        4 => influences(json, rng),
        5 => target_names(json, rng),
        6 => expressions(json, rng),
        7 => only_used(json, rng),
        _ => {
            let likely = rng.random_range(0.05..1.0);
            floats(json, likely, rng);
        }
    }
}

/// An index of a list of the file, mostly of an element that exists.
fn index(json: &Value, list: &str, rng: &mut impl Rng) -> u64 {
    let length = json[list].as_array().map_or(0, Vec::len) as u64;
    match rng.random_range(0..12) {
        0 => length,
        1 => u64::MAX,
        _ => rng.random_range(0..length.max(1)),
    }
}

/// A random element of a list in an object.
fn element<'a>(owner: &'a mut Value, list: &str, rng: &mut impl Rng) -> Option<&'a mut Value> {
    let list = owner.get_mut(list)?.as_array_mut().filter(|list| !list.is_empty())?;
    let index = rng.random_range(0..list.len());
    list.get_mut(index)
}

/// Sets a member of an object; other values stay as they are.
fn set(object: &mut Value, key: &str, value: Value) {
    if let Some(object) = object.as_object_mut() {
        object.insert(key.to_owned(), value);
    }
}

/// Sets an extension of an element.
fn extend(element: &mut Value, name: &str, extension: Value) {
    if let Some(Value::Object(extensions)) = element.get_mut("extensions") {
        extensions.insert(name.to_owned(), extension);
    } else {
        set(element, "extensions", json!({ name: extension }));
    }
}

fn scenes(json: &mut Value, rng: &mut impl Rng) {
    let scene = |rng: &mut _| {
        let count = RngExt::random_range(rng, 0..4);
        let roots: Vec<u64> = (0..count).map(|_| index(json, "nodes", rng)).collect();
        json!({ "nodes": roots })
    };
    let scenes: Vec<Value> = (0..rng.random_range(0..3)).map(|_| scene(rng)).collect();
    set(json, "scenes", scenes.into());
    if rng.random() {
        let scene = index(json, "scenes", rng);
        set(json, "scene", scene.into());
    }
    // A node below another one, or below itself.
    let child = index(json, "nodes", rng);
    if let Some(node) = element(json, "nodes", rng) {
        set(node, "children", json!([child]));
    }
}

fn visibility(json: &mut Value, rng: &mut impl Rng) {
    let visible = [json!(false), json!(true), json!(0), Value::Null][rng.random_range(0..4_usize)].clone();
    if let Some(node) = element(json, "nodes", rng) {
        extend(node, "KHR_node_visibility", json!({ "visible": visible }));
    }
}

fn instances(json: &mut Value, rng: &mut impl Rng) {
    let mut attributes = Map::new();
    for (attribute, shape) in [
        ("TRANSLATION", "VEC3"),
        ("ROTATION", "VEC4"),
        ("SCALE", "VEC3"),
        ("_ID", "SCALAR"),
    ] {
        if rng.random_bool(0.4) {
            // Mostly an accessor of the right shape, if there is one.
            let accessors = json["accessors"].as_array().map_or(&[][..], Vec::as_slice);
            let fits = |accessor: &usize| accessors[*accessor]["type"] == shape;
            let fitting: Vec<usize> = (0..accessors.len()).filter(fits).collect();
            let accessor = match fitting.len() {
                1.. if rng.random_bool(0.8) => fitting[rng.random_range(0..fitting.len())] as u64,
                _ => index(json, "accessors", rng),
            };
            attributes.insert(attribute.to_owned(), accessor.into());
        }
    }
    if let Some(node) = element(json, "nodes", rng) {
        extend(node, "EXT_mesh_gpu_instancing", json!({ "attributes": attributes }));
    }
}

fn pointer(json: &mut Value, rng: &mut impl Rng) {
    let list = ["nodes", "nodes", "meshes", "meshes", "skins", "materials", ""][rng.random_range(0..7)];
    let index = index(json, list, rng);
    let pointer = format!("/{list}/{index}/{}", POINTERS[rng.random_range(0..POINTERS.len())]);
    let animation = element(json, "animations", rng);
    let channel = animation.and_then(|animation| element(animation, "channels", rng));
    if let Some(target) = channel.and_then(|channel| channel.get_mut("target")) {
        // The path that the node has is often the right one.
        let path = target["path"]
            .as_str()
            .filter(|path| *path != "pointer")
            .map(str::to_owned);
        let pointer = match (target["node"].as_u64(), path) {
            (Some(node), Some(path)) if rng.random() => format!("/nodes/{node}/{path}"),
            _ => pointer,
        };
        set(target, "path", "pointer".into());
        extend(target, "KHR_animation_pointer", json!({ "pointer": pointer }));
    }
}

fn influences(json: &mut Value, rng: &mut impl Rng) {
    let set_number = SETS[rng.random_range(0..SETS.len())];
    let mesh = element(json, "meshes", rng);
    let Some(primitive) = mesh.and_then(|mesh| element(mesh, "primitives", rng)) else {
        return;
    };
    let Some(attributes) = primitive.get_mut("attributes") else {
        return;
    };
    for part in ["JOINTS", "WEIGHTS"] {
        let first = attributes[format!("{part}_0")].clone();
        // Now and then only one of the two.
        if !first.is_null() && rng.random_bool(0.9) {
            set(attributes, &format!("{part}_{set_number}"), first);
        }
    }
}

fn target_names(json: &mut Value, rng: &mut impl Rng) {
    let names = [
        json!(["smile", "blink", "smile"]),
        json!(["smile", 7, null, {}]),
        json!("smile"),
        json!([]),
        json!({"0": "smile"}),
        json!(["", "\u{0}\u{202e}", "x".repeat(300)]),
    ][rng.random_range(0..6_usize)]
    .clone();
    let extras = if rng.random_bool(0.8) {
        json!({ "targetNames": names.clone() })
    } else {
        names.clone()
    };
    match (rng.random_range(0..3), element(json, "meshes", rng)) {
        (0, Some(mesh)) => set(mesh, "extras", extras),
        (1, Some(mesh)) => {
            if let Some(primitive) = element(mesh, "primitives", rng) {
                set(primitive, "extras", extras);
            }
        }
        _ => {
            let accessors = json.get_mut("accessors").and_then(Value::as_array_mut);
            for accessor in accessors.into_iter().flatten() {
                set(accessor, "name", names[rng.random_range(0..3_usize)].clone());
            }
        }
    }
}

fn expressions(json: &mut Value, rng: &mut impl Rng) {
    let (mesh, node) = (index(json, "meshes", rng), index(json, "nodes", rng));
    let target = rng.random_range(0..4);
    let weight = [json!(100), json!(0.5), json!(-1e39), Value::Null, json!("1")][rng.random_range(0..5_usize)].clone();
    let (name, extension) = if rng.random() {
        let group = json!({
            "name": "Joy", "presetName": "joy", "isBinary": rng.random::<bool>(),
            "binds": [{"mesh": mesh, "index": target, "weight": weight}, {"mesh": 0, "index": 0}],
        });
        ("VRM", json!({"blendShapeMaster": {"blendShapeGroups": [group, {}, 1]}}))
    } else {
        let expression = json!({"morphTargetBinds": [{"node": node, "index": target, "weight": weight}, {"node": 0}]});
        let named = json!({"happy": expression, "odd": 1});
        let expressions = if rng.random() {
            json!({ "preset": named })
        } else {
            json!({ "custom": named })
        };
        ("VRMC_vrm", json!({"specVersion": "1.0", "expressions": expressions}))
    };
    extend(json, name, extension);
}

/// Says that no extension is required, or that all used ones are.
fn only_used(json: &mut Value, rng: &mut impl Rng) {
    if rng.random() {
        let required = json["extensionsRequired"].clone();
        let required = if required.is_array() { required } else { json!([]) };
        set(json, "extensionsUsed", required);
        set(json, "extensionsRequired", json!([]));
    } else {
        let used = json["extensionsUsed"].clone();
        let used = if used.is_array() { used } else { json!([]) };
        set(json, "extensionsRequired", used);
    }
}

/// Writes integers as floats.
fn floats(json: &mut Value, likely: f64, rng: &mut impl Rng) {
    match json {
        Value::Object(object) => object.values_mut().for_each(|value| floats(value, likely, rng)),
        Value::Array(list) => list.iter_mut().for_each(|value| floats(value, likely, rng)),
        Value::Number(number) => {
            if let Some(float) = number.as_f64()
                && rng.random_bool(likely)
            {
                *json = Value::from(float);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rand::SeedableRng;
    use rand_pcg::Pcg64Mcg;

    use super::super::bend::{pack, parts};
    use super::*;
    use morph_collision_models::clip::WeightAnimation;
    use morph_collision_models::gltf::read::{Extent, GltfFile, ReadOptions};
    use morph_collision_models::gltf::write::{Appearance, to_glb};

    /// What the reader finds in a file: one entry for each kind of part that is grafted.
    fn found(file: &GltfFile) -> [usize; 7] {
        let drawing = file.drawing(Extent::DefaultScene).unwrap_or_default();
        let names = file.mesh(0).map(|found| found.mesh.target_names).unwrap_or_default();
        [
            file.scene_names().len(),
            drawing.nodes_left_out,
            drawing.drawn.iter().filter(|drawn| drawn.instance.is_some()).count(),
            file.clips(0, None, names.len()).clips.len(),
            file.skin(0, None).ok().flatten().map_or(0, |skin| skin.sets.len()),
            names.iter().filter(|name| *name == "smile").count(),
            file.expressions().len(),
        ]
    }

    /// In some of the files, the reader finds more of every kind of part.
    #[test]
    fn grafts_reach_the_reader() {
        let mut skinned = morph_collision_models::generated::rigs::tube(1, 3, 2, 2);
        skinned.animations = vec![WeightAnimation {
            name: "clip".into(),
            times: vec![0.0, 1.0],
            weights: vec![vec![0.5; skinned.targets.len()]; 2],
            ..WeightAnimation::default()
        }];
        let mut rigid = skinned.clone();
        rigid.skin = None;
        // Its only channel animates weights: of nothing, until a pointer says of what.
        let no_target = |json: &mut Value| {
            if let Some(channel) = json.pointer_mut("/animations/0/channels/0") {
                set(channel, "target", json!({"path": "weights"}));
            }
        };
        let mut counts = [0; 7];
        for (mesh, seeds) in [(skinned, 0..400), (rigid, 400..800)] {
            let glb = to_glb(&mesh, &Appearance::default()).expect("it can be written");
            let (json, chunk) = parts(&glb).expect("it is a file");
            let mut json: Value = serde_json::from_slice(json).expect("it is JSON");
            no_target(&mut json);
            let read = |json: &Value| {
                let bytes = pack(json, &chunk, true).expect("it is small");
                GltfFile::parse(&bytes, Path::new("grafted.glb"), &ReadOptions::default()).ok()
            };
            let before = found(&read(&json).expect("it is valid"));
            for seed in seeds {
                let rng = &mut Pcg64Mcg::seed_from_u64(seed);
                let mut grafted = json.clone();
                for _ in 0..2 {
                    graft(&mut grafted, rng);
                }
                let after = read(&grafted).map_or(before, |file| found(&file));
                for (count, (after, before)) in counts.iter_mut().zip(after.into_iter().zip(before)) {
                    *count += usize::from(after > before);
                }
            }
        }
        assert!(counts.iter().all(|count| *count >= 3), "{counts:?}");
    }
}
