//! Makes every deforming mesh a collider: [`MorphCollisionSettings::every_deforming_mesh`].

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::automatic::{Automatic, Present};
use super::body_roots::BodyRoots;
use super::given::should_update;
use super::scene_part::ScenePart;
use crate::components::{MorphCollider, MorphCollisionSettings, body_of, give_body};

/// Deforming meshes that the setting has not been applied to. Scenes handle their own parts.
type New = (
    With<Mesh3d>,
    Or<(With<MeshMorphWeights>, With<SkinnedMesh>)>,
    Without<Automatic>,
    Without<ScenePart>,
    Allow<Disabled>,
);

/// Applies the setting to new meshes, and to all meshes when the setting changes.
///
/// The bodies of meshes follow the hierarchy and the components that make an entity a body.
pub(crate) fn update_every_deforming_mesh(
    mut commands: Commands,
    settings: Res<MorphCollisionSettings>,
    new: Query<(Entity, Present), New>,
    mut known: Query<(Entity, &mut Automatic, Present), Allow<Disabled>>,
    mut roots: BodyRoots,
    mut applied: Local<Option<MorphCollider>>,
) {
    let wanted = settings.every_deforming_mesh;
    let is_same = match (&wanted, &*applied) {
        (Some(wanted), Some(applied)) => wanted.is_same(applied),
        (None, None) => true,
        _ => false,
    };
    if !is_same {
        *applied = wanted;
        for (entity, mut automatic, has) in &mut known {
            let mut entity = commands.entity(entity);
            match (wanted, &mut automatic.collider) {
                (None, _) => automatic.take_back(entity, &has),
                (Some(wanted), Some(given)) => {
                    if should_update(false, given, has.collider, wanted, MorphCollider::is_same) {
                        entity.try_insert(wanted);
                    }
                }
                (Some(_), None) => {}
            }
        }
    }
    let Some(collider) = wanted else { return };
    let unsettled = roots.unsettled();
    let root_of = roots.finder();
    for mesh in unsettled {
        let Ok((mesh, mut automatic, has)) = known.get_mut(mesh) else {
            continue;
        };
        let Some(given) = &mut automatic.body else { continue };
        let root = root_of(mesh);
        if should_update(false, given, Some(&body_of(mesh, has.body)), root, PartialEq::eq) {
            give_body(&mut commands.entity(mesh), root);
        }
    }
    for (mesh, has) in &new {
        let mut entity = commands.entity(mesh);
        if has.collider.is_some() {
            entity.try_insert(Automatic::default());
            continue;
        }
        let body = has.body.is_none().then(|| root_of(mesh));
        entity.try_insert((
            collider,
            Automatic {
                collider: Some(collider),
                layers: has.layers.is_none(),
                body,
            },
        ));
        if let Some(body) = body {
            give_body(&mut entity, body);
        }
    }
}
