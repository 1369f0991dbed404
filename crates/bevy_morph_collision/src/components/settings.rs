//! Settings for the whole app.

use bevy::prelude::*;

use super::collider::MorphCollider;
use super::tree_options::MorphTreeOptions;

/// Settings for the whole app. You can change them at any time.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # let mut app = App::new();
/// app.insert_resource(MorphCollisionSettings {
///     every_deforming_mesh: Some(MorphCollider::default()),
///     ..default()
/// });
/// ```
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphCollisionSettings {
    /// Pauses collision detection: contacts stay as they are, nothing starts or ends, and spatial queries answer from the last
    /// run. Surface anchors and morphed bounds keep following what is drawn.
    pub paused: bool,
    /// Makes every mesh that is deformed by morph weights or joints a collider like this one.
    ///
    /// The body of such a collider is the nearest entity at or above it that is one of these:
    ///
    /// - an entity with [`MorphBodyRoot`](crate::components::MorphBodyRoot) or [`MorphColliderScene`](crate::components::MorphColliderScene);
    /// - the root of a scene from a glTF file, an entity with `WorldAssetRoot` (feature `gltf`).
    ///
    /// If there is none, the body is the root of the mesh's skeleton, so that all meshes of a character form one body. For a mesh
    /// without joints it is the entity whose `MorphWeights` it follows, or the mesh itself. An ordinary parent, such as the root
    /// of a level, is never a body. If a whole level is one glTF file, put [`MorphBodyRoot`](crate::components::MorphBodyRoot) on its
    /// characters. Bodies update when you add or remove these components or move meshes in the hierarchy.
    ///
    /// Meshes that are already colliders stay as they are, and a [`MorphColliderScene`](crate::components::MorphColliderScene) decides about
    /// its own parts. When you change this value, the colliders it created follow, except those that you changed yourself. A
    /// collider that you removed does not come back. `None` removes all colliders that this setting created, even if you changed
    /// them since, and keeps all others.
    pub every_deforming_mesh: Option<MorphCollider>,
    /// The maximum number of triangle pairs that one contact lists, and from which mode
    /// [`Contacts`](crate::components::MorphCollisionMode::Contacts) computes its points. [`MorphContact::is_truncated`](crate::contacts::MorphContact)
    /// tells you if there are more. At least one pair is always listed, and the limit never affects whether colliders touch.
    /// Changing it compares all pairs again.
    ///
    /// The default, 8192, is more than twice what two meshes of 20,480 triangles list while they pass through each other (3172 at
    /// most). It limits the cost of frames in which bodies touch everywhere, such as two bodies scaled to a point.
    #[reflect(@1..=usize::MAX)]
    pub max_triangle_pairs: usize,
    /// Leaves out the bad triangles of a mesh instead of refusing the mesh. Off by default.
    ///
    /// Bad are triangles with a corner that is no vertex, or whose vertex has a position, a displacement or a joint weight that is not a
    /// number or too large, or a weight of a joint that does not exist. The log says once for each mesh how many are left out and why, and
    /// [`MorphTrees::left_out`](crate::import::MorphTrees::left_out) returns it. The other triangles are numbered without those that are left out.
    ///
    /// When you change this value, the meshes with bad triangles are read again.
    pub skip_bad_triangles: bool,
    /// How the trees of all meshes are built, except those of colliders with their own [`MorphTreeOptions`].
    pub tree_options: MorphTreeOptions,
}

impl Default for MorphCollisionSettings {
    fn default() -> Self {
        Self {
            paused: false,
            every_deforming_mesh: None,
            max_triangle_pairs: 8192,
            skip_bad_triangles: false,
            tree_options: MorphTreeOptions::default(),
        }
    }
}

impl MorphCollisionSettings {
    /// At least 1: a contact needs a triangle pair.
    pub(crate) fn list_limit(&self) -> usize {
        self.max_triangle_pairs.max(1)
    }
}

/// Whether the plugin's systems run.
pub(crate) fn is_running(settings: Res<MorphCollisionSettings>) -> bool {
    !settings.paused
}
