//! The system parameter.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use morph_collision::{Aabb, Body, InputError};

use super::MorphQueryFilter;
use super::state::{BorrowedQueries, Queries, SpatialState};
use super::surface::Surfaces;
use super::target::{Target, state_of, with_target};
use super::walker::Walker;
use crate::broad_phase::Candidates;
use crate::components::MorphCollisionSettings;
use crate::state::{ColliderState, RunTimes, Runs};

/// Spatial queries for [`MorphCollider`](crate::components::MorphCollider)s in their current pose: ray casts, shape casts, intersections,
/// closest points and contacts.
///
/// The parameter only reads, and its methods take `&self`, so any number of systems and threads can query at the same time. It
/// reads `Assets<Mesh>` for the UV coordinates and the joint of a hit; a system that also changes meshes needs a `ParamSet`.
///
/// All values are in world space and `f32`; internally the queries are exact, as described in [`morph_collision`].
///
/// - **State.** Queries see colliders in the state of the plugin's last run. Later changes of weights and transforms in a frame
///   count from the next run on. Nodes that a query refits stay refitted for later queries.
/// - **Order.** In the plugin's own schedule, order your system before
///   [`MorphCollisionSystems::Weights`](crate::app::MorphCollisionSystems::Weights) or after
///   [`MorphCollisionSystems::Events`](crate::app::MorphCollisionSystems::Events). In between, weights are new but transforms are old.
/// - **What is found.** Colliders that are [disabled](crate::components::MorphColliderDisabled) or whose mesh is not loaded yet are not
///   found. Meshes are surfaces, [`MorphShape`](crate::components::MorphShape)s are solid: a ray that starts inside a shape hits it at once.
/// - **Cost.** A tree over the boxes of all colliders finds the relevant ones. The first query after a run with changes updates
///   this tree, which visits every collider.
/// - **Predicates.** Each method with a filter has a variant that also calls a predicate for every collider that it would look
///   at, in no particular order. The predicate may run further queries.
/// - **Many at once.** [`MorphSpatialQuery::cast_rays`], [`MorphSpatialQuery::project_points`] and
///   [`MorphSpatialQuery::intersections_with_shapes`] answer many questions faster than one by one, on Bevy's threads.
/// - **Bad input.** A query with invalid input, such as a NaN direction, finds nothing. The log warns once per method.
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
    /// Includes disabled entities.
    states: Query<'w, 's, &'static ColliderState, Allow<Disabled>>,
    surfaces: Surfaces<'w, 's>,
    candidates: Option<Res<'w, Candidates>>,
    runs: Option<Res<'w, Runs>>,
    state: Option<Res<'w, SpatialState>>,
    settings: Option<Res<'w, MorphCollisionSettings>>,
    pub(super) times: Option<Res<'w, RunTimes>>,
}

impl std::fmt::Debug for MorphSpatialQuery<'_, '_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MorphSpatialQuery").finish_non_exhaustive()
    }
}

impl MorphSpatialQuery<'_, '_> {
    /// The maximum number of triangle pairs that an answer looks at.
    pub(super) fn list_limit(&self) -> usize {
        let settings = self.settings.as_deref().copied();
        settings.unwrap_or_default().list_limit()
    }

    /// Unwraps a query's result, or logs what is wrong with its input.
    pub(super) fn valid<T>(&self, method: &'static str, asked: Result<T, InputError>) -> Option<T> {
        asked
            .inspect_err(|error| {
                if let Some(state) = &self.state {
                    state.warn(method, error);
                }
            })
            .ok()
    }

    /// Memory; `None` without the plugin.
    pub(super) fn borrow(&self) -> Option<BorrowedQueries<'_>> {
        Some(self.state.as_ref()?.borrow())
    }

    /// Starts to walk over colliders; `None` without the plugin. Updates the index of colliders if necessary.
    pub(super) fn walker(&self) -> Option<Walker<'_, '_, '_>> {
        let (candidates, runs, state) = (self.candidates.as_ref()?, self.runs.as_ref()?, self.state.as_ref()?);
        Some(Walker {
            colliders: &self.colliders,
            runs,
            candidates,
            index: state.index(candidates, runs, &self.states),
            borrowed: state.borrow(),
            copies: None,
        })
    }

    /// A single [`Walker::walk`].
    pub(super) fn walk(
        &self,
        filter: &MorphQueryFilter,
        predicate: &mut dyn FnMut(Entity) -> bool,
        limit: f32,
        bound: impl FnMut(&Aabb) -> Option<f32>,
        at: impl FnMut(&mut Queries, Entity, Target<'_>) -> f32,
    ) {
        if let Some(mut walker) = self.walker() {
            walker.walk(filter, predicate, limit, bound, at);
        }
    }

    /// A collider's state after the last run; `None` if it took no part. Disabled entities are not updated, so their old state
    /// does not count when they are enabled again.
    pub(super) fn state(&self, collider: Entity) -> Option<&ColliderState> {
        state_of(&self.colliders, self.runs.as_ref()?, collider)
    }

    /// Calls `ask` with a collider's mesh; `None` if the collider does not exist or has a shape.
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
