//! Runs the binary, and writes small input files for it.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

/// An error of the test itself fails it with the error's message.
pub(crate) type TestResult = Result<(), Box<dyn Error>>;

/// `assets/` at the root of the repository.
pub(crate) fn asset(path: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets")).join(path)
}

/// The small models of these tests.
pub(crate) fn data(path: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data")).join(path)
}

/// A file of the reader's tests that shows one habit of exporters.
pub(crate) fn field(name: &str) -> PathBuf {
    let field = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../morph_collision_testkit/tests/gltf/data/field"
    );
    Path::new(field).join(name)
}

/// A command that runs the binary.
pub(crate) fn command() -> Command {
    Command::new(env!("CARGO_BIN_EXE_morph-collide"))
}

/// Runs the binary to its end.
pub(crate) fn morph_collide<S: AsRef<std::ffi::OsStr>>(
    args: impl IntoIterator<Item = S>,
) -> Result<Output, Box<dyn Error>> {
    Ok(command().args(args).output()?)
}

/// A run's stderr without progress lines; slow machines print more of those.
fn complaints_of(output: &Output) -> String {
    let stderr = String::from_utf8_lossy(&output.stderr);
    let lines = stderr.split_inclusive('\n');
    lines
        .filter(|line| !line.starts_with("morph-collide: progress: "))
        .collect()
}

/// The stdout of a run that must have succeeded without a complaint.
pub(crate) fn stdout_of(output: &Output) -> String {
    let stderr = complaints_of(output);
    assert!(
        output.status.success() && stderr.is_empty(),
        "{:?}: {stderr}",
        output.status
    );
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The complaint of a run that must have failed: exit code 2 and one line that starts with the
/// program's name.
pub(crate) fn error_of(output: &Output) -> String {
    let stderr = complaints_of(output);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.starts_with("morph-collide: error: "), "{stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    stderr
}

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

/// Writes a scene made of any JSON into `dir`.
pub(crate) fn write_scene(dir: &Path, scene: &Value) -> Result<PathBuf, Box<dyn Error>> {
    let path = dir.join("scene.json");
    std::fs::write(&path, scene.to_string())?;
    Ok(path)
}
