//! What hooks say about candidate pairs.

use std::collections::BTreeSet;
use std::mem::take;

use bevy::prelude::*;

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
#[derive(Default)]
pub(crate) struct HookedPairs {
    now: Answers,
    /// In the last run.
    before: Answers,
}

#[derive(Default)]
struct Answers {
    refused: BTreeSet<(Entity, Entity)>,
    modified: BTreeSet<(Entity, Entity)>,
}

impl HookedPairs {
    /// Begins a run, in which no hook has been asked.
    pub(super) fn begin_run(&mut self) {
        self.before = take(&mut self.now);
    }

    /// Notes the answer of one hook. Returns whether it is the first that refuses the pair.
    pub(super) fn note(&mut self, pair: (Entity, Entity), answer: HookAnswer) -> bool {
        if answer.is_modified {
            self.now.modified.insert(pair);
        }
        answer.is_refused && self.now.refused.insert(pair)
    }

    /// Whether pairs have to be compared although no collider changed.
    pub(crate) fn any_changed(&self) -> bool {
        self.now.refused != self.before.refused || !(self.now.modified.is_empty() && self.before.modified.is_empty())
    }

    /// Whether the pair is not to be compared.
    pub(crate) fn refuse(&self, pair: (Entity, Entity)) -> bool {
        self.now.refused.contains(&pair)
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
