//! Every mesh that deforms as a collider: [`MorphCollisionSettings::every_deforming_mesh`].

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use crate::collider::{MorphBody, MorphCollider, follows};
use crate::layers::MorphCollisionLayers;
use crate::scene::ScenePart;
use crate::settings::MorphCollisionSettings;

/// On every deforming mesh that the setting was applied to: what it gave, nothing if the mesh was a collider already.
///
/// It stays when the user removes the collider, so that the collider does not come back.
#[derive(Component, Clone, Copy, Default)]
pub(crate) struct Automatic {
    collider: Option<MorphCollider>,
    layers: bool,
    body: Option<MorphBody>,
}

impl Automatic {
    /// Whether a collider is the one that it gave.
    pub(crate) fn gave_collider(&self, now: Option<&MorphCollider>) -> bool {
        self.collider.zip(now).is_some_and(|(given, now)| given.is_same(now))
    }

    /// Whether layers are those that came with the collider.
    pub(crate) fn gave_layers(&self, now: Option<&MorphCollisionLayers>) -> bool {
        self.layers && now == Some(&MorphCollisionLayers::default())
    }

    /// Whether a body is the one that it gave.
    pub(crate) fn gave_body(&self, now: Option<&MorphBody>) -> bool {
        self.body.is_some() && self.body.as_ref() == now
    }
}

/// Deforming meshes that the setting has not been applied to. Parts of scenes are the scenes' business.
type New = (
    With<Mesh3d>,
    Or<(With<MeshMorphWeights>, With<SkinnedMesh>)>,
    Without<Automatic>,
    Without<ScenePart>,
    Allow<Disabled>,
);

/// What a mesh has: a collider, layers, a body.
type Has3 = (
    Option<&'static MorphCollider>,
    Option<&'static MorphCollisionLayers>,
    Option<&'static MorphBody>,
);

/// Applies the setting to new meshes, and to all when it changes.
///
/// What hangs on one root of the hierarchy is one body.
pub(crate) fn update_every_deforming_mesh(
    mut commands: Commands,
    settings: Res<MorphCollisionSettings>,
    new: Query<(Entity, Has3), New>,
    mut known: Query<(Entity, &mut Automatic, Has3), Allow<Disabled>>,
    parents: Query<&ChildOf, Allow<Disabled>>,
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
                (None, _) => automatic.take_back(entity, has),
                (Some(wanted), Some(given)) => {
                    if follows(false, given, has.0, wanted, MorphCollider::is_same) {
                        entity.try_insert(wanted);
                    }
                }
                (Some(_), None) => {}
            }
        }
    }
    let Some(collider) = wanted else { return };
    for (entity, (has_collider, layers, body)) in &new {
        let root = MorphBody(parents.root_ancestor(entity));
        let mut entity = commands.entity(entity);
        if has_collider.is_some() {
            entity.try_insert(Automatic::default());
            continue;
        }
        entity.try_insert((
            collider,
            Automatic {
                collider: Some(collider),
                layers: layers.is_none(),
                body: body.is_none().then_some(root),
            },
        ));
        if body.is_none() {
            entity.try_insert(root);
        }
    }
}

impl Automatic {
    /// Removes what was given: the collider even if the user changed it, the rest if it is unchanged.
    fn take_back(
        &self,
        mut entity: EntityCommands,
        (collider, layers, body): (
            Option<&MorphCollider>,
            Option<&MorphCollisionLayers>,
            Option<&MorphBody>,
        ),
    ) {
        if self.collider.is_some() && collider.is_none() {
            // The user removed it: it does not come back with the setting either.
            entity.try_insert(Self::default());
        } else {
            entity.try_remove::<Self>();
        }
        if self.collider.is_some() {
            entity.try_remove::<MorphCollider>();
        }
        if self.gave_layers(layers) {
            entity.try_remove::<MorphCollisionLayers>();
        }
        if self.gave_body(body) {
            entity.try_remove::<MorphBody>();
        }
    }
}
