//! What queries return.

use bevy::prelude::*;
use morph_collision::{Facing, Manifold, TrianglePair};

use crate::contacts::{MorphContactPoint, no_triangles};

/// The point where a ray hits a collider.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphRayHit {
    /// The collider.
    pub entity: Entity,
    /// The distance from the ray's origin, in world units.
    pub distance: f32,
    /// The point on the surface, in world space.
    pub point: Vec3,
    /// The unit normal of the triangle, by its winding in world space; zero if the triangle has no area. On a
    /// [`MorphShape`](crate::components::MorphShape), it points out of the shape; zero if the ray starts inside.
    pub normal: Vec3,
    /// Which side of the triangle the ray sees; [`Facing::Front`] on a shape. Not reflected: it is [`Facing::EdgeOn`] in a value created by reflection.
    #[reflect(ignore, default = "edge_on")]
    pub facing: Facing,
    /// The triangle's number in its mesh; see [`MorphContact::triangles`](crate::contacts::MorphContact::triangles). On a shape it is
    /// [`MorphContact::NO_TRIANGLE`](crate::contacts::MorphContact::NO_TRIANGLE).
    pub triangle: u32,
    /// The barycentric coordinates of the point in the triangle; zero on a shape.
    pub barycentrics: Vec3,
    /// The texture coordinates at the point, if the mesh has `Mesh::ATTRIBUTE_UV_0`.
    pub uv: Option<Vec2>,
    /// The joint that moves the point most, on a skinned mesh. Use it for headshots. It is one of the entities in
    /// [`SkinnedMesh::joints`](bevy::mesh::skinning::SkinnedMesh): the first one if several have the same weight. `None` on other
    /// meshes, and where no joint moves the surface.
    pub joint: Option<Entity>,
}

/// Where a moving shape first touches a collider.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphShapeHit {
    /// The collider.
    pub entity: Entity,
    /// How far the shape has moved, in world units; 0 if they touch at the start.
    pub distance: f32,
    /// The point where they touch, on the collider, in world space. If they touch at the start, it is a point of the collider
    /// inside the shape.
    pub point: Vec3,
    /// The unit vector from the collider towards the shape. It may be zero if they touch at the start.
    pub normal: Vec3,
    /// The triangle's number in its mesh; [`MorphContact::NO_TRIANGLE`](crate::contacts::MorphContact::NO_TRIANGLE) for a collider that is a
    /// [`MorphShape`](crate::components::MorphShape).
    pub triangle: u32,
}

/// The first collider that a moving and turning shape touches.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphMotionHit {
    /// The collider.
    pub entity: Entity,
    /// When it is touched, as a share of the motion from 0 to 1; 0 if it is touched at the start. At most 1e-6 too late.
    pub time: f32,
    /// Where it is touched, in world space.
    pub point: Vec3,
    /// The unit vector from the collider to the shape. Zero only if they touch at the start and there is no such direction.
    pub normal: Vec3,
    /// The velocity of the shape at the point, in world units per motion.
    pub velocity: Vec3,
    /// The triangle, or [`MorphContact::NO_TRIANGLE`](crate::contacts::MorphContact::NO_TRIANGLE) for a
    /// [`MorphShape`](crate::components::MorphShape).
    pub triangle: u32,
}

/// The point of a collider that is closest to a query point. Meshes are surfaces, a [`MorphShape`](crate::components::MorphShape) is solid.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphProjection {
    /// The collider.
    pub entity: Entity,
    /// The distance, in world units.
    pub distance: f32,
    /// The point on the surface, or in the shape, in world space.
    pub point: Vec3,
    /// The unit normal of the triangle, by its winding in world space; zero if the triangle has no area. For a shape, it points
    /// towards the query point; zero if that is inside the shape.
    pub normal: Vec3,
    /// The triangle's number in its mesh. For a shape it is [`MorphContact::NO_TRIANGLE`](crate::contacts::MorphContact::NO_TRIANGLE).
    pub triangle: u32,
    /// The barycentric coordinates of the point in the triangle; zero in a shape.
    pub barycentrics: Vec3,
    /// The texture coordinates at the point, if the mesh has `Mesh::ATTRIBUTE_UV_0`.
    pub uv: Option<Vec2>,
    /// The joint that moves the point most, on a skinned mesh. Use it for headshots. It is one of the entities in
    /// [`SkinnedMesh::joints`](bevy::mesh::skinning::SkinnedMesh): the first one if several have the same weight. `None` on other
    /// meshes, and where no joint moves the surface.
    pub joint: Option<Entity>,
}

/// The closest points of two colliders.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphClosestPoints {
    /// The point on the first collider, in world space.
    pub point1: Vec3,
    /// The point on the second collider, in world space.
    pub point2: Vec3,
    /// The distance, in world units; 0 if and only if the colliders touch.
    pub distance: f32,
    /// The triangles on which the points are; [`MorphContact::NO_TRIANGLE`](crate::contacts::MorphContact::NO_TRIANGLE) for a shape. Not
    /// reflected: both are [`MorphContact::NO_TRIANGLE`](crate::contacts::MorphContact::NO_TRIANGLE) in a value created by reflection.
    #[reflect(ignore, default = "no_triangles")]
    pub triangles: TrianglePair,
}

/// Contact points, normal and depth of two colliders that touch.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphManifold {
    /// The unit vector along which the first collider moves out of the second; see [`Manifold::normal`].
    pub normal: Vec3,
    /// A lower bound of the distance that separates the colliders; see [`Manifold::depth`].
    pub depth: f32,
    /// How many pairs of triangles (or triangles and a shape) intersect, among those looked at.
    pub pair_count: usize,
    /// Whether more pairs intersect than were looked at; see
    /// [`MorphCollisionSettings::max_triangle_pairs`](crate::components::MorphCollisionSettings).
    pub is_truncated: bool,
    /// At most four contact points, deepest first.
    pub points: Vec<MorphContactPoint>,
}

/// The side of a hit created by reflection.
fn edge_on() -> Facing {
    Facing::EdgeOn
}

impl From<&Manifold> for MorphManifold {
    fn from(manifold: &Manifold) -> Self {
        let points = manifold.points().iter().map(|point| MorphContactPoint {
            point: point.point.as_vec3(),
            depth: point.depth as f32,
            triangles: point.triangles,
        });
        Self {
            normal: manifold.normal.as_vec3(),
            depth: manifold.depth as f32,
            pair_count: manifold.pair_count,
            is_truncated: manifold.is_truncated,
            points: points.collect(),
        }
    }
}
