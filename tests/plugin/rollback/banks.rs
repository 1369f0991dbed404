//! The entities of the stage: rows whose order stays the same however often they are spawned.

use std::collections::HashMap;

use bevy::prelude::*;

/// How many entities a row may have one after the other.
const IDS: usize = 700;

/// Tells the entities of a row apart: the frame in which it was spawned, which a rollback does not change.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Born(pub(super) u32);

/// Entity IDs, so many for each row that the order of two rows never depends on which ID they have. The order of the plugin's answers depends on
/// IDs, and so these are comparable.
#[derive(Resource)]
pub(super) struct Banks {
    /// The entities that exist.
    pub(super) rows: Vec<Option<Entity>>,
    ids: Vec<Vec<Entity>>,
    row_of: HashMap<Entity, u32>,
}

impl Banks {
    pub(super) fn new(world: &World, rows: usize) -> Self {
        let count = rows * IDS;
        let mut all: Vec<Entity> = (0..count).map(|_| world.entity_allocator().alloc()).collect();
        all.sort_unstable();
        let row_of = all.iter().enumerate().map(|(i, &entity)| (entity, (i / IDS) as u32));
        Self {
            rows: vec![None; rows],
            row_of: row_of.collect(),
            ids: all.chunks(IDS).map(<[Entity]>::to_vec).collect(),
        }
    }

    /// An ID that no entity has had.
    pub(super) fn next(&mut self, row: usize) -> Entity {
        self.ids[row].pop().expect("there are enough")
    }

    /// The row of an entity that exists or existed.
    pub(super) fn row(&self, entity: Entity) -> u32 {
        self.row_of.get(&entity).copied().unwrap_or(u32::MAX)
    }
}
