//! Finds intersecting triangles and contacts.
//!
//! The system queries all pairs of meshes at once (`mod`), starting where they touched in the last run (`memories`), and turns
//! the results into contacts (`touch`).

mod memories;
mod touch;

use std::collections::BTreeMap;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use morph_collision::{BatchQuery, Body, PairTask, Pose, Wanted};
use tracing::debug_span;

use self::memories::{Memories, keep_memories};
use self::touch::{Listed, Touch, wants_all};

use crate::broad_phase::Candidates;
use crate::collider::{ColliderState, Form, LockedPose, MorphCollisionMode, Placement};
use crate::contacts::{MorphCollisions, MorphContact};
use crate::diagnostics::MorphCollisionDiagnostics;
use crate::settings::MorphCollisionSettings;
use crate::workers::TaskPoolWorkers;

type Pair = (Entity, Entity);

/// Memory that the narrow phase reuses.
#[derive(Default)]
pub(crate) struct Scratch {
    touch: Touch,
    batch: BatchQuery,
    /// The maximum number of triangle pairs in a contact.
    limit: usize,
    /// Whether the limit has changed since the last run.
    compare_all: bool,
    /// The pairs of meshes to query.
    asked: Vec<Asked>,
    /// Where pairs touched in the last run. `next_memories` is scratch memory for the next ones.
    memories: Memories,
    next_memories: Memories,
    answers: Vec<(Pair, Option<MorphContact>)>,
}

/// Two colliders, by their index among those that take part.
#[derive(Clone, Copy)]
struct Asked {
    pair: Pair,
    places: (usize, usize),
    mode: MorphCollisionMode,
}

/// Finds out for every candidate pair whether and where it touches. Queries all pairs of meshes at once, on Bevy's threads.
///
/// A pair keeps its answer if neither collider changed.
pub(crate) fn find_contacts(
    mut candidates: ResMut<Candidates>,
    mut colliders: Query<(Entity, &mut ColliderState)>,
    mut collisions: ResMut<MorphCollisions>,
    settings: Res<MorphCollisionSettings>,
    mut scratch: Local<Scratch>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::narrow_phase").entered();
    let collisions = &mut *collisions;
    collisions.changes.begin_run();
    let scratch = &mut *scratch;
    let limit = settings.list_limit();
    scratch.compare_all = std::mem::replace(&mut scratch.limit, limit) != limit;
    collisions.compared = std::mem::take(&mut candidates.changed) || scratch.compare_all;
    if collisions.compared {
        scratch.answers.clear();
        let unchanged = scratch.ask(&candidates.pairs, &mut colliders, &collisions.current, &mut diagnostics);
        diagnostics.skipped_unchanged = unchanged;
        collisions.replace(&candidates.pairs, &mut scratch.answers);
        for (_, mut state) in &mut colliders {
            // Colliders that took part are now up to date. Those that did not count as changed when they come back.
            state.changed = state.placed.is_none();
        }
    } else {
        diagnostics.skipped_unchanged = candidates.pairs.len() as u64;
    }
    let triangles = collisions
        .current
        .values()
        .map(|contact| contact.triangles.len() as u64);
    diagnostics.triangle_pairs = triangles.sum();
    diagnostics.touching_pairs = collisions.current.len() as u64;
    diagnostics.duration += start.elapsed();
}

impl MorphCollisions {
    /// Takes over the answers, in any order, and removes contacts of pairs that are no longer candidates.
    fn replace(&mut self, candidates: &[Pair], answers: &mut Vec<(Pair, Option<MorphContact>)>) {
        let Self { current, changes, .. } = self;
        for contact in current.extract_if(.., |pair, _| candidates.binary_search(pair).is_err()) {
            changes.ended.push(contact.1);
        }
        for (pair, contact) in answers.drain(..) {
            let before = match contact {
                Some(contact) => {
                    let before = current.insert(pair, contact);
                    if before.is_none() {
                        changes.started.push(pair);
                    }
                    None
                }
                None => current.remove(&pair),
            };
            changes.ended.extend(before);
        }
        changes.sort_run();
    }
}

impl Scratch {
    /// Queries the pairs with a collider that changed. Returns how many pairs have none. `contacts` is the result of the last
    /// run.
    fn ask(
        &mut self,
        candidates: &[Pair],
        colliders: &mut Query<(Entity, &mut ColliderState)>,
        contacts: &BTreeMap<Pair, MorphContact>,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) -> u64 {
        let mut placed: Vec<_> = colliders
            .iter_mut()
            .filter_map(|(entity, state)| Placed::new(entity, state.into_inner()))
            .collect();
        placed.sort_unstable_by_key(|collider| collider.entity);
        let place = |entity: Entity| placed.binary_search_by_key(&entity, |collider| collider.entity).ok();

        let mut unchanged = 0;
        let mut with_shapes = Vec::new();
        self.asked.clear();
        for &pair in candidates {
            let (Some(a), Some(b)) = (place(pair.0), place(pair.1)) else {
                continue;
            };
            if !placed[a].changed && !placed[b].changed && !self.compare_all {
                unchanged += 1;
                continue;
            }
            let asked = Asked {
                pair,
                places: (a, b),
                mode: placed[a].placement.mode.max(placed[b].placement.mode),
            };
            match (placed[a].placement.form, placed[b].placement.form) {
                (Form::Mesh(_), Form::Mesh(_)) => self.asked.push(asked),
                (Form::Mesh(_), Form::Shape(shape)) => with_shapes.push((asked, shape, false)),
                (Form::Shape(shape), Form::Mesh(_)) => with_shapes.push((asked, shape, true)),
                (Form::Shape(_), Form::Shape(_)) => {}
            }
        }
        for (asked, shape, shape_first) in with_shapes {
            let contact = self
                .touch
                .with_shape(&mut placed, asked, (&shape, shape_first), self.limit, diagnostics);
            self.answers.push((asked.pair, contact));
        }
        self.ask_meshes(&mut placed, contacts, diagnostics);
        unchanged
    }

    fn ask_meshes(
        &mut self,
        placed: &mut [Placed<'_>],
        contacts: &BTreeMap<Pair, MorphContact>,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) {
        let Self {
            touch,
            batch,
            limit,
            compare_all: _,
            asked,
            memories,
            next_memories,
            answers,
        } = self;
        keep_memories(asked, contacts, memories, next_memories);
        let mut memories = memories.iter_mut().peekable();
        let mut tasks: Vec<_> = asked
            .iter()
            .map(|asked| {
                let (a, b) = asked.places;
                let wanted = if wants_all(asked.mode) {
                    Wanted::UpTo(*limit)
                } else {
                    Wanted::First
                };
                let mut task = PairTask::new(a, b, wanted);
                let memory = memories.next_if(|(pair, _)| *pair == asked.pair);
                task.memory = memory.map(|(_, memory)| memory);
                task
            })
            .collect();
        // Shapes are in the list, but in no task.
        let mut bodies: Vec<Body<'_>> = Vec::new();
        let mut place_of = vec![usize::MAX; placed.len()];
        for (place, collider) in placed.iter_mut().enumerate() {
            if let (Form::Mesh(world_from_model), Some(pose)) = (&collider.placement.form, &mut collider.pose) {
                place_of[place] = bodies.len();
                bodies.push(Body::new(pose, world_from_model));
            }
        }
        for task in &mut tasks {
            (task.a, task.b) = (place_of[task.a], place_of[task.b]);
        }
        let found = batch.run(&mut bodies, &mut tasks, &TaskPoolWorkers);
        diagnostics.stats += found.stats();
        let listed = |task| Listed {
            triangles: found.get(task).to_vec(),
            is_truncated: found.is_truncated(task),
        };
        let found: Vec<Listed> = (0..asked.len()).map(listed).collect();
        for (&asked, found) in asked.iter().zip(found) {
            let contact = touch.with_mesh(placed, asked, found, *limit, diagnostics);
            answers.push((asked.pair, contact));
        }
    }
}

/// A collider that takes part.
struct Placed<'a> {
    entity: Entity,
    changed: bool,
    placement: &'a Placement,
    pose: Option<&'a mut Pose>,
}

impl<'a> Placed<'a> {
    fn new(entity: Entity, state: &'a mut ColliderState) -> Option<Self> {
        let changed = state.changed;
        let (placement, pose) = match &mut state.held {
            Some(held) => (&held.placed, &mut held.pose),
            None => (state.placed.as_ref()?, &mut state.pose),
        };
        Some(Self {
            entity,
            changed,
            placement,
            pose: pose.as_mut().map(LockedPose::get_mut),
        })
    }

    /// The mesh as a body, for one query.
    fn body(&mut self) -> Option<Body<'_>> {
        match (&self.placement.form, &mut self.pose) {
            (Form::Mesh(world_from_model), Some(pose)) => Some(Body::new(pose, world_from_model)),
            _ => None,
        }
    }
}
