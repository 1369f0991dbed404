//! The query for contacts.

use std::cmp::Ordering;

use glam::DVec3;

use super::manifold::{ContactPoint, Manifold};
use super::parting::parting_distance;
use crate::exact::{Triangle, TriangleContact, triangle_contact};
use crate::pose::Posed;
use crate::query::{Body, PairQuery, QueryStats, TrianglePair};

/// Finds where and how two bodies touch. Keep the query and use it again: it reuses its memory.
///
/// It finds the intersecting triangles exactly, like [`PairQuery`], and describes the contacts in `f64`. Bodies are surfaces: if one
/// is wholly inside another without touching its surface, there is no contact. Normals assume closed surfaces whose triangles are
/// counter-clockwise seen from outside; the winding of mirrored bodies is flipped back.
///
/// Swapping the bodies gives the same points and depths, bit for bit, and opposite normals.
///
/// ```
/// use std::sync::Arc;
/// use glam::{Affine3A, Vec3};
/// use morph_collision::{Body, BuildOptions, ContactQuery, MorphBvh, MorphModel, Pose, WorldFromModel};
///
/// // A tetrahedron with its tip down, and one with its tip up below it.
/// let corners = [Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0), Vec3::new(-1.0, 1.0, 1.0), Vec3::new(-1.0, -1.0, 1.0)];
/// let faces = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
/// let model = MorphModel::from_displacements::<Vec<Vec3>>(&corners, &faces, &[])?;
/// let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
/// let upper = WorldFromModel::new(Affine3A::from_translation(Vec3::new(0.0, 0.0, -0.25)))?;
/// let lower = WorldFromModel::new(Affine3A::from_scale(Vec3::new(-1.0, -1.0, -1.0)))?;
///
/// let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
/// let manifold = ContactQuery::new().manifold(Body::new(&mut a, &upper), Body::new(&mut b, &lower));
/// let manifold = manifold.expect("the tips intersect");
/// assert!(manifold.normal.z > 0.9); // up and away
/// assert!(manifold.depth > 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct ContactQuery {
    pairs: PairQuery,
    found: Vec<TrianglePair>,
    touching: Vec<Touching>,
    points: Vec<ContactPoint>,
    stats: QueryStats,
}

/// Two intersecting triangles in world space, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug)]
struct Touching {
    triangles: TrianglePair,
    a: Triangle,
    b: Triangle,
    contact: TriangleContact,
}

query_basics!(ContactQuery, |query| query.stats);

impl ContactQuery {
    /// Returns a summary of all contacts; `None` if no triangles intersect.
    ///
    /// Cost: a pair query, plus time proportional to the number of intersecting pairs.
    pub fn manifold(&mut self, a: Body<'_>, b: Body<'_>) -> Option<Manifold> {
        self.manifold_up_to(a, b, usize::MAX)
    }

    /// Returns a summary of the pairs that [`PairQuery::up_to`] finds; `None` if there are none.
    ///
    /// If there are more pairs than `limit`, [`Manifold::is_truncated`] is set, and swapping the bodies may give another manifold.
    pub fn manifold_up_to(&mut self, mut a: Body<'_>, mut b: Body<'_>, limit: usize) -> Option<Manifold> {
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        let is_truncated = self.pairs.up_to(a.reborrow(), b.reborrow(), limit, &mut found);
        self.describe(a, b, &found);
        self.stats += self.pairs.stats();
        self.found = found;
        self.summary(is_truncated)
    }

    /// Returns a summary of pairs that another query has already found; `None` if there are none. Pairs that do not intersect, or that
    /// name a triangle that does not exist, are left out.
    ///
    /// With all pairs, in any order, it is what [`manifold`](Self::manifold) returns, bit for bit.
    pub fn manifold_of(&mut self, a: Body<'_>, b: Body<'_>, pairs: &[TrianglePair]) -> Option<Manifold> {
        self.describe(a, b, pairs);
        self.summary(false)
    }

    /// A summary of `touching`; `None` if it is empty.
    fn summary(&mut self, is_truncated: bool) -> Option<Manifold> {
        let normal = mean_normal(&self.touching);
        self.points.clear();
        for &Touching {
            triangles,
            a,
            b,
            contact,
        } in &self.touching
        {
            let depth = parting_distance(&a, &b, normal);
            let points = contact.segment.map(|point| ContactPoint {
                point,
                depth,
                triangles,
            });
            self.points.extend(points);
        }
        Manifold::reduce(normal, self.touching.len(), is_truncated, &self.points)
    }

    /// Fills `touching` with those of the pairs that intersect, in an order that does not depend on which body is named first.
    fn describe(&mut self, mut a: Body<'_>, mut b: Body<'_>, pairs: &[TrianglePair]) {
        self.touching.clear();
        let (posed_a, posed_b) = (&mut a.posed(), &mut b.posed());
        let before = [posed_a.blended(), posed_b.blended()];
        let [count_a, count_b] = [&posed_a.model, &posed_b.model].map(|model| model.triangle_count());
        for &triangles in pairs {
            if triangles.triangle_a as usize >= count_a || triangles.triangle_b as usize >= count_b {
                continue;
            }
            let a = outward_triangle(posed_a, triangles.triangle_a);
            let b = outward_triangle(posed_b, triangles.triangle_b);
            if let Some(contact) = triangle_contact(&a, &b) {
                self.touching.push(Touching {
                    triangles,
                    a,
                    b,
                    contact,
                });
            }
        }
        self.stats = QueryStats::blending(before, [posed_a.blended(), posed_b.blended()]);
        let key = |touching: &Touching| {
            let TriangleContact { segment, normal } = touching.contact;
            let TrianglePair { triangle_a, triangle_b } = touching.triangles;
            // Two equal shapes at the same place list each pair twice, in both orders.
            let numbers = [triangle_a.min(triangle_b), triangle_a.max(triangle_b), triangle_a];
            ([segment[0], segment[1], normal.abs()].map(|v| v.to_array()), numbers)
        };
        self.touching.sort_by(|s, t| {
            // PERF: one coordinate decides most comparisons.
            let [first, second] = [s, t].map(|touching| touching.contact.segment[0].x);
            let order = first.partial_cmp(&second).filter(|order| order.is_ne());
            let all = || key(s).partial_cmp(&key(t));
            order.or_else(all).unwrap_or(Ordering::Equal)
        });
    }
}

/// A triangle's corners in world space; the winding of a mirrored body is flipped.
pub(in crate::query) fn outward_triangle(posed: &mut Posed<'_>, triangle: u32) -> Triangle {
    let [p, q, r] = posed.world_triangle(triangle);
    if posed.world_from_model.mirrors() {
        [p, r, q]
    } else {
        [p, q, r]
    }
}

/// See [`Manifold::normal`].
fn mean_normal(touching: &[Touching]) -> DVec3 {
    /// Sums shorter than this share of their terms count as cancelled out.
    const CANCELLED: f64 = 1e-9;
    let total: f64 = touching.iter().map(|t| t.contact.length()).sum();
    let weight = |t: &Touching| if total > 0.0 { t.contact.length() / total } else { 1.0 };
    let sum: DVec3 = touching.iter().map(|t| t.contact.normal * weight(t)).sum();
    if sum.length() > CANCELLED {
        return sum.normalize();
    }
    touching
        .iter()
        .rev()
        .max_by(|s, t| s.contact.length().total_cmp(&t.contact.length()))
        .map_or(DVec3::ZERO, |t| t.contact.normal)
}
