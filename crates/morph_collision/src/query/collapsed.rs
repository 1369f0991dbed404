//! Bodies so small, for where they stand, that rounding decides where their vertices are.
//!
//! No box of a tree can tell parts of such bodies apart: the slack for rounding is larger than they are, and a walk over their trees
//! would look at every pair of triangles. But their vertices take few positions, and few of their triangles differ. So the
//! triangles are placed in the world, those with the same corners are counted once, and a tree of exact `f64` boxes is built
//! over the rest: linear in the triangles up to a logarithm.

use std::cmp::Ordering;
use std::ops::{ControlFlow, Range};

use glam::DVec3;

use super::body::world_triangle;
use super::pairs::TrianglePair;
use super::places::Places;
use crate::exact::{Facet, Triangle, facets_intersect_counting};
use crate::pose::Posed;

/// The placed triangles of two collapsed bodies; the memory is reused by the next query.
#[derive(Debug, Default)]
pub(super) struct Collapsed {
    a: DistinctTriangles,
    b: DistinctTriangles,
    stack: Vec<(Node, Node)>,
}

/// What a walk over two collapsed bodies took.
#[derive(Debug, Default)]
pub(super) struct CollapsedTests {
    pub(super) nodes: u64,
    pub(super) triangles: u64,
    pub(super) undecided_by_filter: u64,
}

impl Collapsed {
    /// Places both bodies' triangles. Cost: every vertex is blended, `O(n log n)`.
    pub(super) fn place(&mut self, a: &mut Posed<'_>, b: &mut Posed<'_>, places: &Places<'_>) {
        let corners_of = |tree: &mut Posed<'_>, place, number| world_triangle(tree, place, number);
        self.a
            .fill(a.topology.triangle_count(), |n| corners_of(a, places.world_from_a, n));
        self.b
            .fill(b.topology.triangle_count(), |n| corners_of(b, places.world_from_b, n));
    }

    /// Calls `visitor` for every pair of intersecting triangles, until it breaks. Triangles with the same corners are tested once.
    pub(super) fn intersecting(
        &mut self,
        tests: &mut CollapsedTests,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Self { a, b, stack } = self;
        stack.clear();
        stack.extend(a.root().zip(b.root()));
        while let Some((node_a, node_b)) = stack.pop() {
            tests.nodes += 1;
            if !a.boxes[node_a.index].overlaps(&b.boxes[node_b.index]) {
                continue;
            }
            match node_a.split_with(&node_b) {
                Some(pairs) => stack.extend(pairs.into_iter().rev()),
                None => {
                    let (same_a, same_b) = (&a.triangles[node_a.first], &b.triangles[node_b.first]);
                    tests.triangles += 1;
                    let facets = [same_a, same_b].map(|same| Facet::new(same.corners));
                    if facets_intersect_counting(&facets[0], &facets[1], &mut tests.undecided_by_filter) {
                        for &triangle_a in &a.numbers[same_a.numbers.clone()] {
                            for &triangle_b in &b.numbers[same_b.numbers.clone()] {
                                visitor(TrianglePair { triangle_a, triangle_b })?;
                            }
                        }
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Calls `visitor` for pairs of triangles, of those with the same corners the first by number, whose boxes are nearer to each
    /// other than a limit, until it breaks; near ones come first. It returns the new limit, a squared distance.
    pub(super) fn nearer(
        &mut self,
        mut limit: f64,
        tests: &mut CollapsedTests,
        mut visitor: impl FnMut(TrianglePair, &Triangle, &Triangle) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let Self { a, b, stack } = self;
        stack.clear();
        stack.extend(a.root().zip(b.root()));
        while let Some((node_a, node_b)) = stack.pop() {
            tests.nodes += 1;
            let apart = |a_at: &Node, b_at: &Node| a.boxes[a_at.index].squared_distance(&b.boxes[b_at.index]);
            if apart(&node_a, &node_b) > limit {
                continue;
            }
            match node_a.split_with(&node_b) {
                Some(mut pairs) => {
                    pairs.sort_by(|(a, b), (c, d)| apart(c, d).total_cmp(&apart(a, b)));
                    stack.extend(pairs);
                }
                None => {
                    let (same_a, same_b) = (&a.triangles[node_a.first], &b.triangles[node_b.first]);
                    tests.triangles += 1;
                    let pair = TrianglePair {
                        triangle_a: a.numbers[same_a.numbers.start],
                        triangle_b: b.numbers[same_b.numbers.start],
                    };
                    limit = visitor(pair, &same_a.corners, &same_b.corners)?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// The triangles of a body in the world, those with the same corners together, and a tree of boxes over them.
#[derive(Debug, Default)]
struct DistinctTriangles {
    placed: Vec<(Triangle, u32)>,
    /// Ordered so that each node of the tree has a range of them.
    triangles: Vec<Same>,
    /// By triangle, ascending.
    numbers: Vec<u32>,
    /// Of the tree's nodes in preorder.
    boxes: Vec<ExactBox>,
}

/// Triangles with the same corners, in whatever order each has them.
#[derive(Clone, Debug)]
struct Same {
    /// Of the first by number.
    corners: Triangle,
    /// Where their numbers are.
    numbers: Range<usize>,
}

impl DistinctTriangles {
    fn fill(&mut self, count: usize, mut corners: impl FnMut(u32) -> Triangle) {
        let Self {
            placed,
            triangles,
            numbers,
            boxes,
        } = self;
        placed.clear();
        placed.extend((0..count as u32).map(|number| {
            let mut corners = corners(number);
            corners.sort_unstable_by(lexicographic);
            (corners, number)
        }));
        placed.sort_unstable_by(|(s, i), (t, j)| compare(s, t).then(i.cmp(j)));
        triangles.clear();
        numbers.clear();
        for (corners, number) in placed.iter() {
            let place = numbers.len();
            numbers.push(*number);
            match triangles.last_mut() {
                Some(same) if compare(&same.corners, corners).is_eq() => same.numbers.end = place + 1,
                _ => triangles.push(Same {
                    corners: *corners,
                    numbers: place..place + 1,
                }),
            }
        }
        boxes.clear();
        if !triangles.is_empty() {
            build(triangles, boxes);
        }
    }

    fn root(&self) -> Option<Node> {
        let len = self.triangles.len();
        (len > 0).then_some(Node {
            index: 0,
            first: 0,
            len,
        })
    }
}

/// Halves the triangles along the longest side of their box, again and again.
fn build(triangles: &mut [Same], boxes: &mut Vec<ExactBox>) {
    let bounds = triangles
        .iter()
        .map(|same| ExactBox::of(&same.corners))
        .fold(ExactBox::EMPTY, ExactBox::union);
    boxes.push(bounds);
    if triangles.len() < 2 {
        return;
    }
    let axis = (bounds.max - bounds.min).max_position();
    let place = |same: &Same| same.corners.iter().map(|corner| corner[axis]).sum::<f64>();
    let middle = triangles.len() / 2;
    triangles.select_nth_unstable_by(middle, |s, t| {
        place(s)
            .total_cmp(&place(t))
            .then(s.numbers.start.cmp(&t.numbers.start))
    });
    let (lower, upper) = triangles.split_at_mut(middle);
    build(lower, boxes);
    build(upper, boxes);
}

/// A node of a tree in preorder that always halves what it has.
#[derive(Clone, Copy, Debug)]
struct Node {
    index: usize,
    first: usize,
    len: usize,
}

impl Node {
    fn children(&self) -> [Self; 2] {
        let middle = self.len / 2;
        [
            Self {
                index: self.index + 1,
                first: self.first,
                len: middle,
            },
            Self {
                // A tree over `n` triangles has `2 n - 1` nodes.
                index: self.index + 2 * middle,
                first: self.first + middle,
                len: self.len - middle,
            },
        ]
    }

    /// The pairs below two nodes, the larger of them split; `None` for two triangles.
    fn split_with(&self, other: &Self) -> Option<[(Self, Self); 2]> {
        if self.len == 1 && other.len == 1 {
            None
        } else if self.len >= other.len {
            Some(self.children().map(|child| (child, *other)))
        } else {
            Some(other.children().map(|child| (*self, child)))
        }
    }
}

/// A closed box; comparing coordinates is exact.
#[derive(Clone, Copy, Debug)]
struct ExactBox {
    min: DVec3,
    max: DVec3,
}

impl ExactBox {
    const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    fn of([a, b, c]: &Triangle) -> Self {
        Self {
            min: a.min(*b).min(*c),
            max: a.max(*b).max(*c),
        }
    }

    fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// From below, up to a few roundings.
    fn squared_distance(&self, other: &Self) -> f64 {
        let gap = (self.min - other.max).max(other.min - self.max).max(DVec3::ZERO);
        gap.length_squared()
    }
}

fn lexicographic(p: &DVec3, q: &DVec3) -> Ordering {
    let [p, q] = [p, q].map(DVec3::to_array);
    p.partial_cmp(&q).unwrap_or(Ordering::Equal)
}

/// Of sorted corners.
fn compare(s: &Triangle, t: &Triangle) -> Ordering {
    let key = |triangle: &Triangle| triangle.map(|corner| corner.to_array());
    key(s).partial_cmp(&key(t)).unwrap_or(Ordering::Equal)
}
