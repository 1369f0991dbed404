//! Looks at the entities that were noted.

use bevy::prelude::*;

use super::subject::Around;
use super::verdict::{FRAME, Verdict};
use super::{anchors, bodies, colliders, scenes};
use crate::app::Suspects;

pub(super) fn any_suspects(suspects: Res<Suspects>) -> bool {
    !suspects.is_empty()
}

/// Looks at the entities that are new or due, and warns of mistakes.
pub(super) fn check_suspects(mut suspects: ResMut<Suspects>, around: Around, time: Option<Res<Time<Real>>>) {
    let frame = time.map_or(FRAME, |time| time.delta());
    for (entity, is_new) in suspects.take(frame) {
        let Ok(subject) = around.subjects.get(entity) else {
            continue;
        };
        let log = suspects.log();
        let verdicts = [
            colliders::check(&subject, &around, is_new, log),
            bodies::check(&subject, &around, is_new, log),
            scenes::check(&subject, &around, is_new, log),
            anchors::check(&subject, &around, is_new, log),
        ];
        if verdicts.contains(&Verdict::Again) {
            suspects.note_for_later(entity);
        }
    }
}
