//! Finds out for every candidate pair whether and where it touches.

use bevy::platform::time::Instant;
use bevy::prelude::*;
use morph_collision::Body;
use morph_collision::batch::{BatchQuery, PairTask, Wanted};
use tracing::debug_span;

use super::builders::Builders;
use super::comparison::{Answer, Asked, Found, Job, Pair, wants_all};
use super::memories::{Memories, keep_memories};
use super::participant::Placed;
use super::starts::Starts;
use super::workers::TaskPoolWorkers;

use crate::broad_phase::Candidates;
use crate::components::MorphCollisionSettings;
use crate::contacts::MorphCollisions;
use crate::state::{ColliderState, Form, MorphCollisionDiagnostics, RunTimes, Runs};

/// Memory that the narrow phase reuses.
#[derive(Default)]
pub(crate) struct Scratch {
    builders: Builders,
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
    /// Where colliders of continuous pairs were in the last run.
    starts: Starts,
    answers: Vec<(Pair, Answer)>,
}

/// Finds out for every candidate pair whether and where it touches. Queries all pairs of meshes at once, on Bevy's threads.
///
/// A pair keeps its answer if neither collider changed.
pub(crate) fn find_contacts(
    candidates: Res<Candidates>,
    mut runs: ResMut<Runs>,
    mut colliders: Query<(Entity, &mut ColliderState)>,
    mut collisions: ResMut<MorphCollisions>,
    settings: Res<MorphCollisionSettings>,
    times: Res<RunTimes>,
    mut scratch: Local<Scratch>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::narrow_phase").entered();
    let collisions = &mut *collisions;
    collisions.begin_run();
    let scratch = &mut *scratch;
    let limit = settings.list_limit();
    scratch.compare_all = std::mem::replace(&mut scratch.limit, limit) != limit;
    if runs.compare(scratch.compare_all) {
        scratch.answers.clear();
        scratch.builders.seconds = times.between.map_or(0.0, |between| between.as_secs_f64());
        let unchanged = scratch.ask(&candidates, &mut colliders, collisions, &mut diagnostics);
        diagnostics.skipped_unchanged = unchanged;
        take_over(collisions, &candidates.pairs, &mut scratch.answers);
        for (_, mut state) in &mut colliders {
            let took_part = state.placed.is_some();
            state.freshness.compared(took_part);
        }
    } else {
        diagnostics.skipped_unchanged = candidates.pairs.len() as u64;
    }
    let triangles = collisions.iter().map(|contact| contact.triangles.len() as u64);
    diagnostics.triangle_pairs = triangles.sum();
    diagnostics.touching_pairs = collisions.len() as u64;
    diagnostics.duration += start.elapsed();
}

/// Takes over the answers, in any order, and ends the contacts of pairs that are no longer candidates.
fn take_over(collisions: &mut MorphCollisions, candidates: &[Pair], answers: &mut Vec<(Pair, Answer)>) {
    collisions.end_unless(|pair| candidates.binary_search(&pair).is_ok());
    let mut passed = Vec::new();
    for (pair, answer) in answers.drain(..) {
        match answer {
            Answer::Touching(contact) => collisions.touch(contact),
            Answer::Passed(contact) => passed.push(contact),
            Answer::Apart => collisions.part(pair),
        }
    }
    collisions.end_run(passed);
}

impl Scratch {
    /// Queries the pairs with a collider that changed. Returns how many pairs have none. `contacts` is the result of the last
    /// run.
    fn ask(
        &mut self,
        candidates: &Candidates,
        colliders: &mut Query<(Entity, &mut ColliderState)>,
        contacts: &MorphCollisions,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) -> u64 {
        let mut placed: Vec<_> = colliders
            .iter_mut()
            .filter_map(|(entity, state)| Placed::new(entity, state.into_inner()))
            .collect();
        placed.sort_unstable_by_key(|collider| collider.entity);
        let place =
            |placed: &[Placed], entity: Entity| placed.binary_search_by_key(&entity, |collider| collider.entity).ok();
        let asked = |pair: Pair, is_swept: bool, placed: &[Placed]| {
            let places = (place(placed, pair.0)?, place(placed, pair.1)?);
            let [a, b] = [&placed[places.0], &placed[places.1]];
            Some(Asked {
                pair,
                places,
                mode: a.placement.mode.max(b.placement.mode),
                // A contact that lasts cannot begin.
                is_swept: is_swept && (a.changed || b.changed) && !contacts.contains(pair.0, pair.1),
            })
        };
        let (pairs, swept) = (&candidates.pairs, &candidates.swept);
        let mut unchanged = 0;
        let mut jobs = Vec::new();
        self.asked.clear();
        for &pair in pairs {
            let is_swept = !swept.pairs.is_empty() && swept.pairs.binary_search(&pair).is_ok();
            let Some(asked) = asked(pair, is_swept, &placed) else {
                continue;
            };
            let (a, b) = asked.places;
            if !placed[a].changed && !placed[b].changed && !self.compare_all {
                unchanged += 1;
                continue;
            }
            match (placed[a].placement.form, placed[b].placement.form) {
                (Form::Mesh(_), Form::Mesh(_)) => self.asked.push(asked),
                (Form::Shape(_), Form::Shape(_)) => {}
                _ => jobs.push(Job {
                    asked,
                    found: Found::Unknown,
                }),
            }
        }
        self.ask_meshes(&mut placed, contacts, &mut jobs, diagnostics);
        for &pair in swept.pairs.iter().filter(|pair| pairs.binary_search(pair).is_err()) {
            if let Some(asked) = asked(pair, true, &placed).filter(|asked| asked.is_swept) {
                let found = Found::Apart;
                jobs.push(Job { asked, found });
            }
        }
        diagnostics.swept_pairs = self.starts.prepare(&jobs, &placed, swept);
        let work = self.builders.run(
            &TaskPoolWorkers,
            (&placed, &self.starts),
            &mut jobs,
            self.limit,
            &mut self.answers,
        );
        diagnostics.stats += work.stats;
        diagnostics.swept_stats = work.swept;
        diagnostics.limited_pairs = work.limited_pairs;
        unchanged
    }

    /// Finds the intersecting triangles of the asked pairs. Pairs that might have a contact become jobs; the others are answered.
    fn ask_meshes(
        &mut self,
        placed: &mut [Placed<'_>],
        contacts: &MorphCollisions,
        jobs: &mut Vec<Job>,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) {
        let Self {
            builders: _,
            batch,
            limit,
            compare_all: _,
            asked,
            memories,
            next_memories,
            starts: _,
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
                bodies.push(Body::new(pose.get_mut(), world_from_model));
            }
        }
        for task in &mut tasks {
            (task.a, task.b) = (place_of[task.a], place_of[task.b]);
        }
        let found = batch.run(&mut bodies, &mut tasks, &TaskPoolWorkers);
        diagnostics.stats += found.stats();
        for (task, &asked) in asked.iter().enumerate() {
            let triangles = found.get(task);
            let (a, b) = asked.places;
            let margin = placed[a].placement.margin + placed[b].placement.margin;
            if triangles.is_empty() && margin == 0.0 && !asked.is_swept {
                answers.push((asked.pair, Answer::Apart));
                continue;
            }
            let found = Found::Triangles {
                triangles: triangles.to_vec(),
                is_truncated: found.is_truncated(task),
            };
            jobs.push(Job { asked, found });
        }
    }
}
