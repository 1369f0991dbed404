//! What a run finds out about pairs, until it is stored with the contacts.

use std::collections::BTreeSet;
use std::mem::take;
use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;

use super::comparison::{Outcome, Pair};
use crate::app::MorphCollisionSystems;
use crate::broad_phase::{Candidates, HookedPairs};
use crate::contacts::{MorphCollisions, MorphContact};
use crate::state::{MorphCollisionDiagnostics, Runs};

/// What the run has found out about the pairs that it compared.
#[derive(Resource, Default)]
pub(crate) struct FoundContacts {
    /// In any order.
    outcomes: Vec<(Pair, Outcome)>,
    /// Pairs that touch, although hooks say that they do not.
    dropped: BTreeSet<Pair>,
    /// The time that hooks took.
    pub(crate) duration: Duration,
}

impl FoundContacts {
    /// Begins a run in which pairs are compared. Returns the list for what it finds, and the pairs that hooks dropped in the last one.
    pub(super) fn begin_run(&mut self) -> (&mut Vec<(Pair, Outcome)>, BTreeSet<Pair>) {
        self.outcomes.clear();
        (&mut self.outcomes, take(&mut self.dropped))
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
            // How a contact began is stored with it.
            if let Some(known) = collisions.get(pair.0, pair.1) {
                contact.impact = known.impact;
            }
            if keep(contact) {
                (contact.collider1, contact.collider2) = *pair;
                (contact.body1, contact.body2) = bodies;
                contact.impact = impact;
            } else {
                *outcome = Outcome::Apart;
                if is_lasting {
                    self.dropped.insert(*pair);
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
    mut triangle_pairs: Local<u64>,
) {
    let start = Instant::now();
    let collisions = &mut *collisions;
    collisions.begin_run();
    if runs.compared() {
        let pairs = &candidates.pairs;
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
        *triangle_pairs = triangles.sum();
    }
    hooked.end_run();
    diagnostics.triangle_pairs = *triangle_pairs;
    diagnostics.touching_pairs = collisions.len() as u64;
    diagnostics.spend(
        MorphCollisionSystems::NarrowPhase,
        take(&mut found.duration) + start.elapsed(),
    );
}
