//! Meshes whose bounds this plugin updates.

use bevy::camera::visibility::{NoAutoAabb, NoFrustumCulling};
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

/// Meshes whose bounds this plugin updates.
pub(super) type Culled = (
    Or<(With<MeshMorphWeights>, With<SkinnedMesh>)>,
    Without<NoAutoAabb>,
    Without<NoFrustumCulling>,
);
