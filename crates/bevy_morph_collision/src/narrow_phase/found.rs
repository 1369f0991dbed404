//! What a run finds out about pairs, until it is stored with the contacts.

use bevy::platform::time::Instant;
use bevy::prelude::*;

use super::comparison::{Outcome, Pair};
use crate::broad_phase::Candidates;
use crate::contacts::{MorphCollisions, MorphContact};
use crate::state::{MorphCollisionDiagnostics, Runs};

/// What the run has found out about the pairs that it compared, in any order.
#[derive(Resource, Default)]
pub(crate) struct FoundContacts(Vec<(Pair, Outcome)>);

impl FoundContacts {
    pub(super) fn begin_run(&mut self) -> &mut Vec<(Pair, Outcome)> {
        self.0.clear();
        &mut self.0
    }

    /// Changes contacts, in ascending order of their colliders. Those for which `keep` returns `false` do not count.
    pub(crate) fn keep_if(&mut self, mut keep: impl FnMut(&mut MorphContact) -> bool) {
        self.0.sort_unstable_by_key(|(pair, _)| *pair);
        for (pair, outcome) in &mut self.0 {
            let (Outcome::Touching(contact) | Outcome::Passed(contact)) = outcome else {
                continue;
            };
            let bodies = (contact.body1, contact.body2);
            if !keep(contact) {
                *outcome = Outcome::Apart;
                continue;
            }
            (contact.collider1, contact.collider2) = *pair;
            (contact.body1, contact.body2) = bodies;
        }
    }
}

/// Stores what the run has found out, and ends the contacts of pairs that are not compared any more.
pub(crate) fn store_contacts(
    candidates: Res<Candidates>,
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
        let (pairs, hooked) = (&candidates.pairs, &candidates.hooked);
        collisions.end_unless(|pair| pairs.binary_search(&pair).is_ok() && !hooked.refuse(pair));
        let mut passed = Vec::new();
        for (pair, outcome) in found.0.drain(..) {
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
    diagnostics.triangle_pairs = *triangle_pairs;
    diagnostics.touching_pairs = collisions.len() as u64;
    diagnostics.duration += start.elapsed();
}
