//! What hooks say about candidate pairs.

use std::collections::BTreeSet;
use std::mem::take;
use std::time::Duration;

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;

use super::candidates::Candidates;
use crate::contacts::map_pair;

/// Two colliders of different bodies that may touch, with `collider1 < collider2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MorphCandidatePair {
    /// The first collider.
    pub collider1: Entity,
    /// The second collider.
    pub collider2: Entity,
    /// The body of `collider1`, named by its [`MorphColliderOf`](crate::components::MorphColliderOf), or `collider1` itself.
    pub body1: Entity,
    /// The body of `collider2`.
    pub body2: Entity,
}

/// What a hook says about a pair.
#[derive(Clone, Copy, Default)]
pub(crate) struct HookAnswer {
    /// The pair is not compared.
    pub(crate) is_refused: bool,
    /// Its contact may be changed.
    pub(crate) is_modified: bool,
}

/// What hooks say about candidate pairs. Empty without hooks, and for all pairs that do not ask them.
///
/// A pair keeps its answer if neither collider changed. Hooks depend on other things, so their pairs are noted here.
#[derive(Resource, Default)]
pub(crate) struct HookedPairs {
    now: HookAnswers,
    /// In the last run.
    before: HookAnswers,
    /// The time that hooks took so far in this run.
    pub(crate) duration: Duration,
}

/// What hooks said in a run.
#[derive(Clone, Default)]
pub(crate) struct HookAnswers {
    refused: BTreeSet<(Entity, Entity)>,
    modified: BTreeSet<(Entity, Entity)>,
    /// The number of refused pairs whose boxes overlap.
    overlapping: u64,
}

impl MapEntities for HookAnswers {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        for set in [&mut self.refused, &mut self.modified] {
            *set = take(set).into_iter().map(|pair| map_pair(pair, mapper)).collect();
        }
    }
}

impl HookedPairs {
    /// What hooks said in the last run, which the next one depends on.
    pub(crate) fn memory(&self) -> HookAnswers {
        self.before.clone()
    }

    /// Goes back to an earlier run.
    pub(crate) fn restore(&mut self, before: HookAnswers) {
        *self = Self { before, ..default() };
    }

    /// Ends a run. In the next one, no hook has been asked yet.
    pub(crate) fn end_run(&mut self) {
        self.before = take(&mut self.now);
    }

    /// Asks a hook about all pairs that no other hook has refused.
    pub(crate) fn ask(&mut self, candidates: &Candidates, mut hook: impl FnMut(&MorphCandidatePair) -> HookAnswer) {
        for &pair in &candidates.pairs {
            self.now.overlapping += u64::from(self.note(pair, candidates, &mut hook));
        }
        for &pair in &candidates.swept.pairs {
            if candidates.pairs.binary_search(&pair).is_err() {
                self.note(pair, candidates, &mut hook);
            }
        }
    }

    /// Notes what a hook says about a pair. Returns whether it is the first that refuses the pair.
    fn note(
        &mut self,
        pair: (Entity, Entity),
        candidates: &Candidates,
        hook: &mut impl FnMut(&MorphCandidatePair) -> HookAnswer,
    ) -> bool {
        if self.refuse(pair) {
            return false;
        }
        let answer = hook(&MorphCandidatePair {
            collider1: pair.0,
            collider2: pair.1,
            body1: candidates.body_of(pair.0),
            body2: candidates.body_of(pair.1),
        });
        if answer.is_refused {
            self.now.modified.remove(&pair);
            self.now.refused.insert(pair);
        } else if answer.is_modified {
            self.now.modified.insert(pair);
        }
        answer.is_refused
    }

    /// The number of refused pairs whose boxes overlap.
    pub(crate) fn refused_overlapping(&self) -> u64 {
        self.now.overlapping
    }

    /// Whether pairs have to be compared although no collider changed.
    pub(crate) fn any_changed(&self) -> bool {
        self.now.refused != self.before.refused || self.any_is_modified() || !self.before.modified.is_empty()
    }

    /// Whether the pair is not to be compared.
    pub(crate) fn refuse(&self, pair: (Entity, Entity)) -> bool {
        self.now.refused.contains(&pair)
    }

    /// Whether any contact may be changed.
    pub(crate) fn any_is_modified(&self) -> bool {
        !self.now.modified.is_empty()
    }

    /// Whether the contact of the pair may be changed.
    pub(crate) fn modify(&self, pair: (Entity, Entity)) -> bool {
        self.now.modified.contains(&pair)
    }

    /// Whether the pair has no answer of the last run that still holds.
    pub(crate) fn have_no_answer(&self, pair: (Entity, Entity)) -> bool {
        self.before.refused.contains(&pair) || self.before.modified.contains(&pair) || self.modify(pair)
    }
}
