//! A rollback library in small: copies what the game registered, and goes back to a copy.
//!
//! As in `bevy_ggrs`, entities that are gone are spawned again with other IDs, and references to them are mapped.

use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::ecs::entity_disabling::Disabled;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::time::{Real, Virtual};
use bevy_morph_collision::prelude::*;

use super::banks::{Banks, Born};
use super::rules::Rule;

/// Copies of an entity's components.
macro_rules! copies {
    ($($name:ident: $component:ty,)*) => {
        #[derive(Clone)]
        struct Copies {
            /// The body and the parent, which are immutable components.
            body: Option<Entity>,
            parent: Option<Entity>,
            /// Whether it lists what it touches. The list itself is a part of the plugin's state.
            lists: bool,
            $($name: Option<$component>,)*
        }

        impl Copies {
            fn of(entity: EntityRef) -> Self {
                Self {
                    body: entity.get::<MorphColliderOf>().map(|of| of.body),
                    parent: entity.get::<ChildOf>().map(ChildOf::parent),
                    lists: entity.contains::<MorphCollidingEntities>(),
                    $($name: entity.get::<$component>().cloned(),)*
                }
            }

            /// Puts them back; what is there already without Bevy noticing a change if `quietly`.
            fn put(&self, entity: &mut EntityWorldMut, quietly: bool) {
                $(match &self.$name {
                    Some(copy) => match entity.get_mut::<$component>().filter(|_| quietly) {
                        Some(mut known) => *known.bypass_change_detection() = copy.clone(),
                        None => _ = entity.insert(copy.clone()),
                    },
                    None => _ = entity.remove::<$component>(),
                })*
                match self.body {
                    Some(body) => entity.insert(MorphColliderOf { body }),
                    None => entity.remove::<MorphColliderOf>(),
                };
                match self.parent {
                    Some(parent) => entity.insert(ChildOf(parent)),
                    None => entity.remove::<ChildOf>(),
                };
                match self.lists {
                    true => entity.insert_if_new(MorphCollidingEntities::default()),
                    false => entity.remove::<MorphCollidingEntities>(),
                };
            }
        }
    };
}

copies! {
    born: Born,
    mesh: Mesh3d,
    weights: MeshMorphWeights,
    shared: MorphWeights,
    skin: SkinnedMesh,
    collider: MorphCollider,
    layers: MorphCollisionLayers,
    shape: MorphShape,
    inactive: MorphColliderDisabled,
    teleported: MorphTeleported,
    hooks: MorphActiveCollisionHooks,
    events: MorphCollisionEventsEnabled,
    selves: MorphSelfCollisions,
    disabled: Disabled,
    hidden: Hidden,
    ray: MorphRayCaster,
    ray_hits: MorphRayHits,
    thrown: MorphShapeCaster,
    thrown_hits: MorphShapeHits,
}

/// Hides an entity from queries, as rollback libraries do with entities that may come back.
#[derive(Component, Clone, Copy, Default)]
pub(super) struct Hidden;

/// Everything that the game registered, after a frame.
pub(super) struct Snapshot {
    rows: Vec<Option<(Entity, Born, Transform, Copies)>>,
    clocks: (Time<Real>, Time<Virtual>, Time),
    settings: MorphCollisionSettings,
    rule: Rule,
    state: MorphCollisionState,
}

impl Snapshot {
    pub(super) fn save(world: &mut World) -> Self {
        MorphCollisionState::save(world);
        let rows = world.resource::<Banks>().rows.iter().map(|&alive| {
            let entity = world.entity(alive?);
            let (born, place) = (*entity.get::<Born>()?, *entity.get::<Transform>()?);
            Some((entity.id(), born, place, Copies::of(entity)))
        });
        Self {
            rows: rows.collect(),
            clocks: (*world.resource(), *world.resource(), *world.resource()),
            settings: *world.resource(),
            rule: *world.resource(),
            state: world.resource::<MorphCollisionState>().clone(),
        }
    }

    pub(super) fn load(&self, world: &mut World, quietly: bool) {
        let mut map = EntityHashMap::default();
        let mut now: Vec<Option<Entity>> = Vec::new();
        for (row, saved) in self.rows.iter().enumerate() {
            let alive = world.resource::<Banks>().rows[row];
            let is_same = |alive: &Entity| {
                let born = world.get::<Born>(*alive);
                saved.as_ref().is_some_and(|(_, of, ..)| born == Some(of))
            };
            let known = alive.filter(is_same);
            if let Some(other) = alive.filter(|_| known.is_none()) {
                world.despawn(other);
            }
            let entity = saved.as_ref().map(|(before, ..)| {
                let entity = known.unwrap_or_else(|| world.resource_mut::<Banks>().next(row));
                if known.is_none() {
                    world.spawn_empty_at(entity).expect("the ID is new");
                }
                map.insert(*before, entity);
                entity
            });
            now.push(entity);
        }
        world.resource_mut::<Banks>().rows.clone_from(&now);
        for (entity, saved) in now.into_iter().zip(&self.rows) {
            let (Some(entity), Some((_, _, place, copies))) = (entity, saved) else {
                continue;
            };
            let mut copies = copies.clone();
            let mapped = |entity: &mut Entity| *entity = map.get(entity).copied().unwrap_or(*entity);
            copies.body.iter_mut().chain(&mut copies.parent).for_each(mapped);
            copies
                .skin
                .iter_mut()
                .flat_map(|skin| &mut skin.joints)
                .for_each(mapped);
            let mut entity = world.entity_mut(entity);
            entity.insert(*place);
            copies.put(&mut entity, quietly);
        }
        let (real, virtual_time, time) = self.clocks;
        world.insert_resource(real);
        world.insert_resource(virtual_time);
        world.insert_resource(time);
        world.insert_resource(self.settings);
        world.insert_resource(self.rule);
        let mut state = self.state.clone();
        state.map_entities(&mut map);
        world.insert_resource(state);
        MorphCollisionState::restore(world);
    }
}
