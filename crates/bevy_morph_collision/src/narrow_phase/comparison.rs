//! Two colliders to compare, and what is known about them.

use bevy::prelude::*;
use morph_collision::TrianglePair;

use crate::components::MorphCollisionMode;
use crate::contacts::MorphContact;

pub(super) type Pair = (Entity, Entity);

/// Two colliders, by their index among those that take part.
#[derive(Clone, Copy)]
pub(super) struct Comparison {
    pub(super) pair: Pair,
    pub(super) indices: (usize, usize),
    pub(super) mode: MorphCollisionMode,
    /// Whether to compare them on their way from the last run, too.
    pub(super) is_swept: bool,
}

/// Whether a mode asks for every pair of triangles, up to a limit.
pub(super) fn wants_all(mode: MorphCollisionMode) -> bool {
    matches!(mode, MorphCollisionMode::All | MorphCollisionMode::Contacts)
}

/// What is known about a pair before its contact is built.
pub(super) enum BatchResult {
    /// Nothing: one of the colliders is a shape.
    NotAsked,
    /// They are apart now. Only their way is to be compared.
    Apart,
    /// The intersecting triangles of two meshes.
    Triangles {
        triangles: Vec<TrianglePair>,
        /// Whether there are more.
        is_truncated: bool,
    },
}

/// A pair for which a contact might have to be built, and what is known about it.
pub(super) struct Job {
    pub(super) comparison: Comparison,
    pub(super) known: BatchResult,
}

impl Job {
    /// Whether it takes more than one pair of triangles.
    pub(super) fn is_costly(&self) -> bool {
        match &self.known {
            BatchResult::NotAsked | BatchResult::Apart => true,
            BatchResult::Triangles { triangles, .. } => {
                triangles.is_empty() || self.comparison.is_swept || self.comparison.mode == MorphCollisionMode::Contacts
            }
        }
    }
}

/// What is known about a pair in the end.
#[derive(Debug, PartialEq)]
pub(super) enum Outcome {
    Apart,
    Touching(MorphContact),
    /// They touched on their way from the last run, but do not any more.
    Passed(MorphContact),
}
