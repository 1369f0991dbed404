//! State that all queries share: the index of colliders, memory, and warnings already logged.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use morph_collision::{ContactQuery, DistanceQuery, InputError, RayHit, RayQuery, ShapeQuery};
use tracing::warn;

use super::index::{ColliderIndex, Queue};
use crate::broad_phase::Candidates;
use crate::state::{ColliderState, Runs};

/// State that the spatial queries of all systems share. Locks are held briefly, never while a query runs.
#[derive(Resource, Default)]
pub(crate) struct SpatialState {
    index: Mutex<Arc<ColliderIndex>>,
    #[allow(clippy::vec_box, reason = "they move in and out with every question")]
    idle: Mutex<Vec<Box<Queries>>>,
    warned: Mutex<Vec<&'static str>>,
}

/// Memory that a query reuses.
#[derive(Default)]
pub(super) struct Queries {
    pub(super) ray: RayQuery,
    pub(super) shape: ShapeQuery,
    pub(super) distance: DistanceQuery,
    pub(super) contact: ContactQuery,
    pub(super) hits: Vec<RayHit>,
    pub(super) queue: Queue,
}

/// More than the number of queries that run at the same time.
const MAX_IDLE: usize = 64;

impl SpatialState {
    /// The index, updated to the last run. It contains the current state of colliders with a tolerance, not the state that
    /// collisions see.
    pub(super) fn index(
        &self,
        candidates: &Candidates,
        runs: &Runs,
        states: &Query<&ColliderState, Allow<Disabled>>,
    ) -> Arc<ColliderIndex> {
        let mut index = self.index.lock().unwrap_or_else(PoisonError::into_inner);
        if index.version != runs.version() {
            let changed = Arc::make_mut(&mut index);
            changed.version = runs.version();
            let colliders = candidates.colliders().iter();
            changed.update(colliders.map(|(collider, seen)| {
                let placed = states.get(*collider).ok().and_then(|state| state.placed.as_ref());
                (*collider, placed.unwrap_or(seen).bounds)
            }));
        }
        index.clone()
    }

    /// Memory for one query. Queries can be nested.
    pub(super) fn borrow(&self) -> BorrowedQueries<'_> {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        BorrowedQueries {
            state: self,
            queries: Some(idle.unwrap_or_default()),
        }
    }

    /// Logs the first invalid query of each method.
    pub(super) fn warn(&self, method: &'static str, error: &InputError) {
        let mut warned = self.warned.lock().unwrap_or_else(PoisonError::into_inner);
        if !warned.contains(&method) {
            warned.push(method);
            warn!("`MorphSpatialQuery::{method}` finds nothing: {error}. Further ones like it are not logged");
        }
    }
}

pub(super) struct BorrowedQueries<'a> {
    state: &'a SpatialState,
    /// `None` only after it was dropped.
    queries: Option<Box<Queries>>,
}

impl BorrowedQueries<'_> {
    pub(super) fn queries(&mut self) -> &mut Queries {
        self.queries.get_or_insert_default()
    }
}

impl Drop for BorrowedQueries<'_> {
    fn drop(&mut self) {
        let mut idle = self.state.idle.lock().unwrap_or_else(PoisonError::into_inner);
        if idle.len() < MAX_IDLE {
            idle.extend(self.queries.take());
        }
    }
}
