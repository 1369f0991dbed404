//! Scenes whose meshes become colliders automatically.

use super::collider::MorphCollider;
use super::layers::MorphCollisionLayers;
use bevy::prelude::*;

/// Turns the meshes below this entity into [`MorphCollider`]s: by default those that deform. Put it on the root of a scene; all its
/// colliders become parts of one body.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     commands.spawn((
///         WorldAssetRoot(assets.load("face.glb#Scene0")),
///         MorphColliderScene { only_named: vec!["Mouth".into()], ..default() },
///     ));
/// }
/// # App::new().add_systems(Startup, spawn);
/// ```
///
/// The body is the entity with this component. Observe [`MorphBodyCollisionStart`](crate::events::MorphBodyCollisionStart) and
/// [`MorphBodyCollisionEnd`](crate::events::MorphBodyCollisionEnd) on it, or add
/// [`MorphCollidingEntities`](crate::events::MorphCollidingEntities) to it.
///
/// It works with scenes spawned from an asset (`WorldAssetRoot`) and with entities spawned by hand. Either the component or the
/// meshes can come first, and meshes that appear later are found too. Parts of one body never collide with each other.
///
/// If the scene makes no colliders, or a name in [`only_named`](Self::only_named) matches nothing, a warning in the log says why: for a
/// scene from an asset when it is spawned, otherwise after some seconds.
///
/// You can edit or re-insert the component at any time. Meshes that no longer match stop being parts, and meshes that now match
/// become parts. Removing the component turns all parts back into ordinary meshes.
///
/// Components that you put on a part stay yours:
///
/// - A mesh that already has a [`MorphCollider`] joins the body, whatever its name, and keeps its collider, layers and events.
///   The scene also keeps [`MorphCollisionLayers`], [`MorphColliderOf`](crate::components::MorphColliderOf) and [`MorphCollisionEventsEnabled`](crate::components::MorphCollisionEventsEnabled) that were there
///   first.
/// - If you change or remove a component that the scene added, later edits of the scene do not touch it.
/// - When a part leaves the scene, what the scene added is removed: the collider even if you changed it since, but layers and
///   body only if you did not.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct MorphColliderScene {
    /// The collider of each part.
    pub collider: MorphCollider,
    /// The layers of each part.
    pub layers: MorphCollisionLayers,
    /// Leaves out rigid meshes, which have neither [`MeshMorphWeights`](bevy::mesh::morph::MeshMorphWeights) nor [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh).
    pub only_deforming: bool,
    /// If not empty, only meshes with one of these [`Name`]s, or below an entity of the scene with one of these names, become
    /// parts. In a glTF scene, a node's name is on the entity above its meshes.
    pub only_named: Vec<String>,
    /// Whether the parts get [`MorphCollisionEventsEnabled`](crate::components::MorphCollisionEventsEnabled).
    pub events: bool,
}

impl Default for MorphColliderScene {
    fn default() -> Self {
        Self {
            collider: MorphCollider::default(),
            layers: MorphCollisionLayers::default(),
            only_deforming: true,
            only_named: Vec::new(),
            events: false,
        }
    }
}
