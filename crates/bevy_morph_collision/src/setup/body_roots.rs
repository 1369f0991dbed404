//! Finds the body of a mesh that has not been assigned to one.

use std::cell::LazyCell;

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use crate::components::{MorphBodyRoot, MorphColliderScene};

/// Components that make an entity a body. Bevy puts no other component on the root of a scene that it spawned: the name and
/// extras from the glTF loader are on an entity below it, if the file has them.
#[cfg(feature = "gltf")]
type IsRoot = (With<MorphBodyRoot>, With<MorphColliderScene>, With<WorldAssetRoot>);
#[cfg(not(feature = "gltf"))]
type IsRoot = (With<MorphBodyRoot>, With<MorphColliderScene>);
#[cfg(feature = "gltf")]
type IsNewRoot = (Added<MorphBodyRoot>, Added<MorphColliderScene>, Added<WorldAssetRoot>);
#[cfg(not(feature = "gltf"))]
type IsNewRoot = (Added<MorphBodyRoot>, Added<MorphColliderScene>);

/// Changes after which meshes at or below an entity may have another body.
type News = (
    Or<(
        Or<IsNewRoot>,
        Changed<ChildOf>,
        Added<MeshMorphWeights>,
        Changed<SkinnedMesh>,
    )>,
    Allow<Disabled>,
);

/// Finds the bodies of meshes.
#[derive(SystemParam)]
pub(crate) struct BodyRoots<'w, 's> {
    roots: Query<'w, 's, (), (Or<IsRoot>, Allow<Disabled>)>,
    parents: Query<'w, 's, &'static ChildOf, Allow<Disabled>>,
    children: Query<'w, 's, &'static Children, Allow<Disabled>>,
    weights: Query<'w, 's, &'static MeshMorphWeights, Allow<Disabled>>,
    skins: Query<'w, 's, &'static SkinnedMesh, Allow<Disabled>>,
    entities: Query<'w, 's, (), Allow<Disabled>>,
    news: Query<'w, 's, Entity, News>,
    removed_markers: RemovedComponents<'w, 's, MorphBodyRoot>,
    removed_scenes: RemovedComponents<'w, 's, MorphColliderScene>,
    removed_parents: RemovedComponents<'w, 's, ChildOf>,
}

impl BodyRoots<'_, '_> {
    /// Entities whose body may have changed since the last frame.
    pub(crate) fn unsettled(&mut self) -> EntityHashSet {
        let removed = self.removed_markers.read().chain(self.removed_scenes.read());
        let mut unsettled = EntityHashSet::default();
        for top in self.news.iter().chain(removed).chain(self.removed_parents.read()) {
            unsettled.insert(top);
            unsettled.extend(self.children.iter_descendants(top));
        }
        unsettled
    }

    /// Returns a function from a mesh to its body: the nearest root at or above it, otherwise the root of its skeleton, otherwise
    /// the entity with its morph weights.
    pub(crate) fn finder(&self) -> impl Fn(Entity) -> Entity {
        let joints = LazyCell::new(|| {
            let joints = self.skins.iter().flat_map(|skin| &skin.joints);
            joints.copied().collect::<EntityHashSet>()
        });
        move |mesh| {
            self.path(mesh)
                .find(|&entity| self.roots.contains(entity))
                .or_else(|| self.skeleton_root(mesh, &joints))
                .or_else(|| self.node(mesh))
                .unwrap_or(mesh)
        }
    }

    /// An entity and its ancestors, nearest first.
    fn path(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        std::iter::once(entity).chain(self.parents.iter_ancestors(entity))
    }

    /// The topmost joint above the first joint of a mesh. It is the same for all meshes of the skeleton, whichever joints they
    /// list.
    fn skeleton_root(&self, mesh: Entity, joints: &EntityHashSet) -> Option<Entity> {
        let skin = self.skins.get(mesh).ok()?;
        let first = skin.joints.iter().find(|&&joint| self.entities.contains(joint))?;
        self.path(*first).take_while(|joint| joints.contains(joint)).last()
    }

    /// The entity that has the mesh's weights. In glTF this is the node, above one mesh per primitive.
    fn node(&self, mesh: Entity) -> Option<Entity> {
        match *self.weights.get(mesh).ok()? {
            MeshMorphWeights::Reference(node) => Some(node).filter(|&node| self.entities.contains(node)),
            MeshMorphWeights::Value { .. } => None,
        }
    }
}
