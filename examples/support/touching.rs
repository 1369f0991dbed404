//! Which bodies started and stopped touching, frame by frame.

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

/// Follows the plugin's messages about bodies.
#[derive(Debug, Default)]
pub struct TouchingBodies {
    starts: MessageCursor<MorphBodyCollisionStart>,
    ends: MessageCursor<MorphBodyCollisionEnd>,
    touching: usize,
}

/// The changes in a frame: pairs of bodies in ascending order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Bodies that started touching.
    pub started: Vec<(Entity, Entity)>,
    /// Bodies that stopped touching.
    pub ended: Vec<(Entity, Entity)>,
}

impl Changes {
    /// One line per pair that started or stopped touching: `frame 7  dolphin 0 started touching dolphin 1`.
    #[must_use]
    pub fn describe(&self, frame: usize, kind: &str, roots: &[Entity]) -> String {
        let number = |body: Entity| roots.iter().position(|&root| root == body).unwrap_or(roots.len());
        let line = |&(a, b): &(Entity, Entity), what: &str| {
            let (a, b) = (number(a).min(number(b)), number(a).max(number(b)));
            format!("frame {frame}  {kind} {a} {what} touching {kind} {b}\n")
        };
        let started = self.started.iter().map(|pair| line(pair, "started"));
        let ended = self.ended.iter().map(|pair| line(pair, "stopped"));
        started.chain(ended).collect()
    }
}

impl TouchingBodies {
    /// Reads the messages of the latest frame.
    pub fn update(&mut self, world: &World) -> Changes {
        let mut changes = Changes::default();
        if let Some(ends) = world.get_resource() {
            changes.ended = self.ends.read(ends).map(|end| (end.body1, end.body2)).collect();
        }
        if let Some(starts) = world.get_resource() {
            let starts = self.starts.read(starts);
            changes.started = starts.map(|start| (start.body1, start.body2)).collect();
        }
        self.touching = (self.touching + changes.started.len()).saturating_sub(changes.ended.len());
        changes
    }

    /// Number of pairs of bodies that touch.
    #[must_use]
    pub fn len(&self) -> usize {
        self.touching
    }

    /// Whether no bodies touch.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.touching == 0
    }
}
