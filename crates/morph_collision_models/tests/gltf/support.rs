//! Hand-built glTF files for the reader's tests: a `.gltf` with a `.bin` beside it, valid or broken as the test
//! needs.

use std::path::{Path, PathBuf};

use morph_collision_models::gltf::read::{GltfFile, ReadError, ReadOptions, read_meshes};
use morph_collision_models::mesh::MorphMesh;
use serde_json::{Value, json};
use tempfile::TempDir;

pub(crate) const U8: u32 = 5121;
pub(crate) const U16: u32 = 5123;
pub(crate) const I16: u32 = 5122;
pub(crate) const U32: u32 = 5125;
pub(crate) const F32: u32 = 5126;

/// A document to which accessors are added. A test can change `json` in any way before it is read.
pub(crate) struct Document {
    pub(crate) json: Value,
    pub(crate) bin: Vec<u8>,
}

impl Document {
    pub(crate) fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"},
            "buffers": [], "bufferViews": [], "accessors": [], "meshes": [], "nodes": [], "animations": []
        });
        Self { json, bin: Vec::new() }
    }

    /// A document with one mesh "m" of one primitive: a unit square as two triangles, with targets that lift it.
    pub(crate) fn square(targets: usize) -> Self {
        let mut document = Self::new();
        let positions = document.floats("VEC3", &[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.]);
        let indices = document.accessor(U16, "SCALAR", 6, &[0, 0, 1, 0, 2, 0, 0, 0, 2, 0, 3, 0]);
        let lift = document.floats("VEC3", &[0., 0., 1.].repeat(4));
        document.mesh("m", vec![primitive(positions, Some(indices), &vec![lift; targets])]);
        document
    }

    pub(crate) fn mesh(&mut self, name: &str, primitives: Vec<Value>) {
        self.list("meshes")
            .push(json!({"name": name, "primitives": primitives}));
    }

    pub(crate) fn floats(&mut self, shape: &str, values: &[f32]) -> usize {
        let width = match shape {
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => 1,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(F32, shape, values.len() / width, &bytes)
    }

    pub(crate) fn accessor(&mut self, kind: u32, shape: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessors = self.list("accessors");
        accessors.push(json!({"bufferView": view, "componentType": kind, "type": shape, "count": count}));
        accessors.len() - 1
    }

    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let views = self.list("bufferViews");
        views.push(json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}));
        views.len() - 1
    }

    /// Adds an animation "a" of the weights of a new node that shows mesh 0.
    pub(crate) fn animate(&mut self, interpolation: &str, times: &[f32], weights: &[f32]) {
        let (input, output) = (self.floats("SCALAR", times), self.floats("SCALAR", weights));
        self.list("nodes").push(json!({"mesh": 0}));
        let node = self.list("nodes").len() - 1;
        self.list("animations").push(json!({
            "name": "a",
            "channels": [{"sampler": 0, "target": {"node": node, "path": "weights"}}],
            "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
        }));
    }

    pub(crate) fn list(&mut self, name: &str) -> &mut Vec<Value> {
        self.json[name].as_array_mut().expect("the document has this list")
    }

    /// Writes the files and reads them.
    pub(crate) fn read(self) -> Result<Vec<MorphMesh>, ReadError> {
        let (_directory, path) = self.save();
        read_meshes(&path)
    }

    /// Writes the files and opens them with default options.
    pub(crate) fn open(self) -> Result<(TempDir, GltfFile), ReadError> {
        let (directory, path) = self.save();
        Ok((directory, GltfFile::open(&path, &ReadOptions::default())?))
    }

    /// Writes the files.
    pub(crate) fn save(mut self) -> (TempDir, PathBuf) {
        if self.list("buffers").is_empty() {
            let length = self.bin.len();
            self.list("buffers")
                .push(json!({"byteLength": length, "uri": "model%2Ebin"}));
        }
        let (directory, path) = write(self.json.to_string().as_bytes(), "model.gltf");
        std::fs::write(directory.path().join("model.bin"), &self.bin).expect("a temporary file can be written");
        (directory, path)
    }

    /// The error message of reading it.
    pub(crate) fn error(self) -> String {
        match self.read() {
            Ok(meshes) => panic!("accepted: {meshes:?}"),
            Err(error) => error.to_string(),
        }
    }
}

/// A file of `data/field`, which `data/README.md` describes.
pub(crate) fn field(name: &str) -> PathBuf {
    let directory = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/gltf/data/field"));
    directory.join(format!("{name}.glb"))
}

/// A primitive of triangles.
pub(crate) fn primitive(positions: usize, indices: Option<usize>, targets: &[usize]) -> Value {
    let targets: Vec<Value> = targets.iter().map(|target| json!({"POSITION": target})).collect();
    let mut primitive = json!({"attributes": {"POSITION": positions}, "targets": targets});
    if let Some(indices) = indices {
        primitive["indices"] = json!(indices);
    }
    primitive
}

/// Writes a file of these bytes in a directory that lives as long as the first value.
pub(crate) fn write(bytes: &[u8], name: &str) -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().expect("a temporary directory can be made");
    let path = directory.path().join(name);
    std::fs::write(&path, bytes).expect("a temporary file can be written");
    (directory, path)
}
