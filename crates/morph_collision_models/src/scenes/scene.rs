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

use std::path::{Path, PathBuf};

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::body_state::BodyState;

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

// Serde passes the field by reference.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature is serde's")]
fn is_zero(value: &usize) -> bool {
    *value == 0
}
