//! Compares meshes with themselves.

use std::ops::ControlFlow;
use std::sync::Arc;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::math::Affine3A;
use bevy::platform::collections::HashMap;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::tasks::ComputeTaskPool;
use morph_collision::{Body, JointMatrices, MorphBvh, Pose, SelfQuery, TrianglePair, WorldFromModel};
use tracing::debug_span;

use super::proofs::Proofs;
use super::regions::{Changes, middle, replace};
use super::{MorphSelfCollisionEnd, MorphSelfCollisionStart, MorphSelfCollisions, MorphSelfContact};
use crate::broad_phase::Candidates;
use crate::components::{MorphCollisionEventsEnabled, MorphCollisionSettings};
use crate::state::{ColliderState, Form, MorphCollisionDiagnostics};

/// The plugin's state for one [`MorphSelfCollisions`].
#[derive(Component, Default)]
pub(crate) struct SelfState {
    /// The regions that the list had after the last run. The game may have replaced the list since.
    listed: Vec<u32>,
    query: SelfQuery,
    pairs: Vec<TrianglePair>,
    /// What the regions are the answer to. `None` if the collider takes no part.
    asked: Option<Asked>,
    next_region: u32,
    changes: Changes,
    /// The points of the regions in the space of the pose, and where that is in the world.
    points: Vec<Vec3>,
    place: WorldFromModel,
}

/// Everything that an answer depends on.
struct Asked {
    tree: Arc<MorphBvh>,
    weights: Vec<f32>,
    joints: Option<JointMatrices>,
    include_rest: bool,
    limit: usize,
}

impl Asked {
    fn new(pose: &Pose, include_rest: bool, limit: usize) -> Self {
        Self {
            tree: pose.bvh().clone(),
            weights: pose.weights().to_vec(),
            joints: pose.joints().cloned(),
            include_rest,
            limit,
        }
    }

    fn is_about(&self, pose: &Pose, include_rest: bool, limit: usize) -> bool {
        Arc::ptr_eq(&self.tree, pose.bvh())
            && self.weights == pose.weights()
            && self.joints.as_ref() == pose.joints()
            && (self.include_rest, self.limit) == (include_rest, limit)
    }
}

/// The pairs of triangles that intersect at rest, for each tree, sorted.
#[derive(Default)]
pub(crate) struct RestPairs(HashMap<usize, (Arc<MorphBvh>, Arc<[TrianglePair]>)>);

impl RestPairs {
    fn of(&mut self, tree: &Arc<MorphBvh>) -> Arc<[TrianglePair]> {
        // The tree is kept, so no other one gets its address.
        let (_, pairs) = self.0.entry(Arc::as_ptr(tree).addr()).or_insert_with(|| {
            let mut pose = Pose::new(tree.clone());
            let bound = vec![Affine3A::IDENTITY; tree.model().joint_count().unwrap_or(0)];
            if let Ok(bound) = JointMatrices::new(&bound) {
                let _is_rigid = pose.set_joints(&bound);
            }
            let mut pairs = Vec::new();
            // A mesh that is collapsed at rest would list the square of its triangles.
            SelfQuery::new().up_to(&mut pose, MAX_REST_PAIRS, &mut pairs);
            pairs.sort_unstable();
            (tree.clone(), pairs.into())
        });
        pairs.clone()
    }

    /// Drops those of trees that nothing else uses.
    fn drop_unused(&mut self) {
        self.0.retain(|_, (tree, _)| Arc::strong_count(tree) > 1);
    }
}

/// The maximum number of pairs that are remembered as intersecting at rest.
const MAX_REST_PAIRS: usize = 1 << 20;

/// One mesh to compare with itself.
struct Job<'a> {
    state: &'a mut SelfState,
    list: &'a mut MorphSelfCollisions,
    pose: &'a mut Pose,
    place: WorldFromModel,
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
        put(list, state, self.place);
        state.changes.started = changes.started;
        state.changes.ended.extend(changes.ended);
    }
}

/// Places the points of the regions in the world.
fn put(list: &mut MorphSelfCollisions, state: &mut SelfState, place: WorldFromModel) {
    state.place = place;
    for (region, &point) in list.regions.iter_mut().zip(&state.points) {
        region.point = place.transform_point(point).as_vec3();
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
fn taking_part(collider: &mut ColliderState, run: u32) -> Option<(&mut Pose, WorldFromModel)> {
    let Form::Mesh(place) = collider.placed.filter(|_| collider.seen == run)?.form else {
        return None;
    };
    Some((collider.pose_mut()?, place))
}

impl SelfState {
    /// Ends all regions.
    fn reset(&mut self, list: &mut MorphSelfCollisions) {
        self.changes.ended.append(&mut self.listed);
        self.asked = None;
        list.regions.clear();
        list.is_truncated = false;
    }

    fn is_of(&self, list: &MorphSelfCollisions) -> bool {
        self.listed.iter().eq(list.regions.iter().map(|region| &region.region))
    }
}

/// Compares the meshes with themselves that changed, and reports what started and ended.
pub(crate) fn find_self_collisions(
    mut colliders: Query<(&mut MorphSelfCollisions, &mut SelfState, Option<&mut ColliderState>), Allow<Disabled>>,
    settings: Res<MorphCollisionSettings>,
    candidates: Res<Candidates>,
    mut rests: Local<RestPairs>,
    mut proofs: Local<Proofs>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    if colliders.is_empty() {
        rests.0.clear();
        *proofs = Proofs::default();
        return;
    }
    proofs.follow();
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
        let taking_part = collider.and_then(|collider| taking_part(collider.into_inner(), candidates.run()));
        let Some((pose, place)) = taking_part else {
            if state.asked.is_some() {
                state.reset(&mut list);
            }
            continue;
        };
        if let Some(asked) = &state.asked {
            if asked.is_about(pose, include_rest, limit) {
                if state.place != place && !state.points.is_empty() {
                    put(&mut list, state, place);
                }
                continue;
            }
            if !Arc::ptr_eq(&asked.tree, pose.bvh()) {
                // The same numbers of triangles mean others now.
                state.reset(&mut list);
            }
        }
        state.asked = Some(Asked::new(pose, include_rest, limit));
        if list.prove {
            proofs.want(pose.bvh());
        }
        let rest = if include_rest { [].into() } else { rests.of(pose.bvh()) };
        jobs.push(Job {
            state,
            list: list.into_inner(),
            pose,
            place,
            rest,
            limit,
        });
    }
    run_all(jobs);
    rests.drop_unused();
    diagnostics.duration += start.elapsed();
}

/// Reports what started and ended.
pub(crate) fn report_self_collisions(
    mut colliders: Query<
        (
            Entity,
            &MorphSelfCollisions,
            &mut SelfState,
            Has<MorphCollisionEventsEnabled>,
        ),
        Allow<Disabled>,
    >,
    mut starts: MessageWriter<MorphSelfCollisionStart>,
    mut ends: MessageWriter<MorphSelfCollisionEnd>,
    mut commands: Commands,
) {
    for (collider, _, state, is_observed) in &colliders {
        for &region in &state.changes.ended {
            let end = MorphSelfCollisionEnd { collider, region };
            ends.write(end);
            if is_observed {
                commands.trigger(end);
            }
        }
    }
    for (collider, list, mut state, is_observed) in &mut colliders {
        let changes = std::mem::take(&mut state.changes);
        let started = |region: &&MorphSelfContact| changes.started.contains(&region.region);
        for contact in list.regions().iter().filter(started) {
            let Some(&triangles) = contact.triangles.first() else {
                continue;
            };
            let start = MorphSelfCollisionStart {
                collider,
                region: contact.region,
                point: contact.point,
                triangles,
            };
            starts.write(start);
            if is_observed {
                commands.trigger(start);
            }
        }
    }
}

/// Ends the regions of a component that is removed, also by despawning its entity.
pub(crate) fn end_with_component(
    removed: On<Remove<MorphSelfCollisions>>,
    states: Query<&SelfState, Allow<Disabled>>,
    observed: Query<(), (With<MorphCollisionEventsEnabled>, Allow<Disabled>)>,
    mut ends: MessageWriter<MorphSelfCollisionEnd>,
    mut commands: Commands,
) {
    let collider = removed.entity;
    let Ok(state) = states.get(collider) else { return };
    // Within a run, what has just ended or started has not been reported yet; afterwards, both lists are empty.
    let told = |region: &&u32| !state.changes.started.contains(region);
    for &region in state.changes.ended.iter().chain(state.listed.iter().filter(told)) {
        let end = MorphSelfCollisionEnd { collider, region };
        ends.write(end);
        if observed.contains(collider) {
            commands.trigger(end);
        }
    }
    commands.entity(collider).try_remove::<SelfState>();
}
