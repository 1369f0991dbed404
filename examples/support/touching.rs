//! Which bodies touch: the plugin's events are of colliders, and a body may have several.

use std::collections::{BTreeMap, BTreeSet};

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

/// Follows the plugin's messages, and puts those of one pair of bodies together.
#[derive(Debug, Default)]
pub struct TouchingBodies {
    starts: MessageCursor<MorphCollisionStart>,
    ends: MessageCursor<MorphCollisionEnd>,
    /// How many colliders of two bodies touch.
    colliders: BTreeMap<(Entity, Entity), usize>,
}

/// What changed in a frame: pairs of bodies in ascending order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Bodies that touch now and did not before.
    pub started: Vec<(Entity, Entity)>,
    /// Bodies that touched before and do not now.
    pub ended: Vec<(Entity, Entity)>,
}

impl TouchingBodies {
    /// Reads the messages of the frame that has just been run.
    pub fn follow(&mut self, world: &World) -> Changes {
        let pair = |a: Entity, b: Entity| (a.min(b), a.max(b));
        let before: BTreeSet<_> = self.colliders.keys().copied().collect();
        if let Some(ends) = world.get_resource::<Messages<MorphCollisionEnd>>() {
            for end in self.ends.read(ends) {
                if let Some(count) = self.colliders.get_mut(&pair(end.body1, end.body2)) {
                    *count = count.saturating_sub(1);
                }
            }
        }
        if let Some(starts) = world.get_resource::<Messages<MorphCollisionStart>>() {
            for start in self.starts.read(starts) {
                *self.colliders.entry(pair(start.body1, start.body2)).or_default() += 1;
            }
        }
        self.colliders.retain(|_, count| *count > 0);
        let now: BTreeSet<_> = self.colliders.keys().copied().collect();
        Changes {
            started: now.difference(&before).copied().collect(),
            ended: before.difference(&now).copied().collect(),
        }
    }

    /// How many pairs of bodies touch.
    #[must_use]
    pub fn len(&self) -> usize {
        self.colliders.len()
    }

    /// Whether no bodies touch.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.colliders.is_empty()
    }
}
