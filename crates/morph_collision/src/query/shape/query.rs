//! The query for what touches a shape.

use std::ops::ControlFlow;

use glam::DVec3;

use super::bound::{NodeBound, distance_cull};
use super::core::Core;
use super::placed::PlacedShape;
use super::solid::Solid;
use crate::bounds::{Box64, ByBox};
use crate::exact::Triangle;
use crate::input_error::{InputError, check_number};
use crate::query::Body;
use crate::query::batch::{Latest, OneBodyBatch};
use crate::query::capped::Capped;
use crate::query::one_body::OneBody;
use crate::query::rank::Rank;

/// The contact of a triangle with a shape: the closest points if they are apart, or the deepest points if they intersect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeContact {
    /// The triangle's index in the body's mesh.
    pub triangle: u32,
    /// The triangle's smallest signed distance from the shape, in world units. It is at most 0 if and only if they intersect; its
    /// absolute value is then the depth.
    pub distance: f64,
    /// The point of the triangle with that distance, in world space.
    pub point_on_triangle: DVec3,
    /// The nearest point of the shape's surface: `point_on_triangle - distance * normal`.
    pub point_on_shape: DVec3,
    /// The unit vector out of the shape towards the body: the gradient of the distance.
    ///
    /// If the triangle meets a ball's centre or a capsule's axis, there is no gradient. The normal is then the triangle's, pointing to
    /// the side with less of the axis; zero if the triangle has no normal.
    pub normal: DVec3,
}

/// Tests a body against a primitive shape, a convex region or a point. Keep the query and use it again: it reuses its memory.
///
/// Shapes are solid: a triangle that is wholly inside intersects. [`PlacedShape::intersects`] says what is exact. No answer depends on
/// the tree. Distances are `f64`; [`PlacedShape`] says how accurate they are.
///
/// ```
/// use std::sync::Arc;
/// use glam::{Quat, Vec3};
/// use morph_collision::{
///     Body, BuildOptions, MorphBvh, MorphModel, PlacedShape, Pose, Shape, ShapeQuery, WorldFromModel,
/// };
///
/// let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// let ball = PlacedShape::new(Shape::Ball { radius: 1.5 }, Quat::IDENTITY, Vec3::new(0.25, 0.25, 2.0))?;
///
/// let mut query = ShapeQuery::new();
/// let world_from_model = WorldFromModel::IDENTITY;
/// let contact = query.closest(Body::new(&mut pose, &world_from_model), &ball, 10.0)?;
/// assert_eq!(contact.map(|contact| contact.distance), Some(0.5));
/// pose.set_weights(&[1.0])?; // lifts the triangle into the ball
/// assert!(query.any(Body::new(&mut pose, &world_from_model), &ball));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct ShapeQuery {
    pub(super) one: OneBody,
    pub(super) batch: OneBodyBatch<Self>,
}

query_basics!(ShapeQuery, |query| query.one.stats);

impl ShapeQuery {
    /// Returns whether any triangle intersects the shape.
    pub fn any(&mut self, body: Body<'_>, shape: &PlacedShape) -> bool {
        self.up_to(body, shape, 0, &mut Vec::new())
    }

    /// Appends every triangle that intersects the shape, in the order of [`ShapeQuery::visit`].
    pub fn all(&mut self, body: Body<'_>, shape: &PlacedShape, triangles: &mut Vec<u32>) {
        self.up_to(body, shape, usize::MAX, triangles);
    }

    /// Appends the first `limit` triangles of [`ShapeQuery::all`]; returns whether there are more.
    pub fn up_to(&mut self, body: Body<'_>, shape: &PlacedShape, limit: usize, triangles: &mut Vec<u32>) -> bool {
        let mut listed = Capped::new(triangles, limit);
        self.visit(body, shape, |triangle| listed.push(triangle));
        listed.is_truncated
    }

    /// Calls `visitor` for every triangle that intersects the shape, until it breaks. Leaves that may reach deepest into the shape come
    /// first.
    pub fn visit(&mut self, body: Body<'_>, shape: &PlacedShape, mut visitor: impl FnMut(u32) -> ControlFlow<()>) {
        self.walk(body, shape, 0.0, |triangle, corners| {
            if shape.intersects(corners) {
                visitor(triangle)?;
            }
            ControlFlow::Continue(0.0)
        });
    }

    /// Appends the contact of every triangle with a signed distance of at most `within`. Leaves with lower bounds come first.
    ///
    /// With 0 you get the intersecting triangles; with a negative number, only triangles at least that deep.
    ///
    /// # Errors
    /// [`InputError`] if `within` is NaN.
    pub fn contacts(
        &mut self,
        body: Body<'_>,
        shape: &PlacedShape,
        within: f64,
        contacts: &mut Vec<ShapeContact>,
    ) -> Result<(), InputError> {
        self.contacts_up_to(body, shape, within, usize::MAX, contacts)?;
        Ok(())
    }

    /// Appends the first `limit` contacts of [`ShapeQuery::contacts`]; returns whether there are more.
    ///
    /// # Errors
    /// [`InputError`] if `within` is NaN.
    pub fn contacts_up_to(
        &mut self,
        body: Body<'_>,
        shape: &PlacedShape,
        within: f64,
        limit: usize,
        contacts: &mut Vec<ShapeContact>,
    ) -> Result<bool, InputError> {
        check_within(within)?;
        let mut listed = Capped::new(contacts, limit);
        self.walk(body, shape, within, |triangle, corners| {
            let contact = contact(shape, triangle, corners);
            if contact.distance <= within {
                listed.push(contact)?;
            }
            ControlFlow::Continue(within)
        });
        Ok(listed.is_truncated)
    }

    /// Returns the contact of the triangle with the smallest signed distance: the closest triangle, or the deepest if any intersect.
    ///
    /// `None` if that distance is above `within`. Among equal distances, the lowest triangle index wins (see [`Rank`]).
    ///
    /// # Errors
    /// [`InputError`] if `within` is NaN.
    pub fn closest(
        &mut self,
        body: Body<'_>,
        shape: &PlacedShape,
        within: f64,
    ) -> Result<Option<ShapeContact>, InputError> {
        check_within(within)?;
        Ok(self.closest_from(body, shape, within, &mut None))
    }

    /// The closest contact, for valid input. Tests the latest triangle first, because its distance is a limit for all others.
    pub(super) fn closest_from(
        &mut self,
        mut body: Body<'_>,
        shape: &PlacedShape,
        within: f64,
        latest: &mut Latest,
    ) -> Option<ShapeContact> {
        let mut best: Option<ShapeContact> = None;
        let mut at_triangle = |triangle, corners: &Triangle| {
            let contact = contact(shape, triangle, corners);
            if contact.distance <= within && best.as_ref().is_none_or(|best| contact.rank() < best.rank()) {
                best = Some(contact);
            }
            best.as_ref().map_or(within, |best| best.distance)
        };
        let latest_triangle = latest.and_then(|number| Some((number, body.triangle(number)?)));
        let limit = latest_triangle.map_or(within, |(number, corners)| at_triangle(number, &corners));
        self.walk(body, shape, limit, |triangle, corners| {
            ControlFlow::Continue(at_triangle(triangle, corners))
        });
        *latest = best.as_ref().map_or(*latest, |best| Some(best.triangle));
        best
    }

    fn walk(
        &mut self,
        mut body: Body<'_>,
        shape: &PlacedShape,
        limit: f64,
        mut at_triangle: impl FnMut(u32, &Triangle) -> ControlFlow<(), f64>,
    ) {
        let _stopped_early = match shape.solids() {
            [
                Solid::Round {
                    core: Core::Segment(axis),
                    radius,
                },
            ] => {
                let bounds = distance_cull(&mut body, *axis, *radius);
                self.one.walk(body, limit, &bounds, &mut at_triangle)
            }
            [solid] => {
                let bound = NodeBound::new(solid, body.posed().placed_body().placed);
                let bounds = ByBox(|node: &Box64| Some(bound.lower_bound(node)));
                self.one.walk(body, limit, &bounds, &mut at_triangle)
            }
            solids => {
                let placed = body.posed().placed_body().placed;
                let each: Vec<_> = solids.iter().map(|solid| NodeBound::new(solid, placed)).collect();
                let bounds = ByBox(|node: &Box64| {
                    let lower_bounds = each.iter().map(|bound| bound.lower_bound(node));
                    Some(lower_bounds.fold(f64::INFINITY, f64::min))
                });
                self.one.walk(body, limit, &bounds, &mut at_triangle)
            }
        };
    }
}

impl ShapeContact {
    fn rank(&self) -> Rank<u32> {
        Rank::new(self.distance, self.triangle)
    }
}

pub(super) fn check_within(within: f64) -> Result<(), InputError> {
    check_number("within", within, !within.is_nan(), "a number")
}

fn contact(shape: &PlacedShape, triangle: u32, corners: &Triangle) -> ShapeContact {
    let closest = shape.closest(corners);
    ShapeContact {
        triangle,
        distance: closest.distance,
        point_on_triangle: closest.point,
        point_on_shape: closest.point - closest.normal * closest.distance,
        normal: closest.normal,
    }
}
