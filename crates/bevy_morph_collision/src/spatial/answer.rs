use bevy::prelude::*;
use morph_collision::{Facing, Manifold, TrianglePair};

use crate::contacts::{MorphContactPoint, no_triangles};

/// Where a ray meets a collider.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphRayHit {
    /// The collider.
    pub entity: Entity,
    /// The distance from the ray's origin, in world units.
    pub distance: f32,
    /// The point on the surface, in world space.
    pub point: Vec3,
    /// The triangle's unit normal by its winding in world space; zero where it has no area. On a [`MorphShape`](crate::MorphShape) the
    /// direction out of it; zero if the ray starts inside.
    pub normal: Vec3,
    /// Which side of the triangle the ray sees; [`Facing::Front`] on a shape. Not reflected: it is [`Facing::EdgeOn`] in a value made by reflection.
    #[reflect(ignore, default = "edge_on")]
    pub facing: Facing,
    /// The triangle's number in its mesh; see [`MorphContact::triangles`](crate::MorphContact::triangles). On a shape
    /// [`MorphContact::NO_TRIANGLE`](crate::MorphContact::NO_TRIANGLE).
    pub triangle: u32,
    /// The weights of the triangle's corners at the point; zero on a shape.
    pub barycentrics: Vec3,
    /// The texture coordinates there, if the mesh has `Mesh::ATTRIBUTE_UV_0`.
    pub uv: Option<Vec2>,
    /// On a skinned mesh the joint that moves this point most: one of the entities in
    /// [`SkinnedMesh::joints`](bevy::mesh::skinning::SkinnedMesh), the first of several with the same weight. For headshots. `None` on
    /// other meshes, and where no joint moves the surface.
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
    /// Where they touch, on the collider, in world space. If they touch at the start: a point of the collider that is in the shape.
    pub point: Vec3,
    /// The unit vector from the collider towards the shape. It may be zero if they touch at the start.
    pub normal: Vec3,
    /// The triangle's number in its mesh; [`MorphContact::NO_TRIANGLE`](crate::MorphContact::NO_TRIANGLE) for a collider that is a
    /// [`MorphShape`](crate::MorphShape).
    pub triangle: u32,
}

/// The point of a collider's surface, or of a solid [`MorphShape`](crate::MorphShape), that is closest to some point.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphProjection {
    /// The collider.
    pub entity: Entity,
    /// The distance, in world units.
    pub distance: f32,
    /// The point on the surface, or in the shape, in world space.
    pub point: Vec3,
    /// The triangle's unit normal by its winding in world space; zero where it has no area. Of a shape the direction towards the point that was
    /// asked about; zero if that is inside.
    pub normal: Vec3,
    /// The triangle's number in its mesh; of a shape [`MorphContact::NO_TRIANGLE`](crate::MorphContact::NO_TRIANGLE).
    pub triangle: u32,
    /// The weights of the triangle's corners at the point; zero in a shape.
    pub barycentrics: Vec3,
    /// The texture coordinates there, if the mesh has `Mesh::ATTRIBUTE_UV_0`.
    pub uv: Option<Vec2>,
    /// On a skinned mesh the joint that moves this point most: one of the entities in
    /// [`SkinnedMesh::joints`](bevy::mesh::skinning::SkinnedMesh), the first of several with the same weight. For headshots. `None` on
    /// other meshes, and where no joint moves the surface.
    pub joint: Option<Entity>,
}

/// Closest points of two colliders' surfaces.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphClosestPoints {
    /// On the first collider, in world space.
    pub point1: Vec3,
    /// On the second one.
    pub point2: Vec3,
    /// The distance, in world units: 0 if and only if they touch.
    pub distance: f32,
    /// The triangles that the points are on, [`MorphContact::NO_TRIANGLE`](crate::MorphContact::NO_TRIANGLE) for a shape. Not reflected: both are
    /// [`MorphContact::NO_TRIANGLE`](crate::MorphContact::NO_TRIANGLE) in a value made by reflection.
    #[reflect(ignore, default = "no_triangles")]
    pub triangles: TrianglePair,
}

/// Where two colliders meet.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphManifold {
    /// The direction in which the first collider leaves the second; see [`Manifold::normal`].
    pub normal: Vec3,
    /// A lower bound of the way that parts them; see [`Manifold::depth`].
    pub depth: f32,
    /// How many pairs of triangles, or triangles and a shape, intersect, or how many of them were looked at.
    pub pair_count: usize,
    /// Whether more pairs intersect than were looked at; see
    /// [`MorphCollisionSettings::max_triangle_pairs`](crate::MorphCollisionSettings).
    pub is_truncated: bool,
    /// At most four, the deepest first.
    pub points: Vec<MorphContactPoint>,
}

/// The side of a hit made by reflection.
fn edge_on() -> Facing {
    Facing::EdgeOn
}

impl From<&Manifold> for MorphManifold {
    fn from(manifold: &Manifold) -> Self {
        let points = manifold.points().iter().map(|point| MorphContactPoint {
            point: point.point.as_vec3(),
            depth: point.depth as f32,
            triangles: point.pair,
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
