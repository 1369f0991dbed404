use std::cell::Cell;
use std::ops::ControlFlow;

use glam::DVec3;

use super::bound::NodeBound;
use super::placed::PlacedShape;
use crate::exact::Triangle;
use crate::query::capped::Capped;
use crate::query::one::OneBody;
use crate::query::{Body, QueryStats};

/// The closest or deepest contact of a triangle with a shape, in world space and `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeContact {
    /// The triangle, by its number in the body's mesh.
    pub triangle: u32,
    /// The triangle's smallest signed distance from the shape: negative is a depth, and at most 0 exactly where they intersect.
    pub distance: f64,
    /// The point of the triangle that has it.
    pub point_on_triangle: DVec3,
    /// The nearest point of the shape's surface: `point_on_triangle - distance * normal`.
    pub point_on_shape: DVec3,
    /// The unit vector out of the shape towards the body: the direction in which the distance grows.
    ///
    /// Where there is no single one, because the triangle meets a ball's centre, a capsule's axis or a segment, it is the
    /// triangle's normal, to the side that less of the segment is on; zero if the triangle has none.
    pub normal: DVec3,
}

/// Asks which triangles of a body a primitive shape intersects, and where; holds the memory that queries reuse.
///
/// Shapes are solid: a triangle wholly inside intersects. What is exact is told at [`PlacedShape::intersects`]; no answer
/// depends on the tree. Distances are `f64`, off by a few roundings of the largest coordinate that takes part.
///
/// ```
/// use std::sync::Arc;
/// use glam::{Quat, Vec3};
/// use morph_collision::{
///     Body, BuildOptions, MorphBvh, MorphModel, PlacedShape, Pose, Shape, ShapeQuery, WorldFromModel, WorldFromShape,
/// };
///
/// let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// let above = WorldFromShape::new(Quat::IDENTITY, Vec3::new(0.25, 0.25, 2.0))?;
/// let ball = PlacedShape::new(Shape::Ball { radius: 1.5 }, &above)?;
///
/// let mut query = ShapeQuery::new();
/// let place = WorldFromModel::IDENTITY;
/// let (contact, _) = query.closest(Body::new(&mut pose, &place), &ball, 10.0);
/// assert_eq!(contact.map(|c| c.distance), Some(0.5));
/// pose.set_weights(&[1.0])?; // lifts the triangle into the ball
/// assert!(query.any(Body::new(&mut pose, &place), &ball).0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct ShapeQuery {
    one: OneBody,
}

impl ShapeQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether any triangle intersects the shape.
    pub fn any(&mut self, body: Body<'_>, shape: &PlacedShape) -> (bool, QueryStats) {
        let mut any = false;
        let stats = self.visit(body, shape, |_| {
            any = true;
            ControlFlow::Break(())
        });
        (any, stats)
    }

    /// Appends every triangle that intersects the shape, best first.
    pub fn all(&mut self, body: Body<'_>, shape: &PlacedShape, triangles: &mut Vec<u32>) -> QueryStats {
        self.visit(body, shape, |triangle| {
            triangles.push(triangle);
            ControlFlow::Continue(())
        })
    }

    /// Appends at most `limit` triangles that intersect the shape, the first ones of [`ShapeQuery::all`]; says whether there are
    /// more.
    pub fn up_to(
        &mut self,
        limit: usize,
        body: Body<'_>,
        shape: &PlacedShape,
        triangles: &mut Vec<u32>,
    ) -> (bool, QueryStats) {
        let mut listed = Capped::new(triangles, limit);
        let stats = self.visit(body, shape, |triangle| listed.push(triangle));
        (listed.is_truncated, stats)
    }

    /// Calls `visitor` for every triangle that intersects the shape, best first, until it breaks.
    pub fn visit(
        &mut self,
        body: Body<'_>,
        shape: &PlacedShape,
        mut visitor: impl FnMut(u32) -> ControlFlow<()>,
    ) -> QueryStats {
        self.walk(body, shape, &Cell::new(0.0), &mut |triangle, corners| {
            if shape.intersects(corners) {
                visitor(triangle)?;
            }
            ControlFlow::Continue(())
        })
    }

    /// Appends the contact of every triangle whose signed distance is at most `within`, best first.
    ///
    /// With 0 these are the intersecting triangles; with a negative number those that are deeper.
    pub fn contacts(
        &mut self,
        body: Body<'_>,
        shape: &PlacedShape,
        within: f64,
        contacts: &mut Vec<ShapeContact>,
    ) -> QueryStats {
        self.contacts_up_to(usize::MAX, body, shape, within, contacts).1
    }

    /// Appends at most `limit` contacts, the first ones of [`ShapeQuery::contacts`]; says whether there are more.
    pub fn contacts_up_to(
        &mut self,
        limit: usize,
        body: Body<'_>,
        shape: &PlacedShape,
        within: f64,
        contacts: &mut Vec<ShapeContact>,
    ) -> (bool, QueryStats) {
        let mut listed = Capped::new(contacts, limit);
        let stats = self.walk(body, shape, &Cell::new(within), &mut |triangle, corners| {
            let contact = contact(shape, triangle, corners);
            if contact.distance <= within {
                listed.push(contact)?;
            }
            ControlFlow::Continue(())
        });
        (listed.is_truncated, stats)
    }

    /// The body's contact: that of the triangle with the smallest signed distance, so the closest, or the deepest where they
    /// intersect. `None` if that is above `within`.
    ///
    /// Of triangles with the same distance it is the first by number.
    pub fn closest(&mut self, body: Body<'_>, shape: &PlacedShape, within: f64) -> (Option<ShapeContact>, QueryStats) {
        let limit = Cell::new(within);
        let mut best: Option<ShapeContact> = None;
        let stats = self.walk(body, shape, &limit, &mut |triangle, corners| {
            let contact = contact(shape, triangle, corners);
            let better = match &best {
                Some(best) => {
                    contact.distance < best.distance || contact.distance == best.distance && triangle < best.triangle
                }
                None => contact.distance <= within,
            };
            if better {
                limit.set(contact.distance);
                best = Some(contact);
            }
            ControlFlow::Continue(())
        });
        (best, stats)
    }

    fn walk(
        &mut self,
        body: Body<'_>,
        shape: &PlacedShape,
        limit: &Cell<f64>,
        at_triangle: &mut dyn FnMut(u32, &Triangle) -> ControlFlow<()>,
    ) -> QueryStats {
        let world_from_model = body.world_from_model;
        let mut posed = body.pose.posed();
        let bound = NodeBound::new(shape, world_from_model, &posed.bounds());
        self.one.walk(
            &mut posed,
            world_from_model,
            limit.get(),
            |node| Some(bound.lower_bound(node)),
            |triangle, corners| {
                at_triangle(triangle, corners)?;
                ControlFlow::Continue(limit.get())
            },
        )
    }
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
