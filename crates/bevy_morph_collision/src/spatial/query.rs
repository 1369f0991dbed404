use bevy::camera::primitives::Frustum;
use bevy::ecs::system::SystemParam;
use bevy::math::DVec3;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use morph_collision::{
    Aabb, Ball, Body, ClosestPoint, ContactQuery, ConvexRegion, DistanceQuery, HalfSpace, InputError, OverlapQuery,
    PointQuery, Pose, Ray, RayHit, RayQuery, WorldFromModel,
};

use super::{MorphClosestPoints, MorphContacts, MorphProjection, MorphQueryFilter, MorphRayHit};
use crate::collider::{ColliderState, Form};
use crate::import::triangle_corners;
use crate::narrow_phase::world_triangle;

/// Asks about the meshes of [`MorphCollider`](crate::MorphCollider)s as they are posed: rays, overlaps, closest points, contacts.
///
/// Everything is in world space and `f32`; the work behind it is exact, as [`morph_collision`] describes it. Colliders are as the
/// plugin's last run left them: weights and places that change later in a frame count from the next run on. What a
/// query looks at is refitted for it, and stays so for whatever comes after. Colliders that are
/// [disabled](crate::MorphColliderDisabled), or whose mesh is not loaded yet, are not there. Primitive shapes are not
/// looked at.
///
/// A number that is not finite is an [`InputError`].
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
    colliders: Query<'w, 's, (Entity, &'static mut ColliderState, Option<&'static Mesh3d>)>,
    meshes: Option<Res<'w, Assets<Mesh>>>,
    queries: Local<'s, Queries>,
}

/// What queries reuse.
#[derive(Default)]
struct Queries {
    ray: RayQuery,
    overlap: OverlapQuery,
    point: PointQuery,
    distance: DistanceQuery,
    contact: ContactQuery,
    hits: Vec<RayHit>,
    /// Colliders that a query may be about, each with a lower bound of what it wants to know.
    near: Vec<(f32, Entity)>,
}

impl std::fmt::Debug for MorphSpatialQuery<'_, '_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MorphSpatialQuery").finish_non_exhaustive()
    }
}

impl MorphSpatialQuery<'_, '_> {
    /// The first hit of a ray, at most `max_distance` away, which may be infinite.
    ///
    /// # Errors
    /// Numbers that are not finite; a negative distance.
    pub fn cast_ray(
        &mut self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
    ) -> Result<Option<MorphRayHit>, InputError> {
        self.cast_ray_where(origin, direction, max_distance, filter, |_| true)
    }

    /// The first hit of a ray on a collider that a predicate accepts.
    ///
    /// # Errors
    /// As [`MorphSpatialQuery::cast_ray`].
    pub fn cast_ray_where(
        &mut self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Result<Option<MorphRayHit>, InputError> {
        let ray = world_ray(origin, direction, max_distance)?;
        let near = self.near(filter, |bounds| enters(bounds, origin, *direction, max_distance));
        let mut best: Option<(Entity, RayHit)> = None;
        for &(entry, entity) in &near {
            if best.is_some_and(|(_, hit)| f64::from(entry) > hit.distance) {
                break;
            }
            if !predicate(entity) {
                continue;
            }
            let Ok((_, mut state, _)) = self.colliders.get_mut(entity) else {
                continue;
            };
            let Some(body) = body(&mut state) else { continue };
            let hit = self.queries.ray.closest(body, &ray).0;
            if let Some(hit) = hit.filter(|hit| best.is_none_or(|(_, before)| hit.distance < before.distance)) {
                best = Some((entity, hit));
            }
        }
        self.queries.near = near;
        Ok(best.map(|(entity, hit)| self.ray_hit(entity, &hit)))
    }

    /// Every triangle that a ray hits, nearest first; among equals by entity and triangle.
    ///
    /// # Errors
    /// As [`MorphSpatialQuery::cast_ray`].
    pub fn ray_hits(
        &mut self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
    ) -> Result<Vec<MorphRayHit>, InputError> {
        let ray = world_ray(origin, direction, max_distance)?;
        let near = self.near(filter, |bounds| enters(bounds, origin, *direction, max_distance));
        let mut all = Vec::new();
        for &(_, entity) in &near {
            let mut hits = std::mem::take(&mut self.queries.hits);
            hits.clear();
            if let Ok((_, mut state, _)) = self.colliders.get_mut(entity)
                && let Some(body) = body(&mut state)
            {
                self.queries.ray.all(body, &ray, &mut hits);
            }
            all.extend(hits.iter().map(|hit| self.ray_hit(entity, hit)));
            self.queries.hits = hits;
        }
        self.queries.near = near;
        all.sort_by(|x: &MorphRayHit, y| {
            let place = x.distance.total_cmp(&y.distance);
            place.then(x.entity.cmp(&y.entity)).then(x.triangle.cmp(&y.triangle))
        });
        Ok(all)
    }

    /// The colliders whose surface meets a solid ball, ascending.
    ///
    /// # Errors
    /// Numbers that are not finite; a negative radius.
    pub fn overlap_ball(
        &mut self,
        center: Vec3,
        radius: f32,
        filter: &MorphQueryFilter,
    ) -> Result<Vec<Entity>, InputError> {
        let ball = Ball::new(center.as_dvec3(), f64::from(radius))?;
        let near = self.near(filter, |bounds| (away(bounds, center) <= radius).then_some(0.0));
        Ok(self.meeting(near, |queries, body| queries.overlap.meets_ball(body, &ball).0))
    }

    /// The colliders whose surface meets a solid box along the axes, ascending.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn overlap_box(&mut self, min: Vec3, max: Vec3, filter: &MorphQueryFilter) -> Result<Vec<Entity>, InputError> {
        let wanted = Aabb { min, max };
        let region = ConvexRegion::from_box(&wanted)?;
        let near = self.near(filter, |bounds| wanted.overlaps(bounds).then_some(0.0));
        Ok(self.meeting(near, |queries, body| queries.overlap.meets_region(body, &region).0))
    }

    /// The colliders whose surface is inside a frustum or meets it, ascending: what a camera with this frustum could see.
    ///
    /// Sides that are not finite, as that of an infinite far plane, are left out.
    pub fn overlap_frustum(&mut self, frustum: &Frustum, filter: &MorphQueryFilter) -> Vec<Entity> {
        let side = |side: &bevy::shape::HalfSpace| HalfSpace::new(side.normal().as_dvec3(), f64::from(side.d())).ok();
        let half_spaces: Vec<_> = frustum.half_spaces.iter().filter_map(side).collect();
        let region = ConvexRegion::from_half_spaces(&half_spaces);
        let near = self.near(filter, |_| Some(0.0));
        self.meeting(near, |queries, body| queries.overlap.meets_region(body, &region).0)
    }

    /// The point closest to some point on the surface of any collider, at most `max_distance` away, which may be infinite.
    ///
    /// # Errors
    /// Numbers that are not finite; a negative distance.
    pub fn project_point(
        &mut self,
        point: Vec3,
        max_distance: f32,
        filter: &MorphQueryFilter,
    ) -> Result<Option<MorphProjection>, InputError> {
        let mut ball = if max_distance == f32::INFINITY {
            Ball::unbounded(point.as_dvec3())?
        } else {
            Ball::new(point.as_dvec3(), f64::from(max_distance))?
        };
        let near = self.near(filter, |bounds| {
            Some(away(bounds, point)).filter(|&away| away <= max_distance)
        });
        let mut best: Option<(Entity, ClosestPoint)> = None;
        for &(at_least, entity) in &near {
            if best.is_some_and(|(_, closest)| f64::from(at_least) > closest.distance) {
                break;
            }
            let Ok((_, mut state, _)) = self.colliders.get_mut(entity) else {
                continue;
            };
            let Some(body) = body(&mut state) else { continue };
            let closest = self.queries.point.closest(body, &ball).0;
            if let Some(closest) = closest.filter(|new| best.is_none_or(|(_, old)| new.distance < old.distance)) {
                ball = Ball::new(point.as_dvec3(), closest.distance)?;
                best = Some((entity, closest));
            }
        }
        self.queries.near = near;
        Ok(best.map(|(entity, closest)| {
            let barycentrics = DVec3::from_array(closest.barycentrics).as_vec3();
            MorphProjection {
                entity,
                distance: closest.distance as f32,
                point: closest.point.as_vec3(),
                normal: self.normal(entity, closest.triangle),
                triangle: closest.triangle,
                barycentrics,
                uv: self.uv(entity, closest.triangle, barycentrics),
            }
        }))
    }

    /// The closest points of two colliders, if they are at most `max_distance` apart; `None` also where one of them is not
    /// there.
    pub fn closest_points(&mut self, a: Entity, b: Entity, max_distance: f32) -> Option<MorphClosestPoints> {
        let Self { colliders, queries, .. } = self;
        let [mut a, mut b] = colliders.get_many_mut([a, b]).ok()?;
        let (closest, _) = queries
            .distance
            .closest(body(&mut a.1)?, body(&mut b.1)?, f64::from(max_distance));
        closest.map(|closest| MorphClosestPoints {
            point1: closest.point_a.as_vec3(),
            point2: closest.point_b.as_vec3(),
            distance: closest.distance as f32,
            triangles: morph_collision::TrianglePair {
                triangle_a: closest.triangle_a,
                triangle_b: closest.triangle_b,
            },
        })
    }

    /// Where two colliders meet; `None` where they do not, or one of them is not there.
    pub fn contacts(&mut self, a: Entity, b: Entity) -> Option<MorphContacts> {
        let Self { colliders, queries, .. } = self;
        let [mut a, mut b] = colliders.get_many_mut([a, b]).ok()?;
        let (manifold, _) = queries.contact.manifold(body(&mut a.1)?, body(&mut b.1)?);
        manifold.as_ref().map(MorphContacts::from)
    }

    /// A box in world space around a collider as it is posed: conservative, from its tree's root alone.
    #[must_use]
    pub fn bounds(&self, collider: Entity) -> Option<Aabb> {
        let (_, state, _) = self.colliders.get(collider).ok()?;
        Some(state.placed?.bounds)
    }

    /// A vertex of a collider's mesh as it is posed, in world space.
    #[must_use]
    pub fn posed_vertex(&mut self, collider: Entity, vertex: usize) -> Option<Vec3> {
        let (_, mut state, _) = self.colliders.get_mut(collider).ok()?;
        let Body { pose, world_from_model } = body(&mut state)?;
        Some(world_from_model.transform_point(pose.source_vertex(vertex)?).as_vec3())
    }

    /// All vertices of a collider's mesh as they are posed, in world space, in the mesh's order. Blends the whole mesh.
    #[must_use]
    pub fn posed_vertices(&mut self, collider: Entity) -> Option<Vec<Vec3>> {
        let (_, mut state, _) = self.colliders.get_mut(collider).ok()?;
        let Body { pose, world_from_model } = body(&mut state)?;
        let posed = (0..).map_while(|vertex| pose.source_vertex(vertex));
        Some(posed.map(|p| world_from_model.transform_point(p).as_vec3()).collect())
    }

    /// The corners of a triangle of a collider's mesh as it is posed, in world space.
    #[must_use]
    pub fn posed_triangle(&mut self, collider: Entity, triangle: u32) -> Option<[Vec3; 3]> {
        let (_, mut state, _) = self.colliders.get_mut(collider).ok()?;
        Some(world_triangle(&mut body(&mut state)?, triangle)?.map(DVec3::as_vec3))
    }

    /// The colliders that pass a filter and for whose bounds something can be said, lowest first.
    fn near(&mut self, filter: &MorphQueryFilter, mut bound: impl FnMut(&Aabb) -> Option<f32>) -> Vec<(f32, Entity)> {
        let mut near = std::mem::take(&mut self.queries.near);
        near.clear();
        for (entity, state, _) in &self.colliders {
            let Some(placed) = &state.placed else { continue };
            if state.pose.is_some() && filter.takes(entity, placed.body, placed.layers) {
                near.extend(bound(&placed.bounds).map(|bound| (bound, entity)));
            }
        }
        near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        near
    }

    fn meeting(
        &mut self,
        near: Vec<(f32, Entity)>,
        mut meets: impl FnMut(&mut Queries, Body<'_>) -> bool,
    ) -> Vec<Entity> {
        let mut met = Vec::new();
        for &(_, entity) in &near {
            let Ok((_, mut state, _)) = self.colliders.get_mut(entity) else {
                continue;
            };
            if body(&mut state).is_some_and(|body| meets(&mut self.queries, body)) {
                met.push(entity);
            }
        }
        self.queries.near = near;
        met
    }

    fn ray_hit(&self, entity: Entity, hit: &RayHit) -> MorphRayHit {
        let barycentrics = DVec3::from_array(hit.barycentrics).as_vec3();
        MorphRayHit {
            entity,
            distance: hit.distance as f32,
            point: hit.point.as_vec3(),
            normal: hit.normal.as_vec3(),
            facing: hit.facing,
            triangle: hit.triangle,
            barycentrics,
            uv: self.uv(entity, hit.triangle, barycentrics),
        }
    }

    fn normal(&mut self, entity: Entity, triangle: u32) -> Vec3 {
        let corners = self.colliders.get_mut(entity).ok().and_then(|(_, mut state, _)| {
            let mut body = body(&mut state)?;
            world_triangle(&mut body, triangle)
        });
        let normal = corners.map(|[a, b, c]| (b - a).cross(c - a).normalize_or_zero());
        normal.unwrap_or_default().as_vec3()
    }

    fn uv(&self, entity: Entity, triangle: u32, barycentrics: Vec3) -> Option<Vec2> {
        let (_, _, mesh) = self.colliders.get(entity).ok()?;
        let mesh = self.meshes.as_ref()?.get(mesh?)?;
        let corners = triangle_corners(mesh, triangle)?;
        let VertexAttributeValues::Float32x2(uvs) = mesh.try_attribute(Mesh::ATTRIBUTE_UV_0.id).ok()? else {
            return None;
        };
        let mut uv = Vec2::ZERO;
        for (corner, weight) in corners.into_iter().zip(barycentrics.to_array()) {
            uv += Vec2::from_array(*uvs.get(corner as usize)?) * weight;
        }
        Some(uv)
    }
}

/// A collider's mesh as it stands.
fn body(state: &mut ColliderState) -> Option<Body<'_>> {
    let ColliderState { pose, placed, .. } = state;
    let (pose, placed): (&mut Pose, _) = (pose.as_mut()?, placed.as_ref()?);
    let world_from_model: &WorldFromModel = match &placed.form {
        Form::Mesh(world_from_model) => world_from_model,
        Form::Shape(_) => return None,
    };
    Some(Body::new(pose, world_from_model))
}

fn world_ray(origin: Vec3, direction: Dir3, max_distance: f32) -> Result<Ray, InputError> {
    Ray::new(origin.as_dvec3(), direction.as_dvec3(), f64::from(max_distance))
}

/// A lower bound of the distance at which a ray enters a box; `None` if it certainly misses it.
fn enters(bounds: &Aabb, origin: Vec3, direction: Vec3, max_distance: f32) -> Option<f32> {
    let (mut first, mut last) = (0.0_f64, f64::from(max_distance));
    let size = (bounds.min.abs().max(bounds.max.abs()) + origin.abs()).max_element();
    let slack = f64::from(size) * 1e-6;
    for i in 0..3 {
        let (origin, direction) = (f64::from(origin[i]), f64::from(direction[i]));
        let (low, high) = (
            f64::from(bounds.min[i]) - slack - origin,
            f64::from(bounds.max[i]) + slack - origin,
        );
        if direction == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (near, far) = (low / direction, high / direction);
        first = first.max(near.min(far));
        last = last.min(near.max(far));
    }
    // Below what is rounded.
    (first <= last + slack).then_some(((first - slack) * (1.0 - 1e-6)) as f32)
}

/// A lower bound of the distance of a point from a box.
fn away(bounds: &Aabb, point: Vec3) -> f32 {
    let outside = (bounds.min - point).max(point - bounds.max).max(Vec3::ZERO);
    outside.length() * (1.0 - 1e-6)
}
