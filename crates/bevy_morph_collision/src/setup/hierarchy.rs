//! Scenes and the hierarchy below them.

use crate::components::MorphColliderScene;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// Scenes and the hierarchy below them.
#[derive(SystemParam)]
pub(crate) struct Hierarchy<'w, 's> {
    pub(super) scenes: Query<'w, 's, Ref<'static, MorphColliderScene>, Allow<Disabled>>,
    names: Query<'w, 's, &'static Name, Allow<Disabled>>,
    parents: Query<'w, 's, &'static ChildOf, Allow<Disabled>>,
    children: Query<'w, 's, &'static Children, Allow<Disabled>>,
}

impl Hierarchy<'_, '_> {
    /// An entity and its ancestors, nearest first.
    fn path(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        std::iter::once(entity).chain(self.parents.iter_ancestors(entity))
    }

    /// An entity and its ancestors up to a root, which is one of them.
    pub(crate) fn path_below(&self, entity: Entity, root: Entity) -> impl Iterator<Item = Entity> {
        let below = self.path(entity).take_while(move |&entity| entity != root);
        below.chain([root])
    }

    /// The descendants of an entity.
    pub(crate) fn below(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        self.children.iter_descendants(entity)
    }

    /// The nearest scene root at or above an entity.
    pub(crate) fn scene_root(&self, part: Entity) -> Option<Entity> {
        self.path(part).find(|&entity| self.scenes.contains(entity))
    }

    /// Whether an entity, or an ancestor up to the scene's root, has one of the names. Always true without names.
    pub(super) fn is_named(&self, part: Entity, root: Entity, wanted: &[String]) -> bool {
        let is_one = |entity: Entity| {
            let name = self.names.get(entity);
            name.is_ok_and(|name| wanted.iter().any(|wanted| wanted == name.as_str()))
        };
        wanted.is_empty() || self.path_below(part, root).any(is_one)
    }
}
