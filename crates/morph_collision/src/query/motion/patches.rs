//! Leaves of moving bodies: their vertices at both ends of the motion, and the pairs of features of two leaves that may touch.

use std::cell::Cell;
use std::ops::ControlFlow;

use fearless_simd::Simd;
use glam::DVec3;

use super::Features;
use super::candidate::{Candidate, MovingTriangle};
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

    fn sees(&self, point: &MovingPoint) -> [DVec3; 2] {
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
                let seen = corners.map(|corner| self.observer.sees(&points[usize::from(corner)]));
                let ends = [seen.map(|[start, _]| start), seen.map(|[_, end]| end)];
                eight.set(lane, &ends.map(|corners| around(&corners)));
            }
            boxes.push(eight);
        }
        slot
    }
}

/// The test of a pair of features. It may break.
pub(super) type Test<'t> = dyn FnMut(&Candidate<'_>, &mut QueryStats) -> ControlFlow<()> + 't;

/// Calls `test` for pairs of features of two bodies' leaves that may touch at times up to `latest`, until it breaks.
pub(super) fn candidates(
    (a, leaves_a, owners_a): (&mut Moving<'_, '_>, &mut MovingLeaves, &Owners),
    (b, leaves_b, owners_b): (&mut Moving<'_, '_>, &mut MovingLeaves, &Owners),
    leaves: &[(Leaf, Leaf)],
    (latest, stats): (&Cell<f64>, &mut QueryStats),
    test: &mut Test<'_>,
) -> ControlFlow<()> {
    for &(leaf_a, leaf_b) in leaves {
        let (slot_a, slot_b) = (leaves_a.read(a, leaf_a), leaves_b.read(b, leaf_b));
        let (of_a, of_b) = (leaves_a.placed.get(slot_a), leaves_b.placed.get(slot_b));
        let at_pair = |[place_a, place_b]: [usize; 2], stats: &mut QueryStats| {
            let (t, s) = (
                MovingTriangle::new(a, leaf_a, &of_a.points, place_a, owners_a),
                MovingTriangle::new(b, leaf_b, &of_b.points, place_b, owners_b),
            );
            for (vertex_a, point) in t.own_corners() {
                let features = Features::VertexFace {
                    vertex_a,
                    triangle_b: s.number,
                };
                test(&Candidate::vertex_face(features, point, [&t, &s]), stats)?;
            }
            for (vertex_b, point) in s.own_corners() {
                let features = Features::FaceVertex {
                    triangle_a: t.number,
                    vertex_b,
                };
                test(&Candidate::vertex_face(features, point, [&s, &t]), stats)?;
            }
            for (edge_a, ends_a) in t.own_edges() {
                for (edge_b, ends_b) in s.own_edges() {
                    let features = Features::EdgeEdge { edge_a, edge_b };
                    test(&Candidate::edge_edge(features, [ends_a, ends_b], [&t, &s]), stats)?;
                }
            }
            ControlFlow::Continue(())
        };
        with_simd!(a.ends[0].level, simd => pairs(simd, (of_a, of_b), false, (latest, stats), at_pair))?;
    }
    ControlFlow::Continue(())
}

/// Calls `test` for the triangles of a body's leaves that a ball's box meets at times up to `latest`.
pub(super) fn triangles_at_box(
    (a, leaves_a, owners_a): (&mut Moving<'_, '_>, &mut MovingLeaves, &Owners),
    (b, leaves_b): (&mut Moving<'_, '_>, &mut MovingLeaves),
    leaves: &[(Leaf, Leaf)],
    (latest, stats): (&Cell<f64>, &mut QueryStats),
    test: &mut impl FnMut(&MovingTriangle<'_>, &mut QueryStats),
) {
    for &(leaf_a, leaf_b) in leaves {
        let (slot_a, slot_b) = (leaves_a.read(a, leaf_a), leaves_b.read(b, leaf_b));
        let (of_a, of_b) = (leaves_a.placed.get(slot_a), leaves_b.placed.get(slot_b));
        let at_pair = |[place, _]: [usize; 2], stats: &mut QueryStats| {
            test(&MovingTriangle::new(a, leaf_a, &of_a.points, place, owners_a), stats);
            ControlFlow::Continue(())
        };
        // Never breaks.
        let _ = with_simd!(a.ends[0].level, simd => pairs(simd, (of_a, of_b), false, (latest, stats), at_pair));
    }
}

/// Like [`candidates`], for two leaves of one body, or one leaf with itself. Leaves out features that share a vertex.
pub(super) fn candidates_within(
    (body, placed, owners): (&mut Moving<'_, '_>, &mut MovingLeaves, &Owners),
    [leaf_a, leaf_b]: [Leaf; 2],
    stats: &mut QueryStats,
    test: &mut Test<'_>,
) -> ControlFlow<()> {
    let (slot_a, slot_b) = (placed.read(body, leaf_a), placed.read(body, leaf_b));
    let (of_a, of_b) = (placed.placed.get(slot_a), placed.placed.get(slot_b));
    let at_pair = |[place_a, place_b]: [usize; 2], stats: &mut QueryStats| {
        let t = MovingTriangle::new(body, leaf_a, &of_a.points, place_a, owners);
        let s = MovingTriangle::new(body, leaf_b, &of_b.points, place_b, owners);
        for (own, other) in [(&t, &s), (&s, &t)] {
            for (vertex_a, point) in own.own_corners() {
                if !other.vertices.contains(&vertex_a) {
                    let features = Features::VertexFace {
                        vertex_a,
                        triangle_b: other.number,
                    };
                    test(&Candidate::vertex_face(features, point, [own, other]), stats)?;
                }
            }
        }
        for (edge_a, ends_a) in t.own_edges() {
            for (edge_b, ends_b) in s.own_edges() {
                if edge_a.iter().any(|vertex| edge_b.contains(vertex)) {
                    continue;
                }
                let candidate = if edge_a < edge_b {
                    Candidate::edge_edge(Features::EdgeEdge { edge_a, edge_b }, [ends_a, ends_b], [&t, &s])
                } else {
                    let features = Features::EdgeEdge {
                        edge_a: edge_b,
                        edge_b: edge_a,
                    };
                    Candidate::edge_edge(features, [ends_b, ends_a], [&s, &t])
                };
                test(&candidate, stats)?;
            }
        }
        ControlFlow::Continue(())
    };
    with_simd!(body.ends[0].level, simd => pairs(simd, (of_a, of_b), leaf_a == leaf_b, (&Cell::new(1.0), stats), at_pair))
}

/// Calls `at_pair` for the places of triangles whose boxes meet at times up to `latest`. If the leaves are the same, the first place is the
/// smaller one.
#[inline(always)]
fn pairs<S: Simd>(
    simd: S,
    (a, b): (&MovingLeaf, &MovingLeaf),
    is_same: bool,
    (latest, stats): (&Cell<f64>, &mut QueryStats),
    mut at_pair: impl FnMut([usize; 2], &mut QueryStats) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut enter = [0.0; LANES];
    for place_a in 0..a.triangles {
        let (eight, lane) = (&a.boxes[place_a / LANES], place_a % LANES);
        for (index, others) in b.boxes.iter().enumerate() {
            let rest = b.triangles - index * LANES;
            let mut mask = if rest < LANES { (1 << rest) - 1 } else { u8::MAX };
            stats.triangle_tests += u64::from(mask.count_ones());
            mask &= others.meet(simd, eight, lane, &mut enter);
            for lane in lanes_of(mask) {
                let place_b = index * LANES + lane;
                // False for NaN.
                let is_late = f64::from(enter[lane % LANES]) > latest.get();
                if !is_late && (!is_same || place_a < place_b) {
                    at_pair([place_a, place_b], stats)?;
                }
            }
        }
    }
    ControlFlow::Continue(())
}
