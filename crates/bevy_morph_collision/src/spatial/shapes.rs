//! Queries with solid shapes: intersections and casts.

use bevy::prelude::*;
use morph_collision::{Aabb, InputError, PlacedShape, Rank, ShapeImpact};

use super::rays::{BoxEntry, HitRank, RayCast};
use super::target::Target;
use super::walker::Walker;
use super::{MorphQueryFilter, MorphShapeHit, MorphSpatialQuery};
use crate::components::MorphShape;
use crate::contacts::MorphContact;

impl MorphSpatialQuery<'_, '_> {
    /// The colliders that a solid shape intersects, ascending.
    ///
    /// A mesh entirely inside the shape intersects it. A mesh that encloses the shape without touching it does not.
    #[must_use]
    pub fn shape_intersections(
        &self,
        shape: &MorphShape,
        origin: Vec3,
        rotation: Quat,
        filter: &MorphQueryFilter,
    ) -> Vec<Entity> {
        self.shape_intersections_predicate(shape, origin, rotation, filter, |_| true)
    }

    /// [`MorphSpatialQuery::shape_intersections`] for colliders that a predicate accepts.
    #[must_use]
    pub fn shape_intersections_predicate(
        &self,
        shape: &MorphShape,
        origin: Vec3,
        rotation: Quat,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Vec<Entity> {
        let Some(placed) = self.valid("shape_intersections", place(shape, origin, rotation)) else {
            return Vec::new();
        };
        let walker = self.walker();
        walker.map_or_else(Vec::new, |mut walker| {
            walker.intersections_with(&placed, filter, &mut predicate)
        })
    }

    /// The first collider that a solid shape touches while it moves without rotating, at most by `max_distance`, which may be
    /// infinite.
    ///
    /// Colliders that the shape touches at the start are at distance 0. Among equal distances (before they are rounded to `f32`), the
    /// lowest entity wins, and then the lowest triangle.
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::prelude::*;
    /// fn how_far_may_it_fall(spatial: MorphSpatialQuery) {
    ///     let capsule = MorphShape::Capsule { half_length: 0.5, radius: 0.4 };
    ///     let from = Vec3::new(0.0, 10.0, 0.0);
    ///     let hit = spatial.cast_shape(&capsule, from, Quat::IDENTITY, Dir3::NEG_Y, 100.0, &MorphQueryFilter::default());
    ///     if let Some(hit) = hit {
    ///         println!("{} until it touches {}", hit.distance, hit.entity);
    ///     }
    /// }
    /// # App::new().add_systems(Update, how_far_may_it_fall);
    /// ```
    #[must_use]
    pub fn cast_shape(
        &self,
        shape: &MorphShape,
        origin: Vec3,
        rotation: Quat,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
    ) -> Option<MorphShapeHit> {
        self.cast_shape_predicate(shape, origin, rotation, direction, max_distance, filter, |_| true)
    }

    /// [`MorphSpatialQuery::cast_shape`] for colliders that a predicate accepts.
    #[must_use]
    pub fn cast_shape_predicate(
        &self,
        shape: &MorphShape,
        origin: Vec3,
        rotation: Quat,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Option<MorphShapeHit> {
        let cast = self.valid(
            "cast_shape",
            ShapeCast::new(shape, origin, rotation, direction, max_distance),
        )?;
        let found = self.walker()?.first_impacts(&cast, 1, filter, &mut predicate);
        found.first().map(MorphShapeHit::new)
    }
}

/// A shape that moves.
pub(super) struct ShapeCast {
    pub(super) origin: Vec3,
    direction: Dir3,
    max_distance: f32,
    shape: PlacedShape,
    /// A box around the shape at the start.
    around: Aabb,
}

impl ShapeCast {
    pub(super) fn new(
        shape: &MorphShape,
        origin: Vec3,
        rotation: Quat,
        direction: Dir3,
        max_distance: f32,
    ) -> Result<Self, InputError> {
        let (shape, around) = place(shape, origin, rotation)?;
        RayCast::new(origin, direction, max_distance)?;
        Ok(Self {
            origin,
            direction,
            max_distance,
            shape,
            around,
        })
    }
}

/// Where a moving shape first touches a collider.
pub(super) type FirstTouch = (HitRank, ShapeImpact);

impl Walker<'_, '_, '_> {
    /// The first `count` colliders that a moving shape touches, sorted, each where it first does.
    pub(super) fn first_impacts(
        &mut self,
        cast: &ShapeCast,
        count: usize,
        filter: &MorphQueryFilter,
        predicate: &mut dyn FnMut(Entity) -> bool,
    ) -> Vec<FirstTouch> {
        let mut first: Vec<FirstTouch> = Vec::new();
        if count == 0 {
            return first;
        }
        let ShapeCast {
            origin,
            direction,
            max_distance,
            ref shape,
            around,
        } = *cast;
        let way = direction.as_dvec3();
        let entry = BoxEntry::new(origin, direction, max_distance);
        let reaches = |bounds: &Aabb| {
            let grown = Aabb {
                min: bounds.min - (around.max - origin),
                max: bounds.max - (around.min - origin),
            };
            entry.distance(&grown)
        };
        self.walk(filter, predicate, max_distance, reaches, |queries, entity, target| {
            let last = first.get(count - 1).map(|(_, impact)| impact.distance);
            let within = last.unwrap_or(f64::from(max_distance));
            let hit = match target {
                Target::Mesh(body) => match queries.shape.cast(body, shape, way, within) {
                    Ok(Some(hit)) => Some((hit.triangle, hit.impact)),
                    _ => None,
                },
                Target::Shape(other) => match shape.cast(way, within, other) {
                    Ok(Some(impact)) => Some((MorphContact::NO_TRIANGLE, impact)),
                    _ => None,
                },
            };
            if let Some((triangle, impact)) = hit {
                let rank = Rank::new(impact.distance, (entity, triangle));
                let place = first.partition_point(|(other, _)| *other < rank);
                first.insert(place, (rank, impact));
                first.truncate(count);
            }
            first.get(count - 1).map_or(max_distance, |(_, impact)| {
                (impact.distance as f32).next_up().min(max_distance)
            })
        });
        first
    }

    /// The colliders that a shape intersects, ascending. The shape comes with a box around it.
    pub(super) fn intersections_with(
        &mut self,
        (shape, around): &(PlacedShape, Aabb),
        filter: &MorphQueryFilter,
        predicate: &mut dyn FnMut(Entity) -> bool,
    ) -> Vec<Entity> {
        let mut met = Vec::new();
        let overlaps = |bounds: &Aabb| around.overlaps(bounds).then_some(0.0);
        self.walk(filter, predicate, 0.0, overlaps, |queries, entity, target| {
            let meets = match target {
                Target::Mesh(body) => queries.shape.any(body, shape),
                Target::Shape(other) => shape.meets(other),
            };
            met.extend(meets.then_some(entity));
            0.0
        });
        met.sort_unstable();
        met
    }
}

impl MorphShapeHit {
    pub(super) fn new((rank, impact): &FirstTouch) -> Self {
        let (entity, triangle) = rank.id;
        Self {
            entity,
            distance: impact.distance as f32,
            point: impact.point.as_vec3(),
            normal: impact.normal.as_vec3(),
            triangle,
        }
    }
}

/// A shape in world space, and a box around it.
pub(super) fn place(shape: &MorphShape, origin: Vec3, rotation: Quat) -> Result<(PlacedShape, Aabb), InputError> {
    // Reports which number is invalid before using any.
    PlacedShape::ball(origin.as_dvec3(), 0.0)?;
    PlacedShape::new(morph_collision::Shape::Ball { radius: 0.0 }, rotation, Vec3::ZERO)?;
    shape.place(
        &Transform::from_translation(origin)
            .with_rotation(rotation.normalize())
            .into(),
    )
}
