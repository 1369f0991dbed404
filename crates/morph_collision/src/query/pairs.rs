use std::ops::ControlFlow;

use super::body::{Body, with_walkable_pair, world_triangle};
use super::memory::PairMemory;
use super::stats::QueryStats;
use crate::bounds::{Volume, WorldFromModel, frames_of};
use crate::exact::{Triangle, triangles_intersect_counting};
use crate::traverse::{CrossCull, Cull, Meeting, PairWalk, Stack, Walkable};
use crate::tree::Leaf;

/// Two intersecting triangles, each by its number in its own mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrianglePair {
    /// A triangle of the first body.
    pub triangle_a: u32,
    /// A triangle of the second body.
    pub triangle_b: u32,
}

/// Along how many axes the nodes of two trees are compared; no answer depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SeparatingAxes {
    /// The axes of both bodies: cheap, and usually enough.
    #[default]
    Lite,
    /// And the nine products of an axis of one and an axis of the other, on boxes around the nodes' volumes: fewer nodes and
    /// triangles are looked at, each at a higher price. Most is saved where flat or long boxes lie across each other; measure
    /// before you choose it.
    Full,
}

/// Asks which triangles of two bodies intersect; holds the memory that queries reuse.
///
/// The answer is exact over the posed vertices in world space, see the crate's introduction; touching counts. It does not
/// depend on the tree, and the same triangles come out whichever body is named first.
#[derive(Debug, Default)]
pub struct PairQuery {
    stack: Stack,
    leaf_a: LeafTriangles,
    leaf_b: LeafTriangles,
    axes: SeparatingAxes,
}

impl PairQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The same query with other axes to compare nodes along.
    #[must_use]
    pub fn with_axes(mut self, axes: SeparatingAxes) -> Self {
        self.axes = axes;
        self
    }

    /// Appends every pair of intersecting triangles, in the order of the walk.
    pub fn all(&mut self, a: Body<'_>, b: Body<'_>, pairs: &mut Vec<TrianglePair>) -> QueryStats {
        self.visit(a, b, |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        })
    }

    /// The first pair of intersecting triangles that the walk comes to.
    pub fn first(&mut self, a: Body<'_>, b: Body<'_>) -> (Option<TrianglePair>, QueryStats) {
        let mut first = None;
        let stats = self.visit(a, b, |pair| {
            first = Some(pair);
            ControlFlow::Break(())
        });
        (first, stats)
    }

    /// How many pairs of triangles intersect.
    pub fn count(&mut self, a: Body<'_>, b: Body<'_>) -> (u64, QueryStats) {
        let mut count = 0;
        let stats = self.visit(a, b, |_| {
            count += 1;
            ControlFlow::Continue(())
        });
        (count, stats)
    }

    /// Whether any triangles intersect.
    pub fn any(&mut self, a: Body<'_>, b: Body<'_>) -> (bool, QueryStats) {
        let (first, stats) = self.first(a, b);
        (first.is_some(), stats)
    }

    /// Calls `visitor` for every pair of intersecting triangles, in the order of the walk, until it breaks.
    pub fn visit(
        &mut self,
        a: Body<'_>,
        b: Body<'_>,
        mut visitor: impl FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> QueryStats {
        self.dispatch(a, b, None, &mut visitor)
    }

    /// As [`PairQuery::visit`], with what is remembered of the same pair of bodies in earlier frames.
    ///
    /// The answer is the same; see [`PairMemory`] for when it is found faster.
    pub fn visit_with(
        &mut self,
        memory: &mut PairMemory,
        a: Body<'_>,
        b: Body<'_>,
        mut visitor: impl FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> QueryStats {
        if memory.proves_apart(&a, &b) {
            return QueryStats::default();
        }
        let mut touched = false;
        memory.begin();
        let Body {
            pose: pose_a,
            world_from_model: world_from_a,
        } = a;
        let Body {
            pose: pose_b,
            world_from_model: world_from_b,
        } = b;
        let bodies = (
            Body::new(&mut *pose_a, world_from_a),
            Body::new(&mut *pose_b, world_from_b),
        );
        let stats = self.dispatch(bodies.0, bodies.1, Some(memory), &mut |pair| {
            touched = true;
            visitor(pair)
        });
        memory.finish(
            touched,
            Body::new(pose_a, world_from_a),
            Body::new(pose_b, world_from_b),
        );
        stats
    }

    fn dispatch(
        &mut self,
        a: Body<'_>,
        b: Body<'_>,
        memory: Option<&mut PairMemory>,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> QueryStats {
        let places = Places {
            world_from_a: a.world_from_model,
            world_from_b: b.world_from_model,
        };
        with_walkable_pair!(a.pose.posed(), b.pose.posed(), (a, b) => self.walk(&mut a, &mut b, &places, memory, visitor))
    }

    fn walk<V: Volume>(
        &mut self,
        a: &mut impl Walkable<Kind = V>,
        b: &mut impl Walkable<Kind = V>,
        places: &Places<'_>,
        memory: Option<&mut PairMemory>,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> QueryStats {
        let before = [a.blended(), b.blended()];
        let (culls, cross) = places.culls(a, b, self.axes);
        let (front, trace) = match memory {
            Some(memory) => (&memory.front[..], Some(&mut memory.trace)),
            None => (&[][..], None),
        };
        let mut walk = PairWalk {
            a,
            b,
            rule: &Meeting {
                culls: &culls,
                cross: cross.as_ref(),
            },
            a_from_b_scale: places.a_from_b_scale(),
            node_tests: 0,
            trace,
        };
        let (mut triangle_tests, mut undecided_by_filter) = (0, 0);
        let Self {
            stack, leaf_a, leaf_b, ..
        } = self;
        let _stopped_early = walk.run(stack, front, |a, b, of_a, of_b| {
            leaf_a.read(a, places.world_from_a, of_a);
            leaf_b.read(b, places.world_from_b, of_b);
            for (triangle_a, corners_a) in &leaf_a.triangles {
                for (triangle_b, corners_b) in &leaf_b.triangles {
                    triangle_tests += 1;
                    if triangles_intersect_counting(corners_a, corners_b, &mut undecided_by_filter) {
                        visitor(TrianglePair {
                            triangle_a: *triangle_a,
                            triangle_b: *triangle_b,
                        })?;
                    }
                }
            }
            ControlFlow::Continue(())
        });
        let after = [walk.a.blended(), walk.b.blended()];
        QueryStats {
            node_tests: walk.node_tests,
            triangle_tests,
            undecided_by_filter,
            ..QueryStats::blending(before, after)
        }
    }
}

/// Where the two bodies of a query stand.
pub(super) struct Places<'a> {
    pub(super) world_from_a: &'a WorldFromModel,
    pub(super) world_from_b: &'a WorldFromModel,
}

impl Places<'_> {
    pub(super) fn culls<V: Volume>(
        &self,
        a: &mut impl Walkable<Kind = V>,
        b: &mut impl Walkable<Kind = V>,
        axes: SeparatingAxes,
    ) -> (Vec<Cull<V>>, Option<CrossCull>) {
        let (root_a, root_b) = (a.root(), b.root());
        let bounds_a = V::bounds(&a.volume(root_a));
        let bounds_b = V::bounds(&b.volume(root_b));
        let mut culls = Vec::with_capacity(2);
        let mut cross = None;
        for frames in frames_of(self.world_from_a, &bounds_a, self.world_from_b, &bounds_b) {
            culls.extend(Cull::new(&frames));
            if axes == SeparatingAxes::Full && cross.is_none() {
                cross = CrossCull::new(&frames, &bounds_a, &bounds_b);
            }
        }
        (culls, cross)
    }

    pub(super) fn a_from_b_scale(&self) -> f32 {
        (self.world_from_b.scale() / self.world_from_a.scale()) as f32
    }
}

/// The triangles of a leaf in world space, by number.
#[derive(Debug, Default)]
pub(super) struct LeafTriangles {
    numbers: Vec<u32>,
    pub(super) triangles: Vec<(u32, Triangle)>,
}

impl LeafTriangles {
    pub(super) fn read(&mut self, tree: &mut impl Walkable, world_from_model: &WorldFromModel, leaf: Leaf) {
        self.numbers.clear();
        self.numbers.extend_from_slice(tree.topology().leaf_triangles(leaf));
        self.triangles.clear();
        for &triangle in &self.numbers {
            self.triangles
                .push((triangle, world_triangle(tree, world_from_model, triangle)));
        }
    }
}
