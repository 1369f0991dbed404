//! Reads and writes scene files.

use std::io::Read;
use std::path::Path;

use glam::Quat;
use serde::Serialize;

use super::error::SceneError;
use super::scene::Scene;
use crate::gltf::read::is_lfs_pointer;
use crate::memory::{self, FileFault, MemoryBudget};

impl Scene {
    /// Reads and checks a scene. Models are not opened, so the number of weights is not checked here.
    ///
    /// # Errors
    /// [`SceneError`] names the file, and line and column, or frame and body.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        Self::read_within(path, false, &MemoryBudget::default())
    }

    /// Like [`Scene::read`], with a budget that can be shared with the scene's models. The file may be a device or a pipe with `any_path`.
    ///
    /// # Errors
    /// See [`Scene::read`].
    pub fn read_within(path: &Path, any_path: bool, budget: &MemoryBudget) -> Result<Self, SceneError> {
        let (file, length) = memory::open_file(path, any_path).map_err(|fault| read_error(fault, path))?;
        Self::parse_within(&read_text(file, length, path, budget)?, path, budget)
    }

    /// Like [`Scene::read_within`], from a stream. Paths of models are relative to `path`, which need not exist.
    ///
    /// # Errors
    /// See [`Scene::read`].
    pub fn read_from(source: impl Read, path: &Path, budget: &MemoryBudget) -> Result<Self, SceneError> {
        Self::parse_within(&read_text(source, None, path, budget)?, path, budget)
    }

    /// Like [`Scene::read`], from bytes. `path` is only for messages.
    ///
    /// # Errors
    /// See [`Scene::read`].
    pub fn parse(json: &[u8], path: &Path) -> Result<Self, SceneError> {
        Self::parse_within(json, path, &MemoryBudget::default())
    }

    fn parse_within(json: &[u8], path: &Path, budget: &MemoryBudget) -> Result<Self, SceneError> {
        let take = budget.take(bytes_of(json), 1, || "the scene".into());
        take.map_err(|over| SceneError::OverBudget {
            path: path.to_owned(),
            over,
        })?;
        if is_lfs_pointer(json) {
            let path = path.to_owned();
            return Err(SceneError::LfsPointer { path });
        }
        let scene: Self = serde_json::from_slice(json).map_err(|source| SceneError::Json {
            path: path.to_owned(),
            source,
        })?;
        scene.check(path)?;
        Ok(scene)
    }

    /// Writes the scene, one line per body and per frame.
    ///
    /// # Errors
    /// The scene would be refused by [`Scene::read`], or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), SceneError> {
        let json = self.to_json(path)?;
        std::fs::write(path, json).map_err(|source| SceneError::Io {
            path: path.to_owned(),
            source,
        })
    }

    /// Its JSON, one line per body and per frame.
    ///
    /// # Errors
    /// The scene would be refused by [`Scene::read`]; the message names `path`.
    pub fn to_json(&self, path: &Path) -> Result<String, SceneError> {
        self.check(path)?;
        self.json().map_err(|source| SceneError::Json {
            path: path.to_owned(),
            source,
        })
    }

    fn json(&self) -> serde_json::Result<String> {
        let mut text = "{\n".to_owned();
        if let Some(schema) = &self.schema {
            text += &format!("  \"$schema\": {},\n", serde_json::to_string(schema)?);
        }
        text += &format!("  \"version\": {},\n", serde_json::to_string(&self.version)?);
        for (key, value) in [("name", &self.name), ("comment", &self.comment)] {
            if let Some(value) = value {
                text += &format!("  \"{key}\": {},\n", serde_json::to_string(value)?);
            }
        }
        text += &format!("  \"bodies\": [{}],\n", lines(&self.bodies)?);
        text += &format!("  \"frames\": [{}]\n}}\n", lines(&self.frames)?);
        Ok(text)
    }

    fn check(&self, path: &Path) -> Result<(), SceneError> {
        let path = || path.to_owned();
        for (frame, states) in self.frames.iter().enumerate() {
            let (found, expected) = (states.len(), self.bodies.len());
            if found != expected {
                return Err(SceneError::FrameLength {
                    path: path(),
                    frame,
                    found,
                    expected,
                });
            }
            for (body, state) in states.iter().enumerate() {
                if let Some((what, index, value)) = state.numbers().find(|(_, _, value)| !value.is_finite()) {
                    return Err(SceneError::NotFinite {
                        path: path(),
                        frame,
                        body,
                        what,
                        index,
                        value,
                    });
                }
                let length = state.rotation.map_or(1.0, |xyzw| Quat::from_array(xyzw).length());
                if !(0.99..=1.01).contains(&length) {
                    return Err(SceneError::Rotation {
                        path: path(),
                        frame,
                        body,
                        length,
                    });
                }
            }
        }
        Ok(())
    }
}

fn read_text(
    source: impl Read,
    length: Option<u64>,
    path: &Path,
    budget: &MemoryBudget,
) -> Result<Vec<u8>, SceneError> {
    let most = budget.left() / BYTES_PER_BYTE;
    memory::read_at_most(source, length, most).map_err(|fault| read_error(fault, path))
}

fn read_error(fault: FileFault, path: &Path) -> SceneError {
    let path = path.to_owned();
    match fault {
        FileFault::NotRegular => SceneError::NotRegular { path },
        FileFault::Io(source) => SceneError::Io { path, source },
        FileFault::TooLong { most } => SceneError::TooLong { path, most },
    }
}

/// The text while its buffer grows, or the text and the names in it.
const BYTES_PER_BYTE: u64 = 4;

/// An upper bound on the memory that a scene takes while it is read: the text and what is made of it. A list that grows takes three times
/// the size of its elements for a moment, and a list of one element takes room for four.
fn bytes_of(json: &[u8]) -> u64 {
    let mut before = b' ';
    let mut sum = 0;
    for &byte in json.iter().filter(|byte| !byte.is_ascii_whitespace()) {
        sum += match (before, byte) {
            // The first body, or the first state of a frame.
            (b'[', b'{') => 1024,
            (_, b'{') => 512,
            // A frame, or a list of numbers.
            (_, b'[') => 128,
            // A weight with its name, also in the list of names that is searched for those given twice.
            (b':', b'-' | b'0'..=b'9') => 160,
            // The smallest block that a string takes.
            (b':', b'"') => 48,
            // A number.
            (_, b',') => 16,
            _ => 0,
        };
        before = byte;
    }
    sum + BYTES_PER_BYTE * json.len() as u64
}

/// A JSON list's elements, one per line.
fn lines<T: Serialize>(elements: &[T]) -> serde_json::Result<String> {
    let mut text = String::new();
    for (index, element) in elements.iter().enumerate() {
        text += if index == 0 { "\n    " } else { ",\n    " };
        text += &serde_json::to_string(element)?;
    }
    if !elements.is_empty() {
        text += "\n  ";
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};

    use super::super::{BodyState, SceneBody};
    use super::*;
    use crate::weight_list::WeightList;

    fn message(json: &str) -> String {
        match Scene::parse(json.as_bytes(), Path::new("scene.json")) {
            Ok(scene) => panic!("accepted: {scene:?}"),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn everything_but_the_model_may_be_left_out() -> Result<(), SceneError> {
        let json = br#"{"bodies": [{"model": "models/a.glb"}], "frames": [[{}]]}"#;
        let scene = Scene::parse(json, Path::new("dir/scene.json"))?;
        assert_eq!(scene.bodies[0].mesh, 0);
        assert_eq!(
            scene.bodies[0].model_path(Path::new("dir/scene.json")),
            Path::new("dir/models/a.glb")
        );
        assert_eq!(scene.frames[0][0].world_from_model(), Affine3A::IDENTITY);
        assert!(scene.frames[0][0].weights.is_empty());
        Ok(())
    }

    #[test]
    fn a_written_scene_is_read_back() -> Result<(), Box<dyn std::error::Error>> {
        let place = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.3), Vec3::new(0.1, -2.0, 3.5));
        let named = BodyState {
            weights: WeightList::Named(vec![("jaw".into(), 0.5)]),
            comment: Some("wide open".into()),
            ..BodyState::default()
        };
        let scene = Scene {
            bodies: vec![
                SceneBody {
                    model: "a.glb".into(),
                    mesh: 2,
                    node: Some(7),
                    instance: Some(1),
                    name: Some("left \"hand\"".into()),
                    comment: Some("on the table".into()),
                },
                SceneBody::default(),
            ],
            frames: vec![vec![BodyState::rigid(&[0.1, 0.7], &place), named]; 3],
            schema: Some("docs/scene.schema.json".into()),
            name: Some("two".into()),
            comment: Some("a test".into()),
            ..Scene::default()
        };
        let path = Path::new("scene.json");
        let read = Scene::parse(scene.to_json(path)?.as_bytes(), path)?;
        assert_eq!(read, scene);
        assert!(read.frames[0][0].world_from_model().abs_diff_eq(place, 1e-5));
        Ok(())
    }

    #[test]
    fn errors_say_where() {
        let unknown = message("{\"bodies\": [],\n \"frames\": [], \"fps\": 60}");
        assert!(
            unknown.contains("scene.json") && unknown.contains("fps") && unknown.contains("line 2"),
            "{unknown}"
        );

        let newer = message("{\"version\": 2, \"bodies\": [], \"frames\": []}");
        assert!(newer.contains("version 2, and only version 1 can be read"), "{newer}");

        let twice = message(r#"{"bodies": [{"model": "a"}], "frames": [[{"weights": {"a": 1, "a": 2}}]]}"#);
        assert!(twice.contains("\"a\" is given twice"), "{twice}");

        let short = message(r#"{"bodies": [{"model": "a"}], "frames": [[{}], []]}"#);
        assert!(short.contains("frame 1 places 0 bodies, but there are 1"), "{short}");

        let infinite = message("{\"bodies\": [{\"model\": \"a\"}], \"frames\":\n [[{\"weights\": [0, 1e39]}]]}");
        assert!(infinite.contains("number out of range at line 2"), "{infinite}");

        let stretched = message(r#"{"bodies": [{"model": "a"}], "frames": [[{"rotation": [0, 0, 0, 0]}]]}"#);
        assert!(
            stretched.contains("frame 0, body 0: the rotation has length 0"),
            "{stretched}"
        );
    }

    #[test]
    fn numbers_that_json_cannot_hold_are_not_written() {
        let broken = BodyState {
            weights: WeightList::All(vec![0.0, f32::NAN]),
            ..BodyState::default()
        };
        let scene = Scene {
            bodies: vec![SceneBody::default(); 2],
            frames: vec![vec![BodyState::default(), broken]],
            ..Scene::default()
        };
        let error = scene
            .write(Path::new("no/such/directory/scene.json"))
            .err()
            .map(|error| error.to_string());
        assert!(error.is_some_and(|error| error.contains("frame 0, body 1: weights 1 is NaN")));
    }
}
