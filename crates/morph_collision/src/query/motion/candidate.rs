//! Pairs of features that may touch, and their tests.

use glam::DVec3;

use super::{Features, MotionContact};
use crate::bounds::{WorldFromModel, lanes_of};
use crate::exact::motion::{FeaturePair, Kind, MovingPoint, StageCounts};
use crate::exact::unit_normal;
use crate::query::QueryStats;
use crate::traverse::Moving;
use crate::tree::{Leaf, Owners};

/// A triangle of a leaf.
#[derive(Clone, Copy)]
pub(super) struct MovingTriangle<'a> {
    pub(super) number: u32,
    /// The numbers of its corners in the mesh, and where they are.
    pub(super) vertices: [u32; 3],
    points: [MovingPoint; 3],
    owners: &'a Owners,
    /// The placement at the start.
    place: &'a WorldFromModel,
}

impl<'a> MovingTriangle<'a> {
    /// The triangle at a place of a leaf, whose vertices are at these points.
    pub(super) fn new(
        tree: &Moving<'_, 'a>,
        leaf: Leaf,
        points: &[MovingPoint],
        place: usize,
        owners: &'a Owners,
    ) -> Self {
        let start = &tree.ends[0];
        let mesh = start.topology.leaf_mesh(leaf);
        let corners = mesh.corners[place];
        Self {
            number: start.topology.leaf_triangles(leaf)[place],
            vertices: corners.map(|corner| mesh.vertices[usize::from(corner)]),
            points: corners.map(|corner| points[usize::from(corner)]),
            owners,
            place: start.place,
        }
    }

    pub(super) fn own_corners(&self) -> impl Iterator<Item = (u32, MovingPoint)> + use<'_, 'a> {
        let corners = lanes_of(self.owners.corners(self.number));
        corners.map(|corner| (self.vertices[corner % 3], self.points[corner % 3]))
    }

    pub(super) fn own_edges(&self) -> impl Iterator<Item = ([u32; 2], [MovingPoint; 2])> + use<'_, 'a> {
        lanes_of(self.owners.edges(self.number)).map(|edge| {
            let (from, to) = (edge % 3, (edge + 1) % 3);
            let (a, b) = (self.vertices[from], self.vertices[to]);
            let points = [self.points[from], self.points[to]];
            // Ascending, so that no answer depends on which triangle owns the edge.
            if a < b {
                ([a, b], points)
            } else {
                ([b, a], [points[1], points[0]])
            }
        })
    }

    pub(super) fn points(&self) -> &[MovingPoint; 3] {
        &self.points
    }

    /// The unit normal out of the body at a time.
    pub(super) fn outward(&self, time: f64) -> DVec3 {
        let normal = unit_normal(&self.points.map(|point| point.at(time)));
        if self.place.mirrors() { -normal } else { normal }
    }
}

/// A pair of features that may touch.
pub(super) struct Candidate<'t> {
    pub(super) features: Features,
    pub(super) pair: FeaturePair,
    /// The triangles that the features are of, in the order of `pair`.
    triangles: [&'t MovingTriangle<'t>; 2],
}

impl<'t> Candidate<'t> {
    /// A vertex of one triangle, and another triangle.
    pub(super) fn vertex_face(
        features: Features,
        vertex: MovingPoint,
        [of_vertex, face]: [&'t MovingTriangle<'t>; 2],
    ) -> Self {
        let [a, b, c] = face.points;
        Self {
            features,
            pair: FeaturePair {
                kind: Kind::VertexFace,
                corners: [vertex, a, b, c],
            },
            triangles: [of_vertex, face],
        }
    }

    /// An edge of one triangle, and one of another.
    pub(super) fn edge_edge(
        features: Features,
        [[a, b], [c, d]]: [[MovingPoint; 2]; 2],
        triangles: [&'t MovingTriangle<'t>; 2],
    ) -> Self {
        Self {
            features,
            pair: FeaturePair {
                kind: Kind::EdgeEdge,
                corners: [a, b, c, d],
            },
            triangles,
        }
    }

    pub(super) fn touches(&self, stats: &mut QueryStats) -> bool {
        counted(stats, |stages| self.pair.touch(stages))
    }

    pub(super) fn impact(&self, tolerance: f64, stats: &mut QueryStats) -> Option<MotionContact> {
        let time = counted(stats, |stages| self.pair.impact(tolerance, stages));
        time.map(|time| MotionContact::new(self, time))
    }

    /// A direction out of the second feature's body and into the first's.
    pub(super) fn outward(&self, time: f64) -> DVec3 {
        let [first, second] = self.triangles;
        match self.pair.kind {
            Kind::VertexFace => second.outward(time),
            Kind::EdgeEdge => second.outward(time) - first.outward(time),
        }
    }
}

fn counted<T>(stats: &mut QueryStats, test: impl FnOnce(&mut StageCounts) -> T) -> T {
    let mut stages = StageCounts::default();
    let answer = test(&mut stages);
    stats.feature_tests += stages.total();
    stats.undecided_by_filter += stages.exact;
    answer
}
