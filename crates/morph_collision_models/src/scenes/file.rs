//! The JSON scene format: models, and their placements and weights frame by frame.
//!
//! ```json
//! {
//!   "version": 1,
//!   "bodies": [ {"model": "a.glb"}, {"model": "b.glb", "mesh": 1} ],
//!   "frames": [
//!     [ {"weights": {"jawOpen": 0.5}}, {"rotation": [0, 0, 0, 1], "translation": [1, 0, 0], "scale": [1, 2, 1]} ]
//!   ]
//! }
//! ```
//!
//! The repository's `docs/scene.md` describes every key, and `docs/scene.schema.json` is a JSON schema.

use std::io::Read;
use std::path::{Path, PathBuf};

use glam::{Affine3A, Quat, Vec3};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::SceneError;
use crate::gltf::read::is_lfs_pointer;
use crate::memory::{self, MemoryBudget};
use crate::weight_list::WeightList;

/// Models, and their states in every frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Where the JSON schema is. Only editors read it.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// The version of the format.
    #[serde(default)]
    pub version: SceneVersion,
    /// A name, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// A comment, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comment: Option<String>,
    /// The bodies.
    pub bodies: Vec<SceneBody>,
    /// One state per body, in the order of `bodies`, for every frame.
    pub frames: Vec<Vec<BodyState>>,
}

/// The only version of the format; other numbers are refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneVersion;

impl SceneVersion {
    const NUMBER: u64 = 1;
}

impl Serialize for SceneVersion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(Self::NUMBER)
    }
}

impl<'de> Deserialize<'de> for SceneVersion {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match u64::deserialize(deserializer)? {
            Self::NUMBER => Ok(Self),
            other => Err(D::Error::custom(format_args!(
                "this is a scene of version {other}, and only version {} can be read",
                Self::NUMBER
            ))),
        }
    }
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
    /// The node of the model that shows the mesh. If it is given, a mesh without joints is first placed where the node is, at rest or as
    /// a clip moves it, and the node's skin, default weights and clips count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<usize>,
    /// Which of the node's instances.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instance: Option<usize>,
    /// A name, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// A comment, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comment: Option<String>,
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
    /// One weight per target, or weights by name. Targets without a weight have that of the clip, or without a clip their default
    /// weight.
    #[serde(default, skip_serializing_if = "WeightList::is_empty")]
    pub weights: WeightList,
    /// A unit quaternion `x, y, z, w`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f32; 4]>,
    /// The model's origin in world space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub translation: Option<[f32; 3]>,
    /// Factors along the model's axes; 0 and negative factors are allowed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f32; 3]>,
    /// The name of a clip of the model, or of a clip of another file: `FILE#NAME`, relative to the scene's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clip: Option<String>,
    /// The time in the clip, in seconds; 0 by default. The first pose holds before the clip, and the last one after it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f32>,
    /// A comment, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comment: Option<String>,
}

impl BodyState {
    /// A state from weights and a rigid placement; the scale is left out.
    pub fn rigid(weights: &[f32], world_from_model: &Affine3A) -> Self {
        let (_, rotation, translation) = world_from_model.to_scale_rotation_translation();
        // Six digits are enough and keep files small.
        let round6 = |value: f32| crate::generated::round6(f64::from(value));
        Self {
            weights: WeightList::All(weights.to_vec()),
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

    /// All numbers with the names of their lists in the format, and their indices there.
    fn numbers(&self) -> impl Iterator<Item = (&'static str, usize, f32)> {
        let placement = [
            ("rotation", self.rotation.as_ref().map_or(&[][..], |list| list)),
            ("translation", self.translation.as_ref().map_or(&[][..], |list| list)),
            ("scale", self.scale.as_ref().map_or(&[][..], |list| list)),
            ("time", self.time.as_slice()),
        ];
        let placement = placement.into_iter().flat_map(|(what, list)| {
            let indexed = list.iter().enumerate();
            indexed.map(move |(index, &value)| (what, index, value))
        });
        let weights = self.weights.values().enumerate();
        weights.map(|(index, value)| ("weights", index, value)).chain(placement)
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
        Self::read_from(file, path, memory_limit)
    }

    /// Like [`Scene::read_within`], from an open file or pipe. Paths of models are relative to `path`, which need not exist.
    ///
    /// # Errors
    /// See [`Scene::read`].
    pub fn read_from(source: impl Read, path: &Path, memory_limit: u64) -> Result<Self, SceneError> {
        let mut json = Vec::new();
        // A buffer that grows while reading takes up to twice its length, and as much again once parsed.
        let read = source.take((memory_limit / 4).saturating_add(1)).read_to_end(&mut json);
        read.map_err(|source| SceneError::Io {
            path: path.to_owned(),
            source,
        })?;
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
