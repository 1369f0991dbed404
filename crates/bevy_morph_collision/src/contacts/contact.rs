//! A contact of two colliders.

use super::impact::MorphImpact;
use super::no_triangles::{NO_TRIANGLE, no_triangles};
use crate::components::MorphCollisionMode;
use bevy::prelude::*;
use morph_collision::{Rank, ShapeContact, TrianglePair};

/// A contact of two colliders, with `collider1 < collider2`.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphContact {
    /// The first collider.
    pub collider1: Entity,
    /// The second collider.
    pub collider2: Entity,
    /// The body of `collider1`, named by its [`MorphColliderOf`](crate::components::MorphColliderOf), or `collider1` itself.
    pub body1: Entity,
    /// The body of `collider2`.
    pub body2: Entity,
    /// The mode that applied to this pair.
    pub mode: MorphCollisionMode,
    /// A point at which they touch, in world space. For two meshes it is the deepest point in mode
    /// [`Contacts`](MorphCollisionMode::Contacts), otherwise a point of the first pair of triangles found. For a mesh and a
    /// [`MorphShape`](crate::components::MorphShape), and if only the margins touch, it is midway between the closest (or deepest) points.
    pub point: Vec3,
    /// The unit vector along which `collider1` moves out of `collider2` at `point`; zero if there is none.
    pub normal: Vec3,
    /// 0 if the colliders touch; if only their margins do, the distance between the colliders, in world units.
    pub distance: f32,
    /// Intersecting triangles: `triangle_a` of `collider1` and `triangle_b` of `collider2`, sorted. For a
    /// [`MorphShape`](crate::components::MorphShape) the number is [`MorphContact::NO_TRIANGLE`].
    ///
    /// The [`MorphCollisionMode`] decides how many are listed. A triangle's number is its position in the mesh's index buffer
    /// divided by 3; in a triangle strip, it is its position among the triangles that have three different vertices.
    ///
    /// Not reflected: the list is empty in a value created by reflection.
    #[reflect(ignore)]
    pub triangles: Vec<TrianglePair>,
    /// Whether more triangle pairs intersect than the limit,
    /// [`MorphCollisionSettings::max_triangle_pairs`](crate::components::MorphCollisionSettings). If so, `triangles`, `points` and `normal`
    /// are based on some of the pairs; which ones depends on the tree. Always `false` in modes that report one pair.
    pub is_truncated: bool,
    /// Up to four contact points, deepest first. Only in mode [`Contacts`](MorphCollisionMode::Contacts).
    pub points: Vec<MorphContactPoint>,
    /// How the contact began, if one of the colliders is [continuous](crate::components::MorphCollider::continuous). It stays the same as long as
    /// the contact lasts. `None` if they were not compared on their way when the contact began.
    ///
    /// If the contact began and ended between two runs, `point`, `normal` and `triangles` are those of the impact.
    pub impact: Option<MorphImpact>,
}

/// A point at which two colliders touch.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphContactPoint {
    /// In world space.
    pub point: Vec3,
    /// How far the triangles at this point must move along [`MorphContact::normal`] to separate, in world units.
    pub depth: f32,
    /// The two triangles. Not reflected: both are [`MorphContact::NO_TRIANGLE`] in a value created by reflection.
    #[reflect(ignore, default = "no_triangles")]
    pub triangles: TrianglePair,
}

/// Pairs a triangle of a mesh with the shape that it intersects.
pub(crate) fn pair_with_shape(triangle: u32, shape_first: bool) -> TrianglePair {
    let mut triangles = [triangle, MorphContact::NO_TRIANGLE];
    if shape_first {
        triangles.reverse();
    }
    TrianglePair {
        triangle_a: triangles[0],
        triangle_b: triangles[1],
    }
}

impl MorphContactPoint {
    /// Keeps the four deepest triangles that intersect a shape, deepest first.
    pub(crate) fn with_shape(met: &mut [ShapeContact], shape_first: bool) -> Vec<Self> {
        met.sort_by_key(|met| Rank::new(met.distance, met.triangle));
        let point = |met: &ShapeContact| Self {
            point: met.point_on_triangle.as_vec3(),
            depth: -met.distance as f32,
            triangles: pair_with_shape(met.triangle, shape_first),
        };
        met.iter().take(4).map(point).collect()
    }
}

impl MorphContact {
    /// The triangle number used for colliders without triangles.
    pub const NO_TRIANGLE: u32 = NO_TRIANGLE;

    /// The two colliders, in ascending order.
    pub(crate) fn pair(&self) -> (Entity, Entity) {
        (self.collider1, self.collider2)
    }

    /// Where the contact began, with its normal: at the impact if there is one.
    pub(crate) fn begins_at(&self) -> (Vec3, Vec3) {
        self.impact
            .map_or((self.point, self.normal), |impact| (impact.point, impact.normal))
    }

    /// The other collider of the pair; `None` if `collider` is not part of it.
    #[must_use]
    pub fn other(&self, collider: Entity) -> Option<Entity> {
        match collider {
            _ if collider == self.collider1 => Some(self.collider2),
            _ if collider == self.collider2 => Some(self.collider1),
            _ => None,
        }
    }
}
