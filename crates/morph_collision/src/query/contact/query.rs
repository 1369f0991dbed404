use glam::DVec3;

use super::manifold::{ContactPoint, Manifold};
use super::parting::parting_distance;
use crate::exact::{Triangle, TriangleContact, triangle_contact};
use crate::query::body::world_triangle;
use crate::query::{Body, PairQuery, QueryStats, TrianglePair};

/// Two intersecting triangles and where they meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// The triangles.
    pub pair: TrianglePair,
    /// Where they meet, in world space.
    pub contact: TriangleContact,
}

/// How far a body has to go until it leaves another; see [`ContactQuery::separation`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// The way along the direction: no shorter one parts the bodies.
    pub distance: f64,
    /// Whether that way parts them, up to touching; `false` when the steps did not suffice, or too many triangles touch to look
    /// at them all.
    pub complete: bool,
    /// Pair queries made.
    pub steps: usize,
}

/// Asks where and how two bodies touch; holds the memory that queries reuse.
///
/// It finds the intersecting triangles as [`PairQuery`] does, exactly, and then describes them in `f64`. Bodies are
/// surfaces: one that is wholly inside the other without meeting its surface has no contact. Normals suppose closed
/// surfaces with triangles that turn counter-clockwise seen from outside; a body that is placed mirrored counts as turned
/// back.
///
/// With the bodies exchanged, points and depths are the same, bit for bit, and normals the opposite.
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
/// let (manifold, _) = ContactQuery::new().manifold(Body::new(&mut a, &upper), Body::new(&mut b, &lower));
/// let manifold = manifold.expect("the tips are in each other");
/// assert!(manifold.normal.z > 0.9); // up and away
/// assert!(manifold.depth > 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct ContactQuery {
    pairs: PairQuery,
    found: Vec<TrianglePair>,
    corners: [Vec<Triangle>; 2],
    touching: Vec<Touching>,
    points: Vec<ContactPoint>,
}

/// A pair of intersecting triangles in world space, outward windings counter-clockwise.
#[derive(Clone, Copy, Debug)]
struct Touching {
    pair: TrianglePair,
    a: Triangle,
    b: Triangle,
    contact: TriangleContact,
}

impl ContactQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends a contact for every pair of intersecting triangles.
    pub fn all(&mut self, mut a: Body<'_>, mut b: Body<'_>, contacts: &mut Vec<PairContact>) -> QueryStats {
        self.append_up_to(usize::MAX, &mut a, &mut b, contacts).1
    }

    /// Appends a contact for each of at most `limit` pairs of intersecting triangles, those of [`PairQuery::up_to`]; says whether
    /// there are more.
    pub fn up_to(
        &mut self,
        limit: usize,
        mut a: Body<'_>,
        mut b: Body<'_>,
        contacts: &mut Vec<PairContact>,
    ) -> (bool, QueryStats) {
        self.append_up_to(limit, &mut a, &mut b, contacts)
    }

    fn append_up_to(
        &mut self,
        limit: usize,
        a: &mut Body<'_>,
        b: &mut Body<'_>,
        contacts: &mut Vec<PairContact>,
    ) -> (bool, QueryStats) {
        let (is_truncated, stats) = self.find(limit, a, b);
        contacts.extend(self.touching.iter().map(|touching| PairContact {
            pair: touching.pair,
            contact: touching.contact,
        }));
        (is_truncated, stats)
    }

    /// What all contacts come to; `None` when no triangles intersect.
    ///
    /// Cost: a pair query, and in proportion to the intersecting pairs.
    pub fn manifold(&mut self, a: Body<'_>, b: Body<'_>) -> (Option<Manifold>, QueryStats) {
        self.manifold_up_to(usize::MAX, a, b)
    }

    /// What the contacts of at most `limit` pairs of intersecting triangles come to, those of [`PairQuery::up_to`]; `None` when no
    /// triangles intersect, or none may be looked at.
    ///
    /// Where there are more pairs, [`Manifold::is_truncated`] says so, and exchanging the bodies may give another manifold.
    pub fn manifold_up_to(&mut self, limit: usize, mut a: Body<'_>, mut b: Body<'_>) -> (Option<Manifold>, QueryStats) {
        let (is_truncated, stats) = self.find(limit, &mut a, &mut b);
        let normal = mean_normal(&self.touching);
        self.points.clear();
        for touching in &self.touching {
            let depth = parting_distance(&touching.a, &touching.b, normal);
            let pair = touching.pair;
            let ends = touching.contact.segment;
            self.points
                .extend(ends.map(|point| ContactPoint { point, depth, pair }));
        }
        let manifold = Manifold::reduce(normal, self.touching.len(), is_truncated, &self.points);
        (manifold, stats)
    }

    /// The shortest way of `a` along `direction` after which the two surfaces at most touch.
    ///
    /// `direction` need not be of length 1; the distance is in world units. Zero for bodies that do not intersect. After one
    /// that is longer they may meet again. The bodies are moved on until the triangles that intersect are parted, and looked
    /// at again, at most `steps` times; each costs a pair query. On the way they always intersect, so that the distance is a
    /// lower bound even where the steps do not suffice. A step looks at 65,536 pairs of triangles at most; if there are more, and
    /// those are parted, the search ends there without being complete.
    ///
    /// Error: about `1e-9` of the distance moved and of the triangles' sizes. `None` if the direction is zero or not finite.
    pub fn separation(&mut self, a: Body<'_>, mut b: Body<'_>, direction: DVec3, steps: usize) -> Option<Separation> {
        const DONE: f64 = 1e-10;
        const MOST_PAIRS: usize = 1 << 16;
        let size = direction.abs().max_element();
        let direction = (direction / size).try_normalize()?;
        let mut separation = Separation {
            distance: 0.0,
            complete: false,
            steps: 0,
        };
        while separation.steps < steps && !separation.complete {
            separation.steps += 1;
            let moved = a.world_from_model.translated(direction * separation.distance);
            let mut a = Body::new(a.pose, &moved);
            let mut b = b.reborrow();
            let (is_truncated, _) = self.find(MOST_PAIRS, &mut a, &mut b);
            let (mut way, mut size) = (0.0_f64, 0.0_f64);
            for touching in &self.touching {
                way = way.max(parting_distance(&touching.a, &touching.b, direction));
                size = size.max(touching.a[0].distance(touching.a[1]));
                size = size.max(touching.b[0].distance(touching.b[1]));
            }
            let is_parted = way <= DONE * size.max(separation.distance);
            separation.complete = is_parted && !is_truncated;
            separation.distance += way;
            if is_parted && is_truncated {
                break;
            }
        }
        Some(separation)
    }

    /// Fills `touching`, in an order that does not depend on which body was named first.
    ///
    /// At most `limit` pairs are looked at; says whether there are more.
    fn find(&mut self, limit: usize, a: &mut Body<'_>, b: &mut Body<'_>) -> (bool, QueryStats) {
        self.found.clear();
        let body_a = Body::new(a.pose, a.world_from_model);
        let body_b = Body::new(b.pose, b.world_from_model);
        let (is_truncated, stats) = self.pairs.up_to(limit, body_a, body_b, &mut self.found);
        self.touching.clear();
        let [corners_a, corners_b] = &mut self.corners;
        read_outward(a, self.found.iter().map(|pair| pair.triangle_a), corners_a);
        read_outward(b, self.found.iter().map(|pair| pair.triangle_b), corners_b);
        for ((&pair, &a), &b) in self.found.iter().zip(&*corners_a).zip(&*corners_b) {
            // Always: the pair query asks the same predicates.
            if let Some(contact) = triangle_contact(&a, &b) {
                self.touching.push(Touching { pair, a, b, contact });
            }
        }
        let key = |touching: &Touching| {
            let TriangleContact { segment, normal } = touching.contact;
            let TrianglePair { triangle_a, triangle_b } = touching.pair;
            // Of two equal shapes on top of each other each pair comes twice, both ways round.
            let numbers = [triangle_a.min(triangle_b), triangle_a.max(triangle_b), triangle_a];
            ([segment[0], segment[1], normal.abs()].map(|v| v.to_array()), numbers)
        };
        self.touching
            .sort_by(|s, t| key(s).partial_cmp(&key(t)).unwrap_or(std::cmp::Ordering::Equal));
        (is_truncated, stats)
    }
}

/// Corners of a body's triangles in world space; those of a mirrored one turned back.
fn read_outward(body: &mut Body<'_>, triangles: impl Iterator<Item = u32>, corners: &mut Vec<Triangle>) {
    let world_from_model = body.world_from_model;
    let mirrors = world_from_model.mirrors();
    corners.clear();
    let mut posed = body.pose.posed();
    corners.extend(triangles.map(|triangle| {
        let [p, q, r] = world_triangle(&mut posed, world_from_model, triangle);
        if mirrors { [p, r, q] } else { [p, q, r] }
    }));
}

/// See [`Manifold::normal`].
fn mean_normal(touching: &[Touching]) -> DVec3 {
    /// Sums shorter than this share of their terms have cancelled out.
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
