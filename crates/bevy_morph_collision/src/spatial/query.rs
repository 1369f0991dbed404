use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use morph_collision::{Aabb, Body, InputError, PlacedShape};

use super::MorphQueryFilter;
use super::state::{Queries, Scratch, SpatialState};
use super::surface::Surfaces;
use crate::broad_phase::Candidates;
use crate::collider::{ColliderState, Form};
use crate::settings::MorphCollisionSettings;
use crate::velocities::RunTimes;

/// Asks about [`MorphCollider`](crate::MorphCollider)s as they are posed: rays, shape casts, intersections, closest points, contacts.
///
/// It only reads, and its methods take `&self`: any number of systems can ask at the same time, and one system from many threads. Among what it reads are
/// `Assets<Mesh>`, for the UV and the joint of a hit: a system that also changes meshes needs a `ParamSet` of both.
///
/// Everything is in world space and `f32`; the work behind it is exact, as [`morph_collision`] describes it. Colliders are as the
/// plugin's last run left them: weights and places that change later in a frame count from the next run on. What a
/// query looks at is refitted for it, and stays so for whatever comes after. Order a system that asks in the plugin's own schedule before
/// [`MorphCollisionSystems::Weights`](crate::MorphCollisionSystems::Weights) or after
/// [`MorphCollisionSystems::Events`](crate::MorphCollisionSystems::Events): between them, weights are new and places old. Colliders that are
/// [disabled](crate::MorphColliderDisabled), or whose mesh is not loaded yet, are not there.
///
/// Meshes are surfaces, [`MorphShape`](crate::MorphShape)s are solid: a ray that starts inside a shape hits it at once.
///
/// A tree over all colliders' boxes finds those that a question is about. The first question after a run in which anything changed brings it up to
/// date, at the cost of a look at every collider.
///
/// Each method with a filter has a twin that also asks a predicate about every collider it would look at, in no particular order. The predicate
/// may ask further questions.
///
/// What cannot be asked, such as a direction that is not a number, finds nothing. The first time for each method, the log warns of it.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn what_is_below(spatial: MorphSpatialQuery, players: Query<(Entity, &GlobalTransform)>) {
///     for (player, place) in &players {
///         let filter = MorphQueryFilter::from_excluded_entities([player]);
///         if let Some(hit) = spatial.cast_ray(place.translation(), Dir3::NEG_Y, 100.0, &filter) {
///             println!("{} is {} above triangle {} of {}", player, hit.distance, hit.triangle, hit.entity);
///         }
///     }
/// }
/// # App::new().add_systems(Update, what_is_below);
/// ```
#[derive(SystemParam)]
pub struct MorphSpatialQuery<'w, 's> {
    colliders: Query<'w, 's, &'static ColliderState>,
    /// Those of disabled entities, too.
    states: Query<'w, 's, &'static ColliderState, Allow<Disabled>>,
    surfaces: Surfaces<'w, 's>,
    candidates: Option<Res<'w, Candidates>>,
    state: Option<Res<'w, SpatialState>>,
    settings: Option<Res<'w, MorphCollisionSettings>>,
    pub(super) times: Option<Res<'w, RunTimes>>,
}

impl std::fmt::Debug for MorphSpatialQuery<'_, '_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MorphSpatialQuery").finish_non_exhaustive()
    }
}

/// A collider, for one query.
pub(super) enum Target<'a> {
    Mesh(Body<'a>),
    Shape(&'a PlacedShape),
}

impl MorphSpatialQuery<'_, '_> {
    /// The most triangle pairs that an answer looks at.
    pub(super) fn list_limit(&self) -> usize {
        let settings = self.settings.as_deref().copied();
        settings.unwrap_or_default().list_limit()
    }

    /// What a question came to, or what is wrong with it.
    pub(super) fn valid<T>(&self, method: &'static str, asked: Result<T, InputError>) -> Option<T> {
        asked
            .inspect_err(|error| {
                if let Some(state) = &self.state {
                    state.warn(method, error);
                }
            })
            .ok()
    }

    /// Scratch memory; `None` without the plugin.
    pub(super) fn scratch(&self) -> Option<Scratch<'_>> {
        Some(self.state.as_ref()?.scratch())
    }

    /// Calls `at` for colliders that pass a filter and a predicate, in ascending order of the lower bounds that `bound` tells for their boxes,
    /// until what is left is above the limit that it returns.
    ///
    /// The pose of a mesh is locked while `at` runs, so `at` must not ask about other colliders.
    pub(super) fn walk(
        &self,
        filter: &MorphQueryFilter,
        predicate: &mut dyn FnMut(Entity) -> bool,
        limit: f32,
        bound: impl FnMut(&Aabb) -> Option<f32>,
        mut at: impl FnMut(&mut Queries, Entity, Target<'_>) -> f32,
    ) {
        let (Some(candidates), Some(state)) = (&self.candidates, &self.state) else {
            return;
        };
        let index = state.index(candidates, &self.states);
        let mut scratch = state.scratch();
        let queries = scratch.queries();
        let mut queue = std::mem::take(&mut queries.queue);
        let mut last = limit;
        index.walk(&mut queue, limit, bound, |place| {
            let (collider, placed) = &candidates.colliders()[place];
            if filter.takes(*collider, placed)
                && predicate(*collider)
                && let Some(state) = self.state(*collider)
                && let Some(limit) = with_target(state, |target| at(queries, *collider, target))
            {
                last = limit;
            }
            last
        });
        queries.queue = queue;
    }

    /// A collider as the last run left it; `None` if it took no part. While an entity is disabled nobody looks at it, so what it was like before does
    /// not count when it is enabled again.
    pub(super) fn state(&self, collider: Entity) -> Option<&ColliderState> {
        let run = self.candidates.as_ref()?.run();
        let state = self.colliders.get(collider).ok()?;
        (state.seen == run).then_some(state)
    }

    /// Does something with a collider's mesh; `None` if there is no such collider, or it has a shape.
    pub(super) fn with_mesh<T>(&self, collider: Entity, ask: impl FnOnce(Body<'_>) -> Option<T>) -> Option<T> {
        with_target(self.state(collider)?, |target| match target {
            Target::Mesh(body) => ask(body),
            Target::Shape(_) => None,
        })?
    }

    pub(super) fn uv(&self, entity: Entity, triangle: u32, barycentrics: Vec3) -> Option<Vec2> {
        let state = self.state(entity)?;
        self.surfaces.uv(entity, state, triangle, barycentrics)
    }

    pub(super) fn joint(&self, entity: Entity, triangle: u32, barycentrics: Vec3) -> Option<Entity> {
        let state = self.state(entity)?;
        self.surfaces.joint(entity, state, triangle, barycentrics)
    }
}

/// Does something with a collider as it stands.
pub(super) fn with_target<T>(state: &ColliderState, ask: impl FnOnce(Target<'_>) -> T) -> Option<T> {
    Some(match &state.placed.as_ref()?.form {
        Form::Mesh(world_from_model) => {
            let mut pose = state.pose.as_ref()?.lock();
            ask(Target::Mesh(Body::new(&mut pose, world_from_model)))
        }
        Form::Shape(shape) => ask(Target::Shape(shape)),
    })
}
