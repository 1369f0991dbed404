//! Everything that later runs depend on.

use bevy::ecs::archetype::ArchetypeEntity;
use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;

use crate::broad_phase::{Candidates, CandidatesMemory, HookAnswers, HookedPairs};
use crate::contacts::MorphCollisions;
use crate::events::{self, MorphCollidingEntities};
use crate::narrow_phase::{FoundContacts, PairHistory};
use crate::posing::{SkeletonMemory, Skeletons};
use crate::self_collisions::{self, MorphSelfCollisions, SelfMemory, SelfState};
use crate::state::{ColliderMemory, ColliderNews, ColliderState, RunTimes, Runs};

/// Everything that later runs depend on, besides the components and resources of the game. The default is that of an app that had no run
/// yet.
#[derive(Clone, Default)]
pub(super) struct Memory {
    runs: Runs,
    times: RunTimes,
    collisions: MorphCollisions,
    candidates: CandidatesMemory,
    hooked: HookAnswers,
    history: PairHistory,
    skeletons: Vec<SkeletonMemory>,
    /// Sorted by entity.
    colliders: Vec<(Entity, ColliderMemory)>,
    selves: Vec<(Entity, SelfMemory)>,
    lists: Vec<(Entity, MorphCollidingEntities)>,
}

impl Memory {
    /// Copies it from a world; `None` without the plugin.
    pub(super) fn of(world: &World) -> Option<Self> {
        let colliders = with::<ColliderState>(world).into_iter();
        let colliders = colliders.filter_map(|entity| Some((entity, world.get::<ColliderState>(entity)?.memory())));
        let selves = with::<SelfState>(world).into_iter().filter_map(|entity| {
            let (state, list) = (
                world.get::<SelfState>(entity)?,
                world.get::<MorphSelfCollisions>(entity)?,
            );
            Some((entity, state.memory(list)))
        });
        let lists = with::<MorphCollidingEntities>(world).into_iter();
        let lists = lists.filter_map(|entity| Some((entity, world.get::<MorphCollidingEntities>(entity)?.clone())));
        Some(Self {
            runs: *world.get_resource()?,
            times: *world.get_resource()?,
            collisions: world.get_resource::<MorphCollisions>()?.clone(),
            candidates: world.get_resource::<Candidates>()?.memory(),
            hooked: world.get_resource::<HookedPairs>()?.memory(),
            history: world.get_resource::<FoundContacts>()?.memory(),
            skeletons: world.get_resource::<Skeletons>()?.memory(),
            colliders: colliders.collect(),
            selves: selves.collect(),
            lists: lists.collect(),
        })
    }

    /// Brings a world with the plugin back to it.
    pub(super) fn restore(&self, world: &mut World) {
        for entity in with::<ColliderState>(world) {
            if let Some(mut state) = world.get_mut::<ColliderState>(entity) {
                state.restore(find(&self.colliders, entity));
            }
        }
        for entity in with::<SelfState>(world) {
            let mut entity = world.entity_mut(entity);
            let memory = find(&self.selves, entity.id());
            let both = entity.get_components_mut::<(&mut SelfState, &mut MorphSelfCollisions)>();
            if let Ok((mut state, mut list)) = both {
                state.restore(memory, &mut list);
            }
        }
        for entity in with::<MorphCollidingEntities>(world) {
            if let Some(mut list) = world.get_mut::<MorphCollidingEntities>(entity) {
                *list = find(&self.lists, entity).cloned().unwrap_or_default();
            }
        }
        world.resource_mut::<Runs>().restore(self.runs);
        *world.resource_mut() = self.times;
        world.resource_mut::<MorphCollisions>().restore(self.collisions.clone());
        world.resource_mut::<Candidates>().restore(self.candidates.clone());
        world.resource_mut::<HookedPairs>().restore(self.hooked.clone());
        world.resource_mut::<FoundContacts>().restore(self.history.clone());
        world.resource_mut::<Skeletons>().restore(&self.skeletons);
        world.resource_mut::<ColliderNews>().restore();
        events::forget_unread(world);
        self_collisions::forget_unread(world);
    }
}

impl MapEntities for Memory {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.collisions.map_entities(mapper);
        self.candidates.map_entities(mapper);
        self.hooked.map_entities(mapper);
        self.history.map_entities(mapper);
        self.skeletons.map_entities(mapper);
        for (entity, collider) in &mut self.colliders {
            entity.map_entities(mapper);
            collider.map_entities(mapper);
        }
        self.selves
            .iter_mut()
            .for_each(|(entity, _)| entity.map_entities(mapper));
        for (entity, list) in &mut self.lists {
            entity.map_entities(mapper);
            list.map_entities(mapper);
        }
        self.colliders.sort_unstable_by_key(|(entity, _)| *entity);
        self.selves.sort_unstable_by_key(|(entity, _)| *entity);
        self.lists.sort_unstable_by_key(|(entity, _)| *entity);
    }
}

/// The entities with a component, ascending: also those that a component such as Bevy's `Disabled` hides from queries.
fn with<C: Component>(world: &World) -> Vec<Entity> {
    let Some(component) = world.component_id::<C>() else {
        return Vec::new();
    };
    let archetypes = world
        .archetypes()
        .iter()
        .filter(|archetype| archetype.contains(component));
    let mut entities: Vec<Entity> = archetypes
        .flat_map(|archetype| archetype.entities().iter().map(ArchetypeEntity::id))
        .collect();
    entities.sort_unstable();
    entities
}

fn find<T>(sorted: &[(Entity, T)], entity: Entity) -> Option<&T> {
    let index = sorted.binary_search_by_key(&entity, |(entity, _)| *entity);
    Some(&sorted[index.ok()?].1)
}
