//! How far a scene is that Bevy spawns from an asset.

use crate::import::ImportError;

/// How far a scene is that Bevy spawns from an asset.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(not(feature = "gltf"), allow(dead_code))]
pub(crate) enum SceneState {
    Pending,
    Spawned,
    Failed(ImportError),
}
