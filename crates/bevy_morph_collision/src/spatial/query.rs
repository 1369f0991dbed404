use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use morph_collision::{Aabb, Body, ContactQuery, DistanceQuery, Pose, RayHit, RayQuery, ShapeQuery, WorldFromModel};

use super::MorphQueryFilter;
use super::surface::Surfaces;
use crate::collider::{ColliderState, Form};
use crate::narrow_phase::world_triangle;
use crate::settings::MorphCollisionSettings;
use crate::velocities::RunTimes;

/// Asks about the meshes of [`MorphCollider`](crate::MorphCollider)s as they are posed: rays, overlaps, closest points, contacts.
///
/// Everything is in world space and `f32`; the work behind it is exact, as [`morph_collision`] describes it. Colliders are as the
/// plugin's last run left them: weights and places that change later in a frame count from the next run on. What a
/// query looks at is refitted for it, and stays so for whatever comes after. Colliders that are
/// [disabled](crate::MorphColliderDisabled), or whose mesh is not loaded yet, are not there. Entities with a
/// [`MorphShape`](crate::MorphShape) are not looked at, even if they have a mesh.
///
/// A number that is not finite is an [`InputError`](morph_collision::InputError).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn what_is_below(mut spatial: MorphSpatialQuery, players: Query<(Entity, &GlobalTransform)>) -> Result {
///     for (player, place) in &players {
///         let filter = MorphQueryFilter::default().without([player]);
///         if let Some(hit) = spatial.cast_ray(place.translation(), Dir3::NEG_Y, 100.0, &filter)? {
///             println!("{} is {} above triangle {} of {}", player, hit.distance, hit.triangle, hit.entity);
///         }
///     }
///     Ok(())
/// }
/// # App::new().add_systems(Update, what_is_below);
/// ```
#[derive(SystemParam)]
pub struct MorphSpatialQuery<'w, 's> {
    pub(super) colliders: Query<'w, 's, (Entity, &'static mut ColliderState)>,
    surfaces: Surfaces<'w, 's>,
    settings: Option<Res<'w, MorphCollisionSettings>>,
    pub(super) times: Option<Res<'w, RunTimes>>,
    pub(super) queries: Local<'s, Queries>,
}

/// What queries reuse.
#[derive(Default)]
pub(super) struct Queries {
    pub(super) ray: RayQuery,
    pub(super) shape: ShapeQuery,
    pub(super) distance: DistanceQuery,
    pub(super) contact: ContactQuery,
    pub(super) hits: Vec<RayHit>,
    /// Colliders that a query may be about, each with a lower bound of what it wants to know.
    pub(super) near: Vec<(f32, Entity)>,
}

impl std::fmt::Debug for MorphSpatialQuery<'_, '_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MorphSpatialQuery").finish_non_exhaustive()
    }
}

impl MorphSpatialQuery<'_, '_> {
    /// The most triangle pairs that an answer looks at.
    pub(super) fn list_limit(&self) -> usize {
        let settings = self.settings.as_deref().copied();
        settings.unwrap_or_default().list_limit()
    }

    /// The colliders that pass a filter and for whose bounds something can be said, lowest first.
    pub(super) fn near(
        &mut self,
        filter: &MorphQueryFilter,
        mut bound: impl FnMut(&Aabb) -> Option<f32>,
    ) -> Vec<(f32, Entity)> {
        let mut near = std::mem::take(&mut self.queries.near);
        near.clear();
        for (entity, state) in &self.colliders {
            let Some(placed) = &state.placed else { continue };
            if state.pose.is_some() && filter.takes(entity, placed.body, placed.layers) {
                near.extend(bound(&placed.bounds).map(|bound| (bound, entity)));
            }
        }
        near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        near
    }

    pub(super) fn meeting(
        &mut self,
        near: Vec<(f32, Entity)>,
        mut meets: impl FnMut(&mut Queries, Body<'_>) -> bool,
    ) -> Vec<Entity> {
        let mut met = Vec::new();
        for &(_, entity) in &near {
            let Ok((_, mut state)) = self.colliders.get_mut(entity) else {
                continue;
            };
            if body(&mut state).is_some_and(|body| meets(&mut self.queries, body)) {
                met.push(entity);
            }
        }
        self.queries.near = near;
        met
    }

    pub(super) fn normal(&mut self, entity: Entity, triangle: u32) -> Vec3 {
        let corners = self.colliders.get_mut(entity).ok().and_then(|(_, mut state)| {
            let mut body = body(&mut state)?;
            world_triangle(&mut body, triangle)
        });
        let normal = corners.map(|[a, b, c]| (b - a).cross(c - a).normalize_or_zero());
        normal.unwrap_or_default().as_vec3()
    }

    pub(super) fn uv(&self, entity: Entity, triangle: u32, barycentrics: Vec3) -> Option<Vec2> {
        let (_, state) = self.colliders.get(entity).ok()?;
        self.surfaces.uv(entity, state, triangle, barycentrics)
    }

    pub(super) fn joint(&self, entity: Entity, triangle: u32, barycentrics: Vec3) -> Option<Entity> {
        let (_, state) = self.colliders.get(entity).ok()?;
        self.surfaces.joint(entity, state, triangle, barycentrics)
    }
}

/// A collider's mesh as it stands.
pub(super) fn body(state: &mut ColliderState) -> Option<Body<'_>> {
    let ColliderState { pose, placed, .. } = state;
    let (pose, placed): (&mut Pose, _) = (pose.as_mut()?, placed.as_ref()?);
    let world_from_model: &WorldFromModel = match &placed.form {
        Form::Mesh(world_from_model) => world_from_model,
        Form::Shape(_) => return None,
    };
    Some(Body::new(pose, world_from_model))
}
