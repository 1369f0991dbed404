//! Writes a description as a `.glb`, stored in the forms of a choice.

use serde_json::{Map, Value, json};

use super::choice::{Choice, Compression};
use super::compress;
use super::description::{
    Channel, Description, Instances, Interpolation, Local, Mesh, Node, Primitive, Target, Vertices,
};
use super::numbers::Numbers;
use super::storage::{Storage, glb};

pub(super) fn write(description: &Description, choice: &Choice, seed: u64) -> Vec<u8> {
    let mut storage = Storage::new(choice, seed);
    let meshes: Vec<Value> = description
        .meshes
        .iter()
        .map(|it| mesh(it, choice, &mut storage))
        .collect();
    let of_node = |node: usize| self::node(description, node, &mut storage);
    let nodes: Vec<Value> = (0..description.nodes.len()).map(of_node).collect();
    let mut json = json!({"asset": {"version": "2.0"}, "meshes": meshes, "nodes": nodes});
    let skins = description.skins.iter().map(|skin| {
        let binds = skin.inverse_binds.as_ref().map(|binds| storage.plain(binds));
        without_nulls(json!({"joints": skin.joints, "inverseBindMatrices": binds}))
    });
    let skins: Vec<Value> = skins.collect();
    if !skins.is_empty() {
        json["skins"] = skins.into();
    }
    if !description.channels.is_empty() {
        json["animations"] = json!([animation(&description.channels, choice, &mut storage)]);
    }
    if !description.scenes.is_empty() {
        let scenes = description.scenes.iter().map(|roots| json!({"nodes": roots}));
        json["scenes"] = scenes.collect();
    }
    if let Some(scene) = description.default_scene {
        json["scene"] = scene.into();
    }
    let (used, required) = extensions(&json, choice);
    for (list, names) in [("extensionsUsed", used), ("extensionsRequired", required)] {
        if !names.is_empty() {
            json[list] = names.into();
        }
    }
    glb(json, storage)
}

/// The extensions that the file uses, and those that it requires.
fn extensions(json: &Value, choice: &Choice) -> (Vec<&'static str>, Vec<&'static str>) {
    let text = json.to_string();
    let mut used = vec!["KHR_mesh_quantization"];
    let named = [
        "KHR_animation_pointer",
        "KHR_node_visibility",
        "EXT_mesh_gpu_instancing",
    ];
    used.extend(named.into_iter().filter(|name| text.contains(name)));
    let mut required = vec!["KHR_mesh_quantization"];
    let (name, is_required) = match choice.compression() {
        Compression::None => return (used, required),
        Compression::Meshopt(name, is_required, _) => (name, is_required),
        Compression::Draco(is_required, _) => ("KHR_draco_mesh_compression", is_required),
    };
    used.push(name);
    if is_required {
        required.push(name);
    }
    (used, required)
}

fn without_nulls(mut value: Value) -> Value {
    if let Some(object) = value.as_object_mut() {
        object.retain(|_, value| !value.is_null());
    }
    value
}

/// Attributes and targets.
type Accessors = (Map<String, Value>, Vec<Value>);

fn mesh(mesh: &Mesh, choice: &Choice, storage: &mut Storage) -> Value {
    let mut of_vertices: Vec<Option<Accessors>> = vec![None; mesh.vertices.len()];
    let mut primitives = Vec::new();
    for primitive in &mesh.primitives {
        let vertices = &mesh.vertices[primitive.vertices];
        let is_draco = matches!(choice.compression(), Compression::Draco(..)) && primitive.indices.is_some();
        // Primitives of the same vertices share accessors.
        let written = &mut of_vertices[primitive.vertices];
        let (attributes, targets) = written.get_or_insert_with(|| {
            let attributes = attributes(vertices, choice, is_draco, storage);
            (attributes, targets(vertices, choice, storage))
        });
        let mut json = json!({"attributes": attributes.clone(), "mode": primitive.mode});
        if !targets.is_empty() {
            json["targets"] = targets.clone().into();
        }
        if let Some(indices) = &primitive.indices {
            let accessor = match choice.compression() {
                Compression::Draco(_, false) => storage.unstored(indices),
                _ => storage.indices(primitive.mode, indices),
            };
            json["indices"] = accessor.into();
        }
        if is_draco {
            json["extensions"] = json!({"KHR_draco_mesh_compression": draco(primitive, vertices, storage)});
        }
        primitives.push(json);
    }
    without_nulls(json!({"primitives": primitives, "weights": mesh.weights}))
}

/// The attributes of vertices, by name.
fn named(vertices: &Vertices) -> Vec<(String, &Numbers)> {
    let mut named = vec![("POSITION".to_owned(), &vertices.positions)];
    for (set, [joints, weights]) in vertices.influences.iter().enumerate() {
        named.push((format!("JOINTS_{set}"), joints));
        named.push((format!("WEIGHTS_{set}"), weights));
    }
    named
}

fn attributes(vertices: &Vertices, choice: &Choice, is_draco: bool, storage: &mut Storage) -> Map<String, Value> {
    let (names, lists): (Vec<String>, Vec<&Numbers>) = named(vertices).into_iter().unzip();
    let accessors: Vec<usize> = match choice.compression() {
        Compression::Draco(_, false) if is_draco => lists.iter().map(|list| storage.unstored(list)).collect(),
        _ => storage.vertices(&lists, choice.vertex_form()),
    };
    names.into_iter().zip(accessors.into_iter().map(Value::from)).collect()
}

fn targets(vertices: &Vertices, choice: &Choice, storage: &mut Storage) -> Vec<Value> {
    let lists: Vec<&Numbers> = vertices.targets.iter().collect();
    let accessors = storage.vertices(&lists, choice.target_form());
    accessors
        .into_iter()
        .map(|accessor| json!({"POSITION": accessor}))
        .collect()
}

fn draco(primitive: &Primitive, vertices: &Vertices, storage: &mut Storage) -> Value {
    let indices = primitive.indices.as_ref().expect("only such primitives are compressed");
    let (names, lists): (Vec<String>, Vec<&Numbers>) = named(vertices).into_iter().unzip();
    let view = storage.bytes(&compress::draco(indices, &lists));
    let numbers: Map<String, Value> = names.into_iter().zip((0..lists.len()).map(Value::from)).collect();
    json!({"bufferView": view, "attributes": numbers})
}

fn node(description: &Description, index: usize, storage: &mut Storage) -> Value {
    let node: &Node = &description.nodes[index];
    let children = description.children(index);
    let mut json = without_nulls(json!({
        "children": (!children.is_empty()).then_some(children),
        "mesh": node.mesh, "skin": node.skin, "weights": node.weights,
    }));
    match node.local {
        Local::Matrix(matrix) => json["matrix"] = json!(matrix),
        Local::Parts {
            translation,
            rotation,
            scale,
        } => {
            (json["translation"], json["scale"]) = (json!(translation), json!(scale));
            json["rotation"] = json!(rotation);
        }
    }
    let mut extensions = Map::new();
    if node.is_hidden {
        extensions.insert("KHR_node_visibility".into(), json!({"visible": false}));
    }
    if let Some(Instances {
        translations,
        rotations,
        scales,
    }) = &node.instances
    {
        let mut accessor = |list: &Option<Numbers>| list.as_ref().map(|list| storage.plain(list));
        let attributes = json!({
            "TRANSLATION": accessor(translations), "ROTATION": accessor(rotations), "SCALE": accessor(scales),
        });
        let attributes = json!({"attributes": without_nulls(attributes)});
        extensions.insert("EXT_mesh_gpu_instancing".into(), attributes);
    }
    if !extensions.is_empty() {
        json["extensions"] = extensions.into();
    }
    json
}

fn animation(channels: &[Channel], choice: &Choice, storage: &mut Storage) -> Value {
    let (mut written, mut samplers) = (Vec::new(), Vec::new());
    for (sampler, channel) in channels.iter().enumerate() {
        let interpolation = match channel.interpolation {
            // The default is left out now and then.
            Interpolation::Linear => (sampler % 2 == 0).then_some("LINEAR"),
            Interpolation::Step => Some("STEP"),
            Interpolation::Cubic => Some("CUBICSPLINE"),
        };
        samplers.push(without_nulls(json!({
            "input": storage.plain(&channel.times),
            "output": storage.list(&channel.values, choice.value_form()),
            "interpolation": interpolation,
        })));
        let (list, index, path) = match channel.target {
            Target::Weights(node) => ("nodes", node, "weights"),
            Target::MeshWeights(mesh) => ("meshes", mesh, "weights"),
            Target::Translation(node) => ("nodes", node, "translation"),
            Target::Rotation(node) => ("nodes", node, "rotation"),
            Target::Scale(node) => ("nodes", node, "scale"),
        };
        let pointer = format!("/{list}/{index}/{path}");
        let target = if channel.by_pointer {
            json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}})
        } else {
            json!({"node": index, "path": path})
        };
        written.push(json!({"sampler": sampler, "target": target}));
    }
    json!({"channels": written, "samplers": samplers})
}
