//! The decision in exact arithmetic.

use std::cmp::Ordering::{Equal, Greater};

use super::features::{FeaturePair, Kind};
use super::moving::{MovingPoint, TimeOfImpact};
use super::polynomial::Polynomial;
use super::root::{Root, roots};
use crate::exact::dyadic::whole_numbers;

type Vector = [Polynomial; 3];

/// Whether two features touch at any time.
#[cold]
pub(super) fn touch(features: &FeaturePair) -> bool {
    Exact::new(features).is_some_and(|exact| !exact.first_contacts(true).is_empty())
}

/// When two features touch first.
#[cold]
pub(super) fn impact(features: &FeaturePair, tolerance: f64) -> Option<TimeOfImpact> {
    let contacts = Exact::new(features)?.first_contacts(false);
    let brackets = contacts.iter().map(|root| root.bracket(tolerance));
    // The first contact is the first of several roots. Its bracket is not later than the earliest bracket in either end.
    brackets.reduce(|a, b| TimeOfImpact {
        earliest: a.earliest.min(b.earliest),
        latest: a.latest.min(b.latest),
    })
}

/// The polynomials of [`Kind`], times positive numbers.
struct Exact {
    kind: Kind,
    /// The corners, as multiples of one power of two.
    corners: [Vector; 4],
    /// `n . w`.
    height: Polynomial,
    /// `n . n`.
    normal: Polynomial,
    /// At least 0 where the features touch, if `n` is not zero.
    sides: Vec<Polynomial>,
}

impl Exact {
    /// `None` if a coordinate is not finite.
    fn new(features: &FeaturePair) -> Option<Self> {
        if !features.corners.iter().all(MovingPoint::is_finite) {
            return None;
        }
        let coordinates = features
            .corners
            .map(|corner| [corner.start.to_array(), corner.end.to_array()]);
        let whole = whole_numbers(coordinates.as_flattened().as_flattened());
        let corners = std::array::from_fn(|corner| {
            let [start, end] = [0, 3].map(|first| &whole[6 * corner + first..][..3]);
            std::array::from_fn(|axis| Polynomial::between(&start[axis], &end[axis]))
        });
        let [u, v, w] = features
            .kind
            .spans()
            .map(|[from, to]| difference(&corners[to], &corners[from]));
        let n = cross(&u, &v);
        let (normal, p, q) = (dot(&n, &n), dot(&cross(&w, &v), &n), dot(&cross(&u, &w), &n));
        let sides = match features.kind {
            Kind::VertexFace => {
                let rest = normal.minus(&p).minus(&q);
                vec![p, q, rest]
            }
            Kind::EdgeEdge => {
                let (p_rest, q_rest) = (normal.minus(&p), normal.plus(&q));
                let q = Polynomial::new(Vec::new()).minus(&q);
                vec![p, p_rest, q, q_rest]
            }
        };
        Some(Self {
            kind: features.kind,
            height: dot(&n, &w),
            corners,
            normal,
            sides,
        })
    }

    /// Times of contact, among them the first one. Empty if there is no contact. With `any`, one time of contact is enough.
    ///
    /// Features touch only at roots of the height `n . w`. If it is always zero, all corners stay in one plane that may turn. Then the
    /// first contact is at time 0, or it is a contact of a vertex with an edge. To see this, take the first time of contact `t`, and
    /// let it be after 0. It exists, because the times of contact are a closed set. If `n` is zero at `t`, the contact is one of a
    /// vertex with an edge, as [`Kind`] says. If `n` is not zero and the contact is inside the face, or inside both edges, all sides
    /// are positive at `t`. By continuity, they and `n . n` are positive shortly before `t`, so there is contact before the first
    /// one. So the contact is on an edge of the face, or at an end of an edge.
    fn first_contacts(&self, any: bool) -> Vec<Root> {
        if !self.height.is_zero() {
            let mut candidates = roots(&self.height).into_iter();
            return candidates
                .find_map(|mut time| self.is_contact(&mut time).then_some(time))
                .into_iter()
                .collect();
        }
        let mut start = Root::zero();
        if self.is_contact(&mut start) {
            return vec![start];
        }
        let mut contacts = self
            .kind
            .vertex_edges()
            .iter()
            .filter_map(|&corners| self.vertex_edge(corners).first());
        if any {
            contacts.next().into_iter().collect()
        } else {
            contacts.collect()
        }
    }

    /// Whether features with a height of zero at this time touch then.
    fn is_contact(&self, time: &mut Root) -> bool {
        if time.sign_of(&self.normal) == Greater {
            self.sides.iter().all(|side| time.sign_of(side).is_ge())
        } else {
            let mut pairs = self.kind.vertex_edges().iter();
            pairs.any(|&corners| self.vertex_edge(corners).is_contact(time))
        }
    }

    fn vertex_edge(&self, corners: [usize; 3]) -> VertexEdge {
        let [p, a, b] = corners.map(|corner| &self.corners[corner]);
        let (a, b) = (difference(a, p), difference(b, p));
        VertexEdge {
            offsets: cross(&a, &b),
            between: dot(&a, &b),
        }
    }
}

/// The polynomials of a vertex `p` and an edge `a b`.
struct VertexEdge {
    /// `(a - p) x (b - p)`, zero if the three are on a line.
    offsets: Vector,
    /// `(a - p) . (b - p)`, not positive if `p` is in the ball whose diameter is the edge.
    between: Polynomial,
}

impl VertexEdge {
    fn is_contact(&self, time: &mut Root) -> bool {
        self.offsets.iter().all(|offset| time.sign_of(offset) == Equal) && time.sign_of(&self.between).is_le()
    }

    /// The first contact.
    ///
    /// If the three are always on a line, contact is where `between` is not positive. So it starts at time 0 or at a root.
    fn first(&self) -> Option<Root> {
        let mut offsets = self.offsets.iter().filter(|offset| !offset.is_zero());
        let Some(first) = offsets.next() else {
            let mut start = Root::zero();
            let starts = start.sign_of(&self.between).is_le();
            return if starts {
                Some(start)
            } else {
                roots(&self.between).into_iter().next()
            };
        };
        let common = offsets.fold(first.clone(), |common, offset| common.common_divisor(offset));
        let mut candidates = roots(&common).into_iter();
        candidates.find_map(|mut time| time.sign_of(&self.between).is_le().then_some(time))
    }
}

fn difference(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|axis| a[axis].minus(&b[axis]))
}

fn dot(a: &Vector, b: &Vector) -> Polynomial {
    let [x, y, z] = std::array::from_fn(|axis| a[axis].times(&b[axis]));
    x.plus(&y).plus(&z)
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|axis| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        a[i].times(&b[j]).minus(&a[j].times(&b[i]))
    })
}
