//! Finds out for every candidate pair whether and where it touches.

use std::collections::BTreeSet;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use morph_collision::batch::{BatchQuery, PairTask, Wanted};
use morph_collision::{Body, QueryStats};
use tracing::debug_span;

use super::builders::Builders;
use super::comparison::{BatchResult, Comparison, Job, Outcome, Pair, wants_all};
use super::found::FoundContacts;
use super::memories::{Memories, keep_memories};
use super::participant::PlacedCollider;
use super::starts::Starts;

use super::starts::RunView;
use crate::app::{MorphCollisionSystems, TaskPoolWorkers};
use crate::broad_phase::{Candidates, HookedPairs};
use crate::components::MorphCollisionSettings;
use crate::contacts::MorphCollisions;
use crate::state::{ColliderState, Form, MorphCollisionDiagnostics, MorphPairCosts, PairWork, RunTimes, Runs, tests};

/// Memory that the narrow phase reuses.
#[derive(Default)]
pub(crate) struct NarrowPhase {
    builders: Builders,
    batch: BatchQuery,
    /// The maximum number of triangle pairs in a contact.
    limit: usize,
    /// Whether it has changed since the last run.
    compare_all: bool,
    /// The time since the last run; 0 if it is not known.
    seconds: f64,
    /// The pairs of meshes to query.
    comparisons: Vec<Comparison>,
    /// Memory for [`PairHistory::memories`](super::PairHistory).
    next_memories: Memories,
    /// Where colliders of continuous pairs were in the last run.
    starts: Starts,
    /// The work of each pair, in any order. `None` if nobody wants to know.
    pair_work: Option<PairWork>,
}

/// Finds out for every candidate pair whether and where it touches. Queries all pairs of meshes at once, on Bevy's threads.
///
/// A pair keeps its answer if neither collider changed, unless hooks have a say in it.
pub(crate) fn find_contacts(
    candidates: Res<Candidates>,
    mut hooked: ResMut<HookedPairs>,
    mut runs: ResMut<Runs>,
    mut colliders: Query<(Entity, &mut ColliderState)>,
    collisions: Res<MorphCollisions>,
    mut found: ResMut<FoundContacts>,
    settings: Res<MorphCollisionSettings>,
    times: Res<RunTimes>,
    mut phase: Local<NarrowPhase>,
    mut costs: ResMut<MorphPairCosts>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::narrow_phase").entered();
    let phase = &mut *phase;
    phase.limit = settings.list_limit();
    phase.pair_work = (costs.limit > 0).then(PairWork::new);
    phase.compare_all = std::mem::replace(&mut found.history.limit, phase.limit) != phase.limit;
    let refused = hooked.refused_overlapping();
    diagnostics.skipped_hooks = refused;
    diagnostics.candidate_pairs -= refused;
    if runs.compare(phase.compare_all || hooked.any_changed()) {
        let (outcomes, dropped, memories) = found.begin_run();
        let hooks = (&*hooked, &dropped);
        phase.seconds = times.between.map_or(0.0, |between| between.as_secs_f64());
        let unchanged = phase.compare_pairs(
            &candidates,
            hooks,
            &mut colliders,
            &collisions,
            memories,
            outcomes,
            &mut diagnostics,
        );
        diagnostics.skipped_unchanged = unchanged;
        for (_, mut state) in &mut colliders {
            let took_part = state.placed.is_some();
            state.freshness.compared(took_part);
        }
    } else {
        diagnostics.skipped_unchanged = diagnostics.candidate_pairs;
    }
    if phase.pair_work.is_some() || !costs.pairs().is_empty() {
        costs.replace(phase.pair_work.take().unwrap_or_default());
    }
    diagnostics.spend(
        MorphCollisionSystems::NarrowPhase,
        std::mem::take(&mut hooked.duration) + start.elapsed(),
    );
}

impl NarrowPhase {
    /// Queries the pairs with a collider that changed. Returns how many pairs have none. `contacts` is the result of the last
    /// run.
    fn compare_pairs(
        &mut self,
        candidates: &Candidates,
        (hooked, dropped): (&HookedPairs, &BTreeSet<Pair>),
        colliders: &mut Query<(Entity, &mut ColliderState)>,
        contacts: &MorphCollisions,
        memories: &mut Memories,
        outcomes: &mut Vec<(Pair, Outcome)>,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) -> u64 {
        let mut involved: Vec<Entity> = (candidates.pairs.iter().chain(&candidates.swept.pairs))
            .flat_map(|&(a, b)| [a, b])
            .collect();
        involved.sort_unstable();
        involved.dedup();
        let is_involved = |entity: Entity| involved.binary_search(&entity).is_ok();
        let mut placed: Vec<_> = colliders
            .iter_mut()
            .filter(|(entity, _)| is_involved(*entity))
            .filter_map(|(entity, state)| PlacedCollider::new(entity, state.into_inner()))
            .collect();
        placed.sort_unstable_by_key(|collider| collider.entity);
        let index_of = |placed: &[PlacedCollider], entity: Entity| {
            placed.binary_search_by_key(&entity, |collider| collider.entity).ok()
        };
        let compare = |pair: Pair, is_swept: bool, placed: &[PlacedCollider]| {
            let indices = (index_of(placed, pair.0)?, index_of(placed, pair.1)?);
            let [a, b] = [&placed[indices.0], &placed[indices.1]];
            Some(Comparison {
                pair,
                indices,
                mode: a.placement.mode.max(b.placement.mode),
                // A contact that lasts cannot begin, unless only margins touched, nor can one that hooks dropped.
                is_swept: is_swept
                    && (a.changed || b.changed)
                    && contacts
                        .get(pair.0, pair.1)
                        .is_none_or(|contact| contact.distance > 0.0)
                    && !dropped.contains(&pair),
            })
        };
        let (pairs, swept) = (&candidates.pairs, &candidates.swept);
        let mut unchanged = 0;
        let mut jobs = Vec::new();
        self.comparisons.clear();
        for &pair in pairs {
            if hooked.refuse(pair) {
                continue;
            }
            let is_swept = !swept.pairs.is_empty() && swept.pairs.binary_search(&pair).is_ok();
            let Some(comparison) = compare(pair, is_swept, &placed) else {
                // A hook has despawned a collider.
                outcomes.push((pair, Outcome::Apart));
                continue;
            };
            let (a, b) = comparison.indices;
            let any_changed = placed[a].changed || placed[b].changed || hooked.have_no_answer(pair);
            if !any_changed && !self.compare_all {
                unchanged += 1;
                continue;
            }
            match (&placed[a].placement.form, &placed[b].placement.form) {
                (Form::Mesh(_), Form::Mesh(_)) => self.comparisons.push(comparison),
                (Form::Shape(_), Form::Shape(_)) => {}
                _ => jobs.push(Job {
                    comparison,
                    known: BatchResult::NotAsked,
                }),
            }
        }
        self.compare_meshes(&mut placed, contacts, memories, &mut jobs, outcomes, diagnostics);
        let is_only_swept = |pair: &&Pair| pairs.binary_search(pair).is_err() && !hooked.refuse(**pair);
        for &pair in swept.pairs.iter().filter(is_only_swept) {
            if let Some(comparison) = compare(pair, true, &placed).filter(|comparison| comparison.is_swept) {
                let known = BatchResult::Apart;
                jobs.push(Job { comparison, known });
            }
        }
        diagnostics.swept_pairs = self.starts.prepare(&jobs, &placed, swept);
        let view = RunView {
            colliders: &placed,
            starts: &self.starts,
            seconds: self.seconds,
            limit: self.limit,
            counts_pairs: self.pair_work.is_some(),
        };
        let work = self.builders.run(&TaskPoolWorkers, view, &mut jobs, outcomes);
        diagnostics.stats += work.stats;
        diagnostics.swept_stats = work.swept;
        diagnostics.limited_pairs = work.limited_pairs;
        if let Some(pairs) = &mut self.pair_work {
            pairs.extend(work.pairs);
        }
        unchanged
    }

    /// Finds the intersecting triangles of the pairs to compare. Pairs that might have a contact become jobs; the others are answered.
    fn compare_meshes(
        &mut self,
        placed: &mut [PlacedCollider<'_>],
        contacts: &MorphCollisions,
        memories: &mut Memories,
        jobs: &mut Vec<Job>,
        outcomes: &mut Vec<(Pair, Outcome)>,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) {
        let Self {
            builders: _,
            batch,
            limit,
            compare_all: _,
            seconds: _,
            comparisons,
            next_memories,
            starts: _,
            pair_work,
        } = self;
        keep_memories(comparisons, contacts, memories, next_memories);
        let mut memories = memories.iter_mut().peekable();
        let counted = if pair_work.is_some() { comparisons.len() } else { 0 };
        let mut work = vec![QueryStats::default(); counted];
        let mut stats = work.iter_mut();
        let mut tasks: Vec<_> = comparisons
            .iter()
            .map(|comparison| {
                let (a, b) = comparison.indices;
                let wanted = if wants_all(comparison.mode) {
                    Wanted::UpTo(*limit)
                } else {
                    Wanted::First
                };
                let mut task = PairTask::new(a, b, wanted);
                let memory = memories.next_if(|(pair, _)| *pair == comparison.pair);
                task.memory = memory.map(|(_, memory)| memory);
                task.stats = stats.next();
                task
            })
            .collect();
        // Shapes are in the list, but in no task.
        let mut bodies: Vec<Body<'_>> = Vec::new();
        let mut body_of = vec![usize::MAX; placed.len()];
        for (index, collider) in placed.iter_mut().enumerate() {
            if let (Form::Mesh(world_from_model), Some(pose)) = (&collider.placement.form, &mut collider.pose) {
                body_of[index] = bodies.len();
                bodies.push(Body::new(pose.get_mut(), world_from_model));
            }
        }
        for task in &mut tasks {
            (task.a, task.b) = (body_of[task.a], body_of[task.b]);
        }
        let found = batch.run(&mut bodies, &mut tasks, &TaskPoolWorkers);
        diagnostics.stats += found.stats();
        if let Some(pairs) = pair_work {
            let counted = comparisons.iter().zip(&work);
            pairs.extend(counted.map(|(comparison, work)| (comparison.pair, tests(work))));
        }
        for (task, &comparison) in comparisons.iter().enumerate() {
            let triangles = found.get(task);
            let (a, b) = comparison.indices;
            let margin = placed[a].placement.margin + placed[b].placement.margin;
            if triangles.is_empty() && margin == 0.0 && !comparison.is_swept {
                outcomes.push((comparison.pair, Outcome::Apart));
                continue;
            }
            let known = BatchResult::Triangles {
                triangles: triangles.to_vec(),
                is_truncated: found.is_truncated(task),
            };
            jobs.push(Job { comparison, known });
        }
    }
}
