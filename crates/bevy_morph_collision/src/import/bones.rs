//! Says which colliders have bones, which collisions do not follow.

use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use tracing::warn;

use super::complaints::Complaints;
use crate::collider::MorphCollider;
use crate::shape::MorphShape;

/// Colliders whose mesh is moved by bones.
type Skinned = (With<MorphCollider>, With<SkinnedMesh>, Without<MorphShape>);

/// Warns once per mesh asset that its bones are ignored.
pub(crate) fn warn_of_bones(
    colliders: Query<(Entity, &Mesh3d), Skinned>,
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut known: Local<HashSet<AssetId<Mesh>>>,
    meshes: Res<Assets<Mesh>>,
    complaints: Complaints,
) {
    for event in events.read() {
        if let AssetEvent::Removed { id } | AssetEvent::Unused { id } = event {
            known.remove(id);
        }
    }
    for (entity, mesh) in &colliders {
        let id = mesh.id();
        if known.contains(&id) {
            continue;
        }
        let Some(mesh) = meshes.get(id) else { continue };
        known.insert(id);
        let has = |attribute| mesh.try_contains_attribute(attribute).unwrap_or(false);
        // Without these Bevy draws a mesh where its transform says.
        if has(Mesh::ATTRIBUTE_JOINT_INDEX) && has(Mesh::ATTRIBUTE_JOINT_WEIGHT) {
            warn!(
                "mesh `{}` of entity `{}` has bones, which collisions ignore: it collides as it is morphed, but in its bind pose",
                complaints.mesh(id),
                complaints.entity(entity)
            );
        }
    }
}
