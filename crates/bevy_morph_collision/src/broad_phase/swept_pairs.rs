//! Continuous colliders: pairs that are also compared on the way from the last run to this one.
//!
//! A pair is continuous if one of its colliders is, and then the motion of both counts. The broad phase sweeps boxes from the last
//! run to this one (`SweptPairs`). The narrow phase looks for the first contact on the way (`narrow_phase/motion`), unless the
//! colliders already touched in the last run. Other pairs see nothing of this.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use morph_collision::{Aabb, overlapping_pairs};

use crate::state::Placement;

/// Finds the pairs that may touch on their way from the last run to this one.
#[derive(Default)]
pub(crate) struct SweptPairs {
    /// The pairs, in ascending order of entities and sorted. At least one of each is continuous.
    pub(crate) pairs: Vec<(Entity, Entity)>,
    /// The colliders in the last run, ascending, as collisions saw them.
    before: Vec<(Entity, Placement)>,
    // Kept to reuse memory.
    ways: Vec<Option<Aabb>>,
    overlaps: Vec<(u32, u32)>,
}

impl SweptPairs {
    /// Begins a run without swept pairs.
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
        self.before.clear();
    }

    /// Remembers the colliders of the last run, before they are replaced.
    pub(crate) fn remember(&mut self, colliders: &[(Entity, Placement)]) {
        self.before.extend_from_slice(colliders);
    }

    /// How collisions saw a collider in the last run; `None` if it took no part.
    pub(crate) fn before(&self, collider: Entity) -> Option<&Placement> {
        let index = self.before.binary_search_by_key(&collider, |&(entity, _)| entity);
        index.ok().map(|index| &self.before[index].1)
    }

    /// Finds the pairs among the colliders of this run, which are in ascending order. Half-spaces, shapes of another kind than before, and
    /// colliders that took no part in the last run or that were put somewhere else, have no way.
    pub(crate) fn find(&mut self, colliders: &[(Entity, Placement)], elsewhere: &EntityHashSet) {
        let mut before = self.before.iter().peekable();
        let way = |(entity, placed): &(Entity, Placement)| {
            while before.next_if(|(other, _)| other < entity).is_some() {}
            let (_, before) = before.next_if(|(other, _)| other == entity)?;
            let stays = !elsewhere.contains(entity) && !elsewhere.contains(&placed.body);
            if stays { placed.way_from(before) } else { None }
        };
        self.ways.clear();
        self.ways.extend(colliders.iter().map(way));
        let continuous = self
            .ways
            .iter()
            .zip(colliders)
            .filter(|(_, (_, placed))| placed.continuous);
        let all = continuous
            .filter_map(|(way, _)| way.as_ref())
            .fold(Aabb::EMPTY, |hull, way| hull.union(way));
        for way in &mut self.ways {
            *way = way.filter(|way| way.overlaps(&all));
        }
        self.overlaps.clear();
        overlapping_pairs(&self.ways, &mut self.overlaps);
        for &(i, j) in &self.overlaps {
            let ((a, placed_a), (b, placed_b)) = (&colliders[i as usize], &colliders[j as usize]);
            if (placed_a.continuous || placed_b.continuous) && placed_a.skips(placed_b).is_none() {
                self.pairs.push((*a, *b));
            }
        }
    }
}
