//! A contact during a motion.

use glam::DVec3;

use super::moving_body::MovingBody;
use crate::exact::motion::TimeOfImpact;
use crate::exact::{closest_on_triangle, triangle_contact};
use crate::query::contact::outward_triangle;
use crate::query::triangle_pair::TrianglePair;

/// What touches: a vertex and a face, or two edges. Vertices are welded vertices ([`Body::vertex`](crate::Body::vertex)).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Features {
    /// A vertex of the first body touches a triangle of the second.
    VertexFace {
        /// The vertex of the first body.
        vertex_a: u32,
        /// The triangle of the second body.
        triangle_b: u32,
    },
    /// A triangle of the first body touches a vertex of the second.
    FaceVertex {
        /// The triangle of the first body.
        triangle_a: u32,
        /// The vertex of the second body.
        vertex_b: u32,
    },
    /// Two edges touch.
    EdgeEdge {
        /// The ends of the first body's edge, the smaller number first.
        edge_a: [u32; 2],
        /// The ends of the second body's edge, the smaller number first.
        edge_b: [u32; 2],
    },
    /// Two triangles that intersect when the motion starts. Only [`MotionQuery::first`](super::MotionQuery::first) reports it.
    AtStart(TrianglePair),
}

/// A contact during a motion.
///
/// Whether features touch, and the ends of `time`, are exact. All other numbers are computed in `f64`, at a time that differs by at most
/// `2^-31` from the one at which these features first touch. Their errors are a few roundings, divided by the sine of the angle between two
/// edges, and what the features move in that difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionContact {
    /// What touches.
    pub features: Features,
    /// The triangles of these features. Of those that share a vertex or an edge, the one with the lowest index.
    pub triangles: TrianglePair,
    /// When it first touches, as a share of the motion. [`MotionQuery::first`](super::MotionQuery::first) returns an interval that also
    /// contains the first time of all contacts.
    pub time: TimeOfImpact,
    /// Where it touches, in world space: the position of the vertex, or midway between the closest points of the two edges. If triangles
    /// intersect at the start, the middle of the segment in which they meet.
    pub point: DVec3,
    /// The unit vector from the second body to the first: across the face, or across both edges. It points to the side from which the first
    /// one comes, so the relative velocity along it is not positive.
    ///
    /// If the motion does not tell the side (at the start, or if nothing moves along the normal), windings do: it points out of the second
    /// body, as the normal of [`ContactQuery`](crate::ContactQuery). If triangles intersect at the start, it is the normal of
    /// [`triangle_contact`](crate::triangle_contact).
    ///
    /// Parallel edges, and a face without area, have no plane. Then the normal is the direction of the approach without its part along the
    /// longest edge. It is zero only if there is no motion and no winding to tell a direction.
    pub normal: DVec3,
    /// The velocity of the first body's surface relative to the second's at the point, in world units per motion.
    pub velocity: DVec3,
    /// Where the point is on both features: the weights of a triangle's corners, in the triangle's order; or those of an edge's two ends and
    /// 0; or 1, 0 and 0 for a vertex. They are not negative, and their sum is 1 up to rounding.
    pub barycentrics: [[f64; 3]; 2],
}

impl MotionContact {
    /// The contact of two triangles that intersect when the motion starts.
    pub(super) fn at_start(pair: TrianglePair, a: &mut MovingBody<'_>, b: &mut MovingBody<'_>) -> Self {
        let outward = [
            outward_triangle(&mut a.start.posed(), pair.triangle_a),
            outward_triangle(&mut b.start.posed(), pair.triangle_b),
        ];
        // Never `None`: the pair query uses the same predicates.
        let (point, normal) = triangle_contact(&outward[0], &outward[1])
            .map_or((outward[0][0], DVec3::ZERO), |contact| {
                (contact.point(), contact.normal)
            });
        let (on_a, velocity_a) = at_point(a, pair.triangle_a, point);
        let (on_b, velocity_b) = at_point(b, pair.triangle_b, point);
        Self {
            features: Features::AtStart(pair),
            triangles: pair,
            time: TimeOfImpact {
                earliest: 0.0,
                latest: 0.0,
            },
            point,
            normal,
            velocity: velocity_a - velocity_b,
            barycentrics: [on_a, on_b],
        }
    }
}

/// The barycentric coordinates of a point of a triangle at the start, and the velocity of the surface there.
fn at_point(body: &mut MovingBody<'_>, triangle: u32, point: DVec3) -> ([f64; 3], DVec3) {
    let [start, end] = [&mut body.start, &mut body.end].map(|end| end.posed().world_triangle(triangle));
    let barycentrics = closest_on_triangle(point, &start).barycentrics;
    let velocity = |corner: usize| (end[corner] - start[corner]) * barycentrics[corner];
    (barycentrics, velocity(0) + velocity(1) + velocity(2))
}
