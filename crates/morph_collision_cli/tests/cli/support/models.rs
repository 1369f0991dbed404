//! Small glTF files.

use std::error::Error;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

/// A mesh for [`write_gltf`]. It can be broken in ways that the test kit's own writer refuses.
#[derive(Clone)]
pub(crate) struct RawMesh {
    pub(crate) name: &'static str,
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) indices: Vec<u16>,
    pub(crate) targets: Vec<Vec<[f32; 3]>>,
}

impl RawMesh {
    /// One triangle in the plane z = 0 with a target that lifts it by 1.
    pub(crate) fn triangle(name: &'static str) -> Self {
        Self {
            name,
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            indices: vec![0, 1, 2],
            targets: vec![vec![[0.0, 0.0, 1.0]; 3]],
        }
    }
}

/// Writes `name` (a `.gltf`) and its buffer into `dir`.
pub(crate) fn write_gltf(dir: &Path, name: &str, meshes: &[RawMesh]) -> Result<PathBuf, Box<dyn Error>> {
    let mut file = GltfParts::default();
    let meshes: Vec<Value> = meshes
        .iter()
        .map(|mesh| {
            let mut primitive = json!({ "attributes": { "POSITION": file.vectors(&mesh.positions) } });
            if !mesh.indices.is_empty() {
                primitive["indices"] = file.indices(&mesh.indices).into();
            }
            if !mesh.targets.is_empty() {
                let targets = mesh
                    .targets
                    .iter()
                    .map(|target| json!({ "POSITION": file.vectors(target) }));
                primitive["targets"] = targets.collect();
            }
            json!({ "name": mesh.name, "primitives": [primitive] })
        })
        .collect();
    let buffer = format!("{name}.bin");
    let gltf = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": buffer, "byteLength": file.bytes.len() }],
        "bufferViews": file.views,
        "accessors": file.accessors,
        "meshes": meshes,
    });
    std::fs::write(dir.join(buffer), &file.bytes)?;
    let path = dir.join(name);
    std::fs::write(&path, serde_json::to_vec(&gltf)?)?;
    Ok(path)
}

#[derive(Default)]
struct GltfParts {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl GltfParts {
    /// Adds an accessor of 3-vectors and returns its index.
    fn vectors(&mut self, vectors: &[[f32; 3]]) -> usize {
        let bytes: Vec<u8> = vectors
            .as_flattened()
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        self.accessor(
            &bytes,
            &json!({ "componentType": 5126, "type": "VEC3", "count": vectors.len() }),
        )
    }

    /// Adds an accessor of 16-bit indices and returns its index.
    fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        self.accessor(
            &bytes,
            &json!({ "componentType": 5123, "type": "SCALAR", "count": indices.len() }),
        )
    }

    fn accessor(&mut self, bytes: &[u8], accessor: &Value) -> usize {
        self.views
            .push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut accessor = accessor.clone();
        accessor["bufferView"] = (self.views.len() - 1).into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// A file of two triangles in the plane z = 0 with a target that lifts them by 1. The first one is bound to a joint under a node
/// at x = 10. The clip "rise" lifts the joint from 0 to 4 in a second, and raises the weight from 0 to 1.
pub(crate) fn bound_and_free() -> Result<(TempDir, PathBuf), Box<dyn Error>> {
    let dir = tempdir()?;
    let meshes = [RawMesh::triangle("Bound"), RawMesh::triangle("Free")];
    let path = write_gltf(dir.path(), "two.gltf", &meshes)?;
    let mut gltf: Value = serde_json::from_slice(&std::fs::read(&path)?)?;
    // Key times 0 and 1, translations by 0 and by 4 along z, weights 0 and 1, joints 0, and joint weights of 255, 0, 0, 0.
    let mut add = |uri: &str, length: usize, accessor: Value| {
        let list = |gltf: &mut Value, name: &str, value: Value| {
            let list = gltf[name].as_array_mut().expect("the file has this list");
            list.push(value);
            list.len() - 1
        };
        let uri = format!("data:application/octet-stream;base64,{uri}");
        let buffer = list(&mut gltf, "buffers", json!({"uri": uri, "byteLength": length}));
        let view = list(
            &mut gltf,
            "bufferViews",
            json!({"buffer": buffer, "byteLength": length}),
        );
        let mut accessor = accessor;
        accessor["bufferView"] = json!(view);
        list(&mut gltf, "accessors", accessor)
    };
    let scalars = json!({"componentType": 5126, "type": "SCALAR", "count": 2});
    let ramp = add("AAAAAAAAgD8=", 8, scalars);
    let vectors = json!({"componentType": 5126, "type": "VEC3", "count": 2});
    let lift = add(&("AAAA".repeat(7) + "AIBA"), 24, vectors);
    let joints = add(
        &"AAAA".repeat(4),
        12,
        json!({"componentType": 5121, "type": "VEC4", "count": 3}),
    );
    let weights = json!({"componentType": 5121, "type": "VEC4", "count": 3, "normalized": true});
    let weights = add("/wAAAP8AAAD/AAAA", 12, weights);
    let attributes = &mut gltf["meshes"][0]["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (json!(joints), json!(weights));
    gltf["nodes"] = json!([
        {"children": [1], "translation": [10, 0, 0]},
        {"name": "lift"},
        {"mesh": 0, "skin": 0},
        {"mesh": 1},
    ]);
    gltf["skins"] = json!([{"joints": [1]}]);
    gltf["animations"] = json!([{
        "name": "rise",
        "channels": [
            {"sampler": 0, "target": {"node": 1, "path": "translation"}},
            {"sampler": 1, "target": {"node": 2, "path": "weights"}},
        ],
        "samplers": [{"input": ramp, "output": lift}, {"input": ramp, "output": ramp}],
    }]);
    std::fs::write(&path, gltf.to_string())?;
    Ok((dir, path))
}
