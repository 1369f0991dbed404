//! Looks at the entities that were noted.

use std::time::Duration;

use bevy::prelude::*;

use super::subject::Around;
use super::{anchors, bodies, colliders, physics, scenes};
use crate::app::Suspects;

/// What is known after a look at one aspect of an entity.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Look {
    Done,
    /// Something is missing that may still come.
    Again,
}

/// The time between two frames for apps without a clock.
pub(super) const FRAME: Duration = Duration::from_nanos(16_666_667);

pub(super) fn any_suspects(suspects: Res<Suspects>) -> bool {
    !suspects.is_empty()
}

/// Looks at the entities that are new or due, and warns of mistakes.
pub(super) fn look_at_suspects(mut suspects: ResMut<Suspects>, around: Around, time: Option<Res<Time<Real>>>) {
    let frame = time.map_or(FRAME, |time| time.delta());
    for (entity, is_new) in suspects.take(frame) {
        let Ok(subject) = around.subjects.get(entity) else {
            continue;
        };
        let log = suspects.log();
        let looks = [
            physics::look(&subject, &around, log),
            colliders::look(&subject, &around, is_new, log),
            bodies::look(&subject, &around, is_new, log),
            scenes::look(&subject, &around, is_new, log),
            anchors::look(&subject, &around, is_new, log),
        ];
        if looks.contains(&Look::Again) {
            suspects.note_for_later(entity);
        }
    }
}
