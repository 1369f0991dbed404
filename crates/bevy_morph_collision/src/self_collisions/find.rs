//! Compares meshes with themselves.

use std::ops::ControlFlow;
use std::sync::Arc;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::tasks::ComputeTaskPool;
use morph_collision::{Body, Pose, TrianglePair, WorldFromModel};
use tracing::debug_span;

use super::list::MorphSelfCollisions;
use super::proofs::Proofs;
use super::regions::{Changes, middle, replace};
use super::rest::RestPairs;
use super::state::{AnsweredFor, SelfState};
use crate::app::MorphCollisionSystems;
use crate::components::MorphCollisionSettings;
use crate::state::{ColliderState, Form, MorphCollisionDiagnostics, Runs};

/// One mesh to compare with itself.
struct Job<'a> {
    state: &'a mut SelfState,
    list: &'a mut MorphSelfCollisions,
    pose: &'a mut Pose,
    world_from_model: WorldFromModel,
    /// Pairs to leave out.
    rest: Arc<[TrianglePair]>,
    limit: usize,
}

impl Job<'_> {
    fn run(self) {
        let Self { state, list, .. } = self;
        let (pairs, limit) = (&mut state.pairs, self.limit);
        pairs.clear();
        let mut is_truncated = false;
        state.query.visit(self.pose, |pair| {
            if self.rest.binary_search(&pair).is_ok() {
                return ControlFlow::Continue(());
            }
            is_truncated = pairs.len() == limit;
            if is_truncated {
                return ControlFlow::Break(());
            }
            pairs.push(pair);
            ControlFlow::Continue(())
        });
        list.is_truncated = is_truncated;
        let tree = self.pose.bvh().clone();
        let mut body = Body::new(self.pose, &WorldFromModel::IDENTITY);
        let changes = replace(
            &mut list.regions,
            pairs,
            tree.model(),
            |triangles| middle(triangles, &mut body),
            &mut state.next_region,
        );
        state.listed.clear();
        state.listed.extend(list.regions.iter().map(|region| region.region));
        state.points.clear();
        state.points.extend(list.regions.iter().map(|region| region.point));
        place_points(list, state, self.world_from_model);
        state.changes.started = changes.started;
        state.changes.ended.extend(changes.ended);
    }
}

/// Places the points of the regions in the world.
fn place_points(list: &mut MorphSelfCollisions, state: &mut SelfState, world_from_model: WorldFromModel) {
    state.world_from_model = world_from_model;
    for (region, &point) in list.regions.iter_mut().zip(&state.points) {
        region.point = world_from_model.transform_point(point).as_vec3();
    }
}

/// Runs the jobs on the threads of the compute pool, if there is one.
fn run_all(jobs: Vec<Job<'_>>) {
    match ComputeTaskPool::try_get() {
        Some(pool) if jobs.len() > 1 => {
            pool.scope::<_, ()>(|scope| {
                for job in jobs {
                    scope.spawn(async move { job.run() });
                }
            });
        }
        _ => jobs.into_iter().for_each(Job::run),
    }
}

/// The mesh of a collider, if it takes part in this run. Disabled entities are not read and keep their last place.
fn taking_part<'a>(collider: &'a mut ColliderState, runs: &Runs) -> Option<(&'a mut Pose, WorldFromModel)> {
    let placed = collider.placed.as_ref().filter(|_| collider.freshness.is_seen(runs))?;
    let Form::Mesh(world_from_model) = placed.form else {
        return None;
    };
    Some((collider.pose_mut()?, world_from_model))
}

/// Compares the meshes with themselves that changed, and reports what started and ended.
pub(crate) fn find_self_collisions(
    mut colliders: Query<(&mut MorphSelfCollisions, &mut SelfState, Option<&mut ColliderState>), Allow<Disabled>>,
    settings: Res<MorphCollisionSettings>,
    runs: Res<Runs>,
    mut rests: Local<RestPairs>,
    mut proofs: Local<Proofs>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    if colliders.is_empty() {
        rests.0.clear();
        *proofs = Proofs::default();
        return;
    }
    proofs.take_finished();
    let start = Instant::now();
    let _span = debug_span!("morph_collision::self_collisions").entered();
    let limit = settings.list_limit();
    let mut jobs = Vec::new();
    for (mut list, state, collider) in &mut colliders {
        let state = state.into_inner();
        state.changes = Changes::default();
        let include_rest = list.include_rest;
        if !state.is_of(&list) {
            state.reset(&mut list);
        }
        let taking_part = collider.and_then(|collider| taking_part(collider.into_inner(), &runs));
        let Some((pose, world_from_model)) = taking_part else {
            if state.answered_for.is_some() {
                state.reset(&mut list);
            }
            continue;
        };
        if let Some(answered_for) = &state.answered_for {
            if answered_for.is_about(pose, include_rest, limit) {
                if state.world_from_model != world_from_model && !state.points.is_empty() {
                    place_points(&mut list, state, world_from_model);
                }
                continue;
            }
            if !Arc::ptr_eq(&answered_for.tree, pose.bvh()) {
                // The same numbers of triangles mean others now.
                state.reset(&mut list);
            }
        }
        state.answered_for = Some(AnsweredFor::new(pose, include_rest, limit));
        if list.prove {
            proofs.request(pose.bvh());
        }
        let rest = if include_rest { [].into() } else { rests.of(pose.bvh()) };
        jobs.push(Job {
            state,
            list: list.into_inner(),
            pose,
            world_from_model,
            rest,
            limit,
        });
    }
    run_all(jobs);
    rests.drop_unused();
    diagnostics.spend(MorphCollisionSystems::NarrowPhase, start.elapsed());
}
