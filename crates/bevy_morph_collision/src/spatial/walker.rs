//! Walks over colliders.

use std::sync::Arc;

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use morph_collision::{Aabb, Body, Pose};

use super::MorphQueryFilter;
use super::index::ColliderIndex;
use super::state::{BorrowedQueries, Queries};
use super::target::{Target, state_of, with_target};
use crate::broad_phase::Candidates;
use crate::state::{ColliderState, Form, Runs};

/// Walks over colliders, one walk after the other.
pub(super) struct Walker<'a, 'w, 's> {
    pub(super) colliders: &'a Query<'w, 's, &'static ColliderState>,
    pub(super) runs: &'a Runs,
    pub(super) candidates: &'a Candidates,
    pub(super) index: Arc<ColliderIndex>,
    pub(super) borrowed: BorrowedQueries<'a>,
    pub(super) copies: Option<PoseCopies>,
}

impl Walker<'_, '_, '_> {
    /// Calls `at` for colliders that pass a filter and a predicate, in ascending order of the lower bounds that `bound` computes
    /// for their boxes, until all remaining bounds are above the limit that `at` returns.
    ///
    /// The pose of a mesh is locked while `at` runs, so `at` must not query other colliders.
    pub(super) fn walk(
        &mut self,
        filter: &MorphQueryFilter,
        predicate: &mut dyn FnMut(Entity) -> bool,
        limit: f32,
        bound: impl FnMut(&Aabb) -> Option<f32>,
        mut at: impl FnMut(&mut Queries, Entity, Target<'_>) -> f32,
    ) {
        let queries = self.borrowed.queries();
        let mut queue = std::mem::take(&mut queries.queue);
        let mut last = limit;
        self.index.walk(&mut queue, limit, bound, |place| {
            let (collider, placed) = &self.candidates.colliders()[place];
            if filter.takes(*collider, placed)
                && predicate(*collider)
                && let Some(state) = state_of(self.colliders, self.runs, *collider)
            {
                let ask = |target: Target<'_>| at(queries, *collider, target);
                let limit = match &mut self.copies {
                    Some(copies) => copies.with_target(*collider, state, ask),
                    None => with_target(state, ask),
                };
                last = limit.unwrap_or(last);
            }
            last
        });
        queries.queue = queue;
    }
}

/// A thread's copies of poses for which it has often waited, because other threads query the same colliders.
#[derive(Default)]
pub(super) struct PoseCopies(EntityHashMap<Waited>);

enum Waited {
    Times(u32),
    Enough(Box<Pose>),
}

/// Waiting for one question this often takes about as long as copying a pose.
const MAX_WAITS: u32 = 32;

impl PoseCopies {
    /// [`with_target`], with a copy of the pose if this thread has one.
    fn with_target<T>(
        &mut self,
        collider: Entity,
        state: &ColliderState,
        ask: impl FnOnce(Target<'_>) -> T,
    ) -> Option<T> {
        let Form::Mesh(world_from_model) = &state.placed.as_ref()?.form else {
            return with_target(state, ask);
        };
        let locked = state.pose.as_ref()?;
        let ask = |pose: &mut Pose| Some(ask(Target::Mesh(Body::new(pose, world_from_model))));
        if let Some(Waited::Enough(copy)) = self.0.get_mut(&collider) {
            return ask(copy);
        }
        if let Some(mut pose) = locked.try_lock() {
            return ask(&mut pose);
        }
        let waited = self.0.entry(collider).or_insert(Waited::Times(0));
        match waited {
            Waited::Times(times) if *times < MAX_WAITS => {
                *times += 1;
                ask(&mut locked.lock())
            }
            _ => {
                let mut copy = Box::new(locked.lock().clone());
                let answer = ask(&mut copy);
                *waited = Waited::Enough(copy);
                answer
            }
        }
    }
}
