//! What is set for the whole app.

use bevy::prelude::*;

use crate::collider::MorphCollider;

/// What the plugin does, for the whole app. May be changed at any time.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphCollisionSettings {
    /// Whether collision detection is paused: contacts stay as they are, nothing starts or ends, and spatial queries answer
    /// from the last run. Surface anchors and morphed bounds go on following what is drawn.
    pub paused: bool,
    /// Makes every mesh that deforms, by morph weights or joints, a collider like this one.
    ///
    /// The body of such a collider is the nearest entity at or above it that is one of these:
    ///
    /// - an entity with [`MorphBodyRoot`](crate::MorphBodyRoot) or [`MorphColliderScene`](crate::MorphColliderScene);
    /// - the root of a scene from a glTF file, an entity with `WorldAssetRoot` (feature `gltf`).
    ///
    /// If there is none, the body is the root of the mesh's skeleton, so that all meshes of a character are one body. For a mesh without joints it
    /// is the entity whose `MorphWeights` it follows, or the mesh itself. An ordinary parent, such as the root of a level, is never a
    /// body. If a whole level is one glTF file, put [`MorphBodyRoot`](crate::MorphBodyRoot) on its characters. Bodies follow when you
    /// add or remove these components or move meshes in the hierarchy.
    ///
    /// A mesh that already is a collider stays as it is, and a [`MorphColliderScene`](crate::MorphColliderScene) decides about its own
    /// parts. When you change this value, the colliders that came from it follow, except those that you changed yourself.
    /// A collider that you removed does not come back. `None` removes all colliders that came from it, even if you changed
    /// them since, and keeps all others.
    pub every_deforming_mesh: Option<MorphCollider>,
    /// The most triangle pairs that one contact lists, and the most that mode
    /// [`Contacts`](crate::MorphCollisionMode::Contacts) makes its points from; [`MorphContact::is_truncated`](crate::MorphContact) tells
    /// where there are more. At least one is always listed, and whether colliders touch does not depend on it. With a new number, all
    /// pairs are compared again.
    ///
    /// The default, 8192, is more than twice what two meshes of 20,480 triangles list while they pass through each other (3172 at most).
    /// It bounds a frame in which bodies touch everywhere, such as two that were scaled to a point.
    pub max_triangle_pairs: usize,
}

impl Default for MorphCollisionSettings {
    fn default() -> Self {
        Self {
            paused: false,
            every_deforming_mesh: None,
            max_triangle_pairs: 8192,
        }
    }
}

impl MorphCollisionSettings {
    /// A contact without triangles would be none.
    pub(crate) fn list_limit(&self) -> usize {
        self.max_triangle_pairs.max(1)
    }
}

/// Whether the plugin's systems run.
pub(crate) fn is_running(settings: Res<MorphCollisionSettings>) -> bool {
    !settings.paused
}
