//! The JSON scene format: models, and their placements and weights frame by frame.
//!
//! ```json
//! {
//!   "bodies": [ {"model": "a.glb"}, {"model": "b.glb", "mesh": 1} ],
//!   "frames": [
//!     [ {"weights": [0.5]}, {"rotation": [0, 0, 0, 1], "translation": [1, 0, 0], "scale": [1, 2, 1]} ]
//!   ]
//! }
//! ```
//!
//! Paths of models are relative to the scene's file. `mesh` is an index into the model's meshes, 0 by default. Rotations are unit
//! quaternions `x, y, z, w`. Anything left out is the identity; weights left out are zero.
//!
//! A state may name a clip of the model and a time in seconds: `{"clip": "walk", "time": 0.5}`. The clip moves the joints of a
//! skinned mesh; without a clip they are at rest. It also sets the weights if they are left out. The placement applies on top of
//! the joints.

use std::io::Read;
use std::path::{Path, PathBuf};

use glam::{Affine3A, Quat, Vec3};
use serde::{Deserialize, Serialize};

use super::SceneError;
use crate::memory::{self, MemoryBudget};

/// Models, and their states in every frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The bodies.
    pub bodies: Vec<SceneBody>,
    /// One state per body, in the order of `bodies`, for every frame.
    pub frames: Vec<Vec<BodyState>>,
}

/// A body: a mesh of a model file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneBody {
    /// The model's file, relative to the scene's; see [`SceneBody::model_path`].
    pub model: PathBuf,
    /// The mesh's index in the model.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub mesh: usize,
}

impl SceneBody {
    /// The model's path for a scene read from `scene_path`.
    pub fn model_path(&self, scene_path: &Path) -> PathBuf {
        scene_path.parent().unwrap_or(Path::new("")).join(&self.model)
    }
}

/// A body's placement and shape in one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyState {
    /// One weight per target. Empty means the clip's weights, or all zero without a clip.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub weights: Vec<f32>,
    /// A unit quaternion `x, y, z, w`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f32; 4]>,
    /// The model's origin in world space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub translation: Option<[f32; 3]>,
    /// Factors along the model's axes; 0 and negative factors are allowed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f32; 3]>,
    /// The name of a clip of the model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clip: Option<String>,
    /// The time in the clip, in seconds; 0 by default. Clips loop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f32>,
}

impl BodyState {
    /// A state from weights and a rigid placement; the scale is left out.
    pub fn rigid(weights: &[f32], world_from_model: &Affine3A) -> Self {
        let (_, rotation, translation) = world_from_model.to_scale_rotation_translation();
        // Six digits are enough and keep files small.
        let round6 = |value: f32| crate::models::round6(f64::from(value));
        Self {
            weights: weights.to_vec(),
            rotation: Some(rotation.to_array().map(round6)),
            translation: Some(translation.to_array().map(round6)),
            ..Self::default()
        }
    }

    /// Scale, then rotation (normalized), then translation.
    pub fn world_from_model(&self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(
            self.scale.map_or(Vec3::ONE, Vec3::from_array),
            self.rotation
                .map_or(Quat::IDENTITY, |xyzw| Quat::from_array(xyzw).normalize()),
            self.translation.map_or(Vec3::ZERO, Vec3::from_array),
        )
    }

    /// The lists of numbers with their names in the format.
    fn numbers(&self) -> [(&'static str, &[f32]); 5] {
        [
            ("weights", &self.weights),
            ("rotation", self.rotation.as_ref().map_or(&[], |list| list)),
            ("translation", self.translation.as_ref().map_or(&[], |list| list)),
            ("scale", self.scale.as_ref().map_or(&[], |list| list)),
            ("time", self.time.as_slice()),
        ]
    }
}

impl Scene {
    /// Reads and checks a scene. Models are not opened, so the number of weights is not checked here.
    ///
    /// # Errors
    /// [`SceneError`] names the file, and line and column, or frame and body.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        Self::read_within(path, memory::DEFAULT_LIMIT)
    }

    /// Like [`Scene::read`], with another memory limit in bytes.
    ///
    /// # Errors
    /// See [`Scene::read`].
    pub fn read_within(path: &Path, memory_limit: u64) -> Result<Self, SceneError> {
        let io = |source| SceneError::Io {
            path: path.to_owned(),
            source,
        };
        let file = std::fs::File::open(path).map_err(io)?;
        let mut json = Vec::new();
        // A buffer that grows while reading takes up to twice its length, and as much again once parsed.
        file.take((memory_limit / 4).saturating_add(1))
            .read_to_end(&mut json)
            .map_err(io)?;
        Self::parse_within(&json, path, memory_limit)
    }

    /// Like [`Scene::read`], from bytes. `path` is only for messages.
    ///
    /// # Errors
    /// See [`Scene::read`].
    pub fn parse(json: &[u8], path: &Path) -> Result<Self, SceneError> {
        Self::parse_within(json, path, memory::DEFAULT_LIMIT)
    }

    fn parse_within(json: &[u8], path: &Path, memory_limit: u64) -> Result<Self, SceneError> {
        // An upper bound: a body's state for each bracket and a number for each comma, while lists grow.
        let bytes = |byte: &u8| match byte {
            b'{' | b'[' => 256,
            b',' => 16,
            _ => 4,
        };
        let budget = MemoryBudget::new(memory_limit);
        let take = budget.take(json.iter().map(bytes).sum(), 1, || "the scene".into());
        take.map_err(|over| SceneError::OverBudget {
            path: path.to_owned(),
            over,
        })?;
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
        self.check(path)?;
        let json = self.to_json().map_err(|source| SceneError::Json {
            path: path.to_owned(),
            source,
        })?;
        std::fs::write(path, json).map_err(|source| SceneError::Io {
            path: path.to_owned(),
            source,
        })
    }

    fn to_json(&self) -> serde_json::Result<String> {
        Ok(format!(
            "{{\n  \"bodies\": [{}],\n  \"frames\": [{}]\n}}\n",
            lines(&self.bodies)?,
            lines(&self.frames)?
        ))
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
                for (what, list) in state.numbers() {
                    if let Some(index) = list.iter().position(|value| !value.is_finite()) {
                        let value = list[index];
                        return Err(SceneError::NotFinite {
                            path: path(),
                            frame,
                            body,
                            what,
                            index,
                            value,
                        });
                    }
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

// Serde passes the field by reference.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature is serde's")]
fn is_zero(value: &usize) -> bool {
    *value == 0
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let scene = Scene {
            bodies: vec![
                SceneBody {
                    model: "a.glb".into(),
                    mesh: 2,
                },
                SceneBody::default(),
            ],
            frames: vec![vec![BodyState::rigid(&[0.1, 0.7], &place), BodyState::default()]; 3],
        };
        let read = Scene::parse(scene.to_json()?.as_bytes(), Path::new("scene.json"))?;
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
            weights: vec![0.0, f32::NAN],
            ..BodyState::default()
        };
        let scene = Scene {
            bodies: vec![SceneBody::default(); 2],
            frames: vec![vec![BodyState::default(), broken]],
        };
        let error = scene
            .write(Path::new("no/such/directory/scene.json"))
            .err()
            .map(|error| error.to_string());
        assert!(error.is_some_and(|error| error.contains("frame 0, body 1: weights 1 is NaN")));
    }
}
