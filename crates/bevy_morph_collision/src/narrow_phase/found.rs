//! What a run finds out about pairs, until it is stored with the contacts.

use std::collections::BTreeSet;
use std::mem::take;
use std::time::Duration;

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::platform::time::Instant;
use bevy::prelude::*;

use super::comparison::{Outcome, Pair};
use super::memories::Memories;
use crate::app::MorphCollisionSystems;
use crate::broad_phase::{Candidates, HookedPairs};
use crate::contacts::{MorphCollisions, MorphContact, map_pair};
use crate::state::{MorphCollisionDiagnostics, Runs};

/// What the run has found out about the pairs that it compared.
#[derive(Resource, Default)]
pub(crate) struct FoundContacts {
    /// In any order.
    outcomes: Vec<(Pair, Outcome)>,
    /// What the next run depends on.
    pub(super) history: PairHistory,
    /// The time that hooks took.
    pub(crate) duration: Duration,
}

/// What the narrow phase remembers of earlier runs.
#[derive(Clone, Default)]
pub(crate) struct PairHistory {
    /// Pairs that touched, although hooks said that they did not.
    dropped: BTreeSet<Pair>,
    /// Where pairs touched.
    pub(super) memories: Memories,
    /// The maximum number of triangle pairs in a contact.
    pub(super) limit: usize,
    /// The triangle pairs of all contacts.
    triangle_pairs: u64,
}

impl MapEntities for PairHistory {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        let dropped = take(&mut self.dropped).into_iter();
        self.dropped = dropped.map(|pair| map_pair(pair, mapper)).collect();
        self.memories.retain_mut(|(pair, _)| {
            *pair = (mapper.get_mapped(pair.0), mapper.get_mapped(pair.1));
            // A memory is of two meshes in this order.
            pair.0 < pair.1
        });
        self.memories.sort_unstable_by_key(|(pair, _)| *pair);
    }
}

impl FoundContacts {
    /// Begins a run in which pairs are compared. Returns the list for what it finds, the pairs that hooks dropped in the last
    /// one, and where pairs touched then.
    pub(super) fn begin_run(&mut self) -> (&mut Vec<(Pair, Outcome)>, BTreeSet<Pair>, &mut Memories) {
        self.outcomes.clear();
        let history = &mut self.history;
        (&mut self.outcomes, take(&mut history.dropped), &mut history.memories)
    }

    pub(crate) fn memory(&self) -> PairHistory {
        self.history.clone()
    }

    /// Goes back to an earlier run.
    pub(crate) fn restore(&mut self, history: PairHistory) {
        *self = Self { history, ..default() };
    }

    /// Lets a hook change contacts, in ascending order of their colliders. Those for which `keep` returns `false` do not count. What the
    /// plugin alone knows stays as it was.
    pub(crate) fn keep_if(
        &mut self,
        hooked: &HookedPairs,
        collisions: &MorphCollisions,
        mut keep: impl FnMut(&mut MorphContact) -> bool,
    ) {
        let is_modified = |(pair, _): &&mut (Pair, Outcome)| hooked.modify(*pair);
        let mut modified: Vec<_> = self.outcomes.iter_mut().filter(is_modified).collect();
        modified.sort_unstable_by_key(|(pair, _)| *pair);
        for (pair, outcome) in modified {
            let is_lasting = matches!(outcome, Outcome::Touching(_));
            let (Outcome::Touching(contact) | Outcome::Passed(contact)) = outcome else {
                continue;
            };
            let (bodies, impact) = ((contact.body1, contact.body2), contact.impact);
            contact.impact = collisions.impact_of(contact);
            if keep(contact) {
                (contact.collider1, contact.collider2) = *pair;
                (contact.body1, contact.body2) = bodies;
                contact.impact = impact;
            } else {
                *outcome = Outcome::Apart;
                if is_lasting {
                    self.history.dropped.insert(*pair);
                }
            }
        }
    }
}

/// Stores what the run has found out, and ends the contacts of pairs that are not compared any more.
pub(crate) fn store_contacts(
    candidates: Res<Candidates>,
    mut hooked: ResMut<HookedPairs>,
    runs: Res<Runs>,
    mut found: ResMut<FoundContacts>,
    mut collisions: ResMut<MorphCollisions>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let collisions = &mut *collisions;
    collisions.begin_run();
    if runs.compared() {
        let pairs = &candidates.pairs;
        // Where only margins touched, the contact does not start anew.
        for (pair, outcome) in &mut found.outcomes {
            if let Outcome::Passed(contact) = outcome
                && collisions.contains(pair.0, pair.1)
            {
                collisions.pass(contact.clone());
                *outcome = Outcome::Apart;
            }
        }
        collisions.end_unless(|pair| pairs.binary_search(&pair).is_ok() && !hooked.refuse(pair));
        let mut passed = Vec::new();
        for (pair, outcome) in found.outcomes.drain(..) {
            match outcome {
                Outcome::Touching(contact) => collisions.touch(contact),
                Outcome::Passed(contact) => passed.push(contact),
                Outcome::Apart => collisions.part(pair),
            }
        }
        collisions.end_run(passed);
        let triangles = collisions.iter().map(|contact| contact.triangles.len() as u64);
        found.history.triangle_pairs = triangles.sum();
    }
    hooked.end_run();
    diagnostics.triangle_pairs = found.history.triangle_pairs;
    diagnostics.touching_pairs = collisions.len() as u64;
    diagnostics.spend(
        MorphCollisionSystems::NarrowPhase,
        take(&mut found.duration) + start.elapsed(),
    );
}
