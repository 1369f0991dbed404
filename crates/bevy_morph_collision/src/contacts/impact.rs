//! How contacts of continuous colliders begin.

use bevy::prelude::*;
use morph_collision::TrianglePair;

use super::no_triangles::no_triangles;

/// When and where a contact of a [continuous](crate::components::MorphCollider::continuous) collider began, between the last run and this one.
///
/// Between the two runs, every vertex moves on a straight line in the world. For these lines the answer is exact. A
/// [`MorphShape`](crate::components::MorphShape) keeps its shape: its middle moves on a straight line while it turns.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphImpact {
    /// They did not touch before this time: 0 is the last run, 1 is this one. Multiply it with the time between the two (by default
    /// the time of a frame).
    pub earliest: f64,
    /// They touched at this time or before. It is at most 1e-6 after `earliest`, unless it takes too much work to tell when they first
    /// touched (`docs/continuous.md`).
    pub latest: f64,
    /// Where they first touched, in world space.
    pub point: Vec3,
    /// The unit vector along which `collider1` moves out of `collider2` there; zero if there is none.
    pub normal: Vec3,
    /// The velocity of `collider1` at that point relative to that of `collider2`, in world units per second. Zero if the app has no
    /// [`Time`], or if no time passed.
    pub velocity: Vec3,
    /// What touched first.
    pub features: MorphImpactFeatures,
    /// The triangles of these features: `triangle_a` of `collider1`, `triangle_b` of `collider2`. Where several triangles have the
    /// vertex or edge, it is one of them. For a [`MorphShape`](crate::components::MorphShape) it is
    /// [`MorphContact::NO_TRIANGLE`](crate::contacts::MorphContact::NO_TRIANGLE).
    ///
    /// Not reflected: both are [`MorphContact::NO_TRIANGLE`](crate::contacts::MorphContact::NO_TRIANGLE) in a value created by reflection.
    #[reflect(ignore, default = "no_triangles")]
    pub triangles: TrianglePair,
    /// The barycentric coordinates of the point in each triangle (zero for a shape), for example to stick a [`MorphSurfaceAnchor`](crate::surface::MorphSurfaceAnchor)
    /// to it.
    pub barycentrics: [Vec3; 2],
}

/// The features of two colliders that touch first.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Debug, Clone, PartialEq, Hash)]
pub enum MorphImpactFeatures {
    /// A vertex of `collider1` and a triangle of `collider2`.
    VertexFace,
    /// A triangle of `collider1` and a vertex of `collider2`.
    FaceVertex,
    /// An edge of each.
    EdgeEdge,
    /// A [`MorphShape`](crate::components::MorphShape) and a triangle.
    Shape,
    /// Two triangles, or a shape and a triangle, that already intersected in the last run. That happens if the colliders were not compared then, for example
    /// because of their layers.
    AtStart,
    /// It takes too much work to tell whether anything touched on the way (`docs/continuous.md`). They may have touched at `earliest` or
    /// later. `normal` and `velocity` are zero, and `triangles` are [`MorphContact::NO_TRIANGLE`](crate::contacts::MorphContact::NO_TRIANGLE).
    Undecided,
}

impl MorphImpact {
    /// The same impact with the colliders in the other order.
    #[must_use]
    pub fn reversed(self) -> Self {
        let TrianglePair { triangle_a, triangle_b } = self.triangles;
        Self {
            normal: -self.normal,
            velocity: -self.velocity,
            features: match self.features {
                MorphImpactFeatures::VertexFace => MorphImpactFeatures::FaceVertex,
                MorphImpactFeatures::FaceVertex => MorphImpactFeatures::VertexFace,
                other => other,
            },
            triangles: TrianglePair {
                triangle_a: triangle_b,
                triangle_b: triangle_a,
            },
            barycentrics: [self.barycentrics[1], self.barycentrics[0]],
            ..self
        }
    }
}
