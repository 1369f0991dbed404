//! Leaves of moving bodies: their vertices at both ends of the motion, and the pairs of triangles of two leaves that may touch.

use std::cell::Cell;
use std::ops::ControlFlow;

use fearless_simd::Simd;
use glam::DVec3;

use super::limit::Limit;
use super::triangle::MovingTriangle;
use crate::bounds::{Aabb, Extent, LANES, MovingLanes, lanes_of, with_simd};
use crate::exact::motion::MovingPoint;
use crate::exact::{power_of_two, power_of_two_below};
use crate::pose::EpochCache;
use crate::query::QueryStats;
use crate::traverse::Moving;
use crate::tree::{Leaf, Owners};

/// Where leaves are seen from: near both bodies, in units of their size, and moving along with them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Observer {
    /// The origin at the start and at the end, in units.
    origin: [DVec3; 2],
    /// The number of units in a length of 1: a power of two.
    scale: f64,
}

impl Observer {
    /// An observer at `origin`, who moves by `drift`, of bodies of about this size.
    pub(super) fn new(origin: DVec3, drift: DVec3, size: f64) -> Self {
        let size = if size.is_normal() { size } else { 1.0 };
        // Clamped so that no product with a coordinate overflows.
        let scale = power_of_two_below(size)
            .clamp(power_of_two(-400), power_of_two(400))
            .recip();
        Self {
            origin: [origin, origin + drift].map(|origin| origin * scale),
            scale,
        }
    }

    fn relative(&self, point: &MovingPoint) -> [DVec3; 2] {
        let [start, end] = self.origin;
        [point.start * self.scale - start, point.end * self.scale - end]
    }
}

/// A box around three corners relative to the observer, which are rounded once.
fn around(corners: &[DVec3; 3]) -> Aabb {
    let Extent { min, max } = Extent::of_triangle(corners);
    // One rounding of a difference. Twice that, because this one is rounded, too; and for subnormal numbers.
    let error = |end: DVec3| end.abs() * (2.0 * f64::EPSILON) + DVec3::splat(1e-300);
    let wider = Extent {
        min: min - error(min),
        max: max + error(max),
    };
    wider.outward()
}

/// The leaves of one body that a query has looked at. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct MovingLeaves {
    observer: Observer,
    /// Indexed by leaf.
    placed: EpochCache<MovingLeaf>,
}

/// A leaf, placed in the world.
#[derive(Clone, Debug, Default)]
struct MovingLeaf {
    /// The leaf's distinct vertices.
    points: Vec<MovingPoint>,
    /// The boxes of its triangles, in eights.
    boxes: Vec<MovingLanes>,
    triangles: usize,
}

impl MovingLeaves {
    /// Starts a query: discards everything.
    pub(super) fn begin(&mut self, observer: Observer) {
        self.observer = observer;
        self.placed.next_epoch();
    }

    fn read(&mut self, tree: &mut Moving<'_, '_>, leaf: Leaf) -> usize {
        match self.placed.find(leaf.0) {
            Some(slot) => slot,
            None => self.place(tree, leaf),
        }
    }

    #[inline(never)]
    fn place(&mut self, tree: &mut Moving<'_, '_>, leaf: Leaf) -> usize {
        let slot = self.placed.claim(leaf.0);
        let MovingLeaf {
            points,
            boxes,
            triangles,
        } = self.placed.get_mut(slot);
        let [start, end] = &mut tree.ends;
        let mesh = start.topology.leaf_mesh(leaf);
        points.clear();
        points.extend(mesh.vertices.iter().map(|&vertex| MovingPoint {
            start: start.world_vertex(vertex),
            end: end.world_vertex(vertex),
        }));
        *triangles = mesh.corners.len();
        boxes.clear();
        for corners in mesh.corners.chunks(LANES) {
            let mut eight = MovingLanes::default();
            for (lane, corners) in corners.iter().enumerate() {
                let relative = corners.map(|corner| self.observer.relative(&points[usize::from(corner)]));
                let ends = [relative.map(|[start, _]| start), relative.map(|[_, end]| end)];
                eight.set(lane, &ends.map(|corners| around(&corners)));
            }
            boxes.push(eight);
        }
        slot
    }
}

/// The callback for pairs of triangles that may touch.
pub(super) type AtTriangles<'v> =
    dyn FnMut(&MovingTriangle<'_>, &MovingTriangle<'_>, &mut QueryStats) -> ControlFlow<()> + 'v;

/// One body of a walk.
pub(super) struct Side<'s, 'm, 'p> {
    pub(super) body: &'s mut Moving<'m, 'p>,
    pub(super) leaves: &'s mut MovingLeaves,
    /// Which triangle stands for each vertex and edge.
    pub(super) owners: &'s Owners,
}

/// Calls `at_triangles` for pairs of triangles of two bodies' leaves that may touch at times up to `latest`, until it breaks or the limit is
/// reached.
pub(super) fn triangles_of_both(
    a: Side<'_, '_, '_>,
    b: Side<'_, '_, '_>,
    leaves: &[(Leaf, Leaf)],
    latest: &Cell<f64>,
    limit: &Limit,
    stats: &mut QueryStats,
    at_triangles: &mut AtTriangles<'_>,
) -> ControlFlow<()> {
    for &(leaf_a, leaf_b) in leaves {
        let (slot_a, slot_b) = (a.leaves.read(a.body, leaf_a), b.leaves.read(b.body, leaf_b));
        let (of_a, of_b) = (a.leaves.placed.get(slot_a), b.leaves.placed.get(slot_b));
        let at_pair = |[index_a, index_b]: [usize; 2], stats: &mut QueryStats| {
            let t = MovingTriangle::of_leaf(a.body, leaf_a, &of_a.points, index_a, a.owners);
            let s = MovingTriangle::of_leaf(b.body, leaf_b, &of_b.points, index_b, b.owners);
            // These boxes are tighter.
            if t.first_overlap(&s) > latest.get() {
                return ControlFlow::Continue(());
            }
            at_triangles(&t, &s, stats)
        };
        with_simd!(a.body.ends[0].level, simd => pairs(simd, of_a, of_b, false, latest, stats, at_pair))?;
        limit.check(stats)?;
    }
    ControlFlow::Continue(())
}

/// Like [`triangles_of_both`], for two leaves of one body, or one leaf with itself.
pub(super) fn triangles_of_one(
    side: Side<'_, '_, '_>,
    [leaf_a, leaf_b]: [Leaf; 2],
    stats: &mut QueryStats,
    at_triangles: &mut AtTriangles<'_>,
) -> ControlFlow<()> {
    let Side { body, leaves, owners } = side;
    let (slot_a, slot_b) = (leaves.read(body, leaf_a), leaves.read(body, leaf_b));
    let (of_a, of_b) = (leaves.placed.get(slot_a), leaves.placed.get(slot_b));
    let at_pair = |[index_a, index_b]: [usize; 2], stats: &mut QueryStats| {
        let t = MovingTriangle::of_leaf(body, leaf_a, &of_a.points, index_a, owners);
        let s = MovingTriangle::of_leaf(body, leaf_b, &of_b.points, index_b, owners);
        at_triangles(&t, &s, stats)
    };
    let (is_same, always) = (leaf_a == leaf_b, Cell::new(1.0));
    with_simd!(body.ends[0].level, simd => pairs(simd, of_a, of_b, is_same, &always, stats, at_pair))
}

/// Calls `at_pair` for the indices of triangles whose boxes meet at times up to `latest`. If the leaves are the same, the first index is the
/// smaller one.
#[inline(always)]
fn pairs<S: Simd>(
    simd: S,
    a: &MovingLeaf,
    b: &MovingLeaf,
    is_same: bool,
    latest: &Cell<f64>,
    stats: &mut QueryStats,
    mut at_pair: impl FnMut([usize; 2], &mut QueryStats) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut enter = [0.0; LANES];
    for index_a in 0..a.triangles {
        let (eight, lane) = (&a.boxes[index_a / LANES], index_a % LANES);
        for (block, others) in b.boxes.iter().enumerate() {
            let rest = b.triangles - block * LANES;
            let mut mask = if rest < LANES { (1 << rest) - 1 } else { u8::MAX };
            stats.triangle_tests += u64::from(mask.count_ones());
            mask &= others.meet(simd, eight, lane, &mut enter);
            for lane in lanes_of(mask) {
                let index_b = block * LANES + lane;
                // False for NaN.
                let is_late = f64::from(enter[lane % LANES]) > latest.get();
                if !is_late && (!is_same || index_a < index_b) {
                    at_pair([index_a, index_b], stats)?;
                }
            }
        }
    }
    ControlFlow::Continue(())
}
