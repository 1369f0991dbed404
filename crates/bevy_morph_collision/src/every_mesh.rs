//! Makes every deforming mesh a collider: [`MorphCollisionSettings::every_deforming_mesh`].

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use crate::body::{MorphColliderOf, body_of, give_body};
use crate::body_roots::BodyRoots;
use crate::collider::{MorphCollider, follows};
use crate::layers::MorphCollisionLayers;
use crate::scene::ScenePart;
use crate::settings::MorphCollisionSettings;

/// Marks a deforming mesh that the setting was applied to, and records what the setting gave it: nothing if the mesh already was
/// a collider.
///
/// It stays when the user removes the collider, so that the collider does not come back.
#[derive(Component, Clone, Copy, Default)]
pub(crate) struct Automatic {
    collider: Option<MorphCollider>,
    layers: bool,
    /// The body that the setting assigned, or the mesh itself.
    body: Option<Entity>,
}

impl Automatic {
    /// Whether a collider is the one that the setting gave.
    pub(crate) fn gave_collider(&self, now: Option<&MorphCollider>) -> bool {
        self.collider.zip(now).is_some_and(|(given, now)| given.is_same(now))
    }

    /// Whether layers are those that came with the collider.
    pub(crate) fn gave_layers(&self, now: Option<&MorphCollisionLayers>) -> bool {
        self.layers && now == Some(&MorphCollisionLayers::default())
    }

    /// Whether a collider's body is the one that the setting gave.
    pub(crate) fn gave_body(&self, now: Entity) -> bool {
        self.body == Some(now)
    }
}

/// Deforming meshes that the setting has not been applied to. Scenes handle their own parts.
type New = (
    With<Mesh3d>,
    Or<(With<MeshMorphWeights>, With<SkinnedMesh>)>,
    Without<Automatic>,
    Without<ScenePart>,
    Allow<Disabled>,
);

/// The collider, layers and body of a mesh.
type Has3 = (
    Option<&'static MorphCollider>,
    Option<&'static MorphCollisionLayers>,
    Option<&'static MorphColliderOf>,
);

/// Applies the setting to new meshes, and to all meshes when the setting changes.
///
/// The bodies of meshes follow the hierarchy and the components that make an entity a body.
pub(crate) fn update_every_deforming_mesh(
    mut commands: Commands,
    settings: Res<MorphCollisionSettings>,
    new: Query<(Entity, Has3), New>,
    mut known: Query<(Entity, &mut Automatic, Has3), Allow<Disabled>>,
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
    let unsettled = roots.unsettled();
    let root_of = roots.finder();
    for mesh in unsettled {
        let Ok((mesh, mut automatic, (_, _, of))) = known.get_mut(mesh) else {
            continue;
        };
        let Some(given) = &mut automatic.body else { continue };
        let root = root_of(mesh);
        if follows(false, given, Some(&body_of(mesh, of)), root, PartialEq::eq) {
            give_body(&mut commands.entity(mesh), root);
        }
    }
    for (mesh, (has_collider, layers, of)) in &new {
        let mut entity = commands.entity(mesh);
        if has_collider.is_some() {
            entity.try_insert(Automatic::default());
            continue;
        }
        let body = of.is_none().then(|| root_of(mesh));
        entity.try_insert((
            collider,
            Automatic {
                collider: Some(collider),
                layers: layers.is_none(),
                body,
            },
        ));
        if let Some(body) = body {
            give_body(&mut entity, body);
        }
    }
}

impl Automatic {
    /// Removes what was given: the collider even if the user changed it, the rest only if it is unchanged.
    fn take_back(
        &self,
        mut entity: EntityCommands,
        (collider, layers, of): (
            Option<&MorphCollider>,
            Option<&MorphCollisionLayers>,
            Option<&MorphColliderOf>,
        ),
    ) {
        if collider.is_none() {
            // The user removed it, so it must not come back with the setting.
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
        if self.gave_body(body_of(entity.id(), of)) {
            entity.try_remove::<MorphColliderOf>();
        }
    }
}
