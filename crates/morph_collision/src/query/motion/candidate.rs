//! Pairs of features that may touch, and their tests.

use std::ops::ControlFlow;

use glam::DVec3;

use super::contact::{Features, MotionContact};
use super::triangle::MovingTriangle;

use crate::exact::motion::{FeaturePair, Kind, MovingPoint, StageCounts, TimeOfImpact, impact_geometry};
use crate::query::{QueryStats, TrianglePair};

/// The callback for pairs of features that may touch.
pub(super) type Test<'t> = dyn FnMut(&Candidate<'_>, &mut QueryStats) -> ControlFlow<()> + 't;

/// Calls `test` for all pairs of features for which two triangles of two bodies stand, until it breaks.
pub(super) fn between(
    t: &MovingTriangle<'_>,
    s: &MovingTriangle<'_>,
    stats: &mut QueryStats,
    test: &mut Test<'_>,
) -> ControlFlow<()> {
    if t.is_point || !s.is_point {
        for (vertex_a, point) in t.own_corners() {
            let features = Features::VertexFace {
                vertex_a,
                triangle_b: s.number,
            };
            test(&Candidate::vertex_face(features, point, [t, s]), stats)?;
        }
    }
    if !t.is_point {
        for (vertex_b, point) in s.own_corners() {
            let features = Features::FaceVertex {
                triangle_a: t.number,
                vertex_b,
            };
            test(&Candidate::vertex_face(features, point, [s, t]), stats)?;
        }
    }
    for (edge_a, ends_a) in t.own_edges() {
        for (edge_b, ends_b) in s.own_edges() {
            let features = Features::EdgeEdge { edge_a, edge_b };
            test(&Candidate::edge_edge(features, [ends_a, ends_b], [t, s]), stats)?;
        }
    }
    ControlFlow::Continue(())
}

/// Like [`between`], for two triangles of one body. Leaves out features that share a vertex.
pub(super) fn within(
    t: &MovingTriangle<'_>,
    s: &MovingTriangle<'_>,
    stats: &mut QueryStats,
    test: &mut Test<'_>,
) -> ControlFlow<()> {
    for (own, other) in [(t, s), (s, t)] {
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
                Candidate::edge_edge(Features::EdgeEdge { edge_a, edge_b }, [ends_a, ends_b], [t, s])
            } else {
                let features = Features::EdgeEdge {
                    edge_a: edge_b,
                    edge_b: edge_a,
                };
                Candidate::edge_edge(features, [ends_b, ends_a], [s, t])
            };
            test(&candidate, stats)?;
        }
    }
    ControlFlow::Continue(())
}

/// A pair of features that may touch.
pub(super) struct Candidate<'t> {
    features: Features,
    pair: FeaturePair,
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

    /// For two edges, the pairs of a corner of one triangle and the other triangle.
    pub(super) fn corners(&self) -> impl Iterator<Item = Candidate<'t>> {
        let [a, b] = self.triangles;
        let of_edges = matches!(self.pair.kind, Kind::EdgeEdge);
        let of_both = [(a, b, true), (b, a, false)].into_iter().filter(move |_| of_edges);
        of_both.flat_map(|(own, other, is_first)| {
            own.vertices.into_iter().zip(own.points).map(move |(vertex, point)| {
                let features = if is_first {
                    Features::VertexFace {
                        vertex_a: vertex,
                        triangle_b: other.number,
                    }
                } else {
                    Features::FaceVertex {
                        triangle_a: other.number,
                        vertex_b: vertex,
                    }
                };
                Candidate::vertex_face(features, point, [own, other])
            })
        })
    }

    pub(super) fn touches(&self, stats: &mut QueryStats) -> bool {
        counted(stats, |stages| self.pair.touch(stages))
    }

    pub(super) fn impact(&self, tolerance: f64, stats: &mut QueryStats) -> Option<MotionContact> {
        let time = counted(stats, |stages| self.pair.impact(tolerance, stages));
        time.map(|time| self.contact(time))
    }

    /// The contact of these features, which begins at this time.
    fn contact(&self, time: TimeOfImpact) -> MotionContact {
        let outward = self.outward(time.earliest.midpoint(time.latest));
        let found = impact_geometry(&self.pair, time, outward);
        let [a, b] = found.barycentrics;
        let [first, second] = self.triangles.map(|triangle| triangle.number);
        // The vertex is the first of the pair.
        let (side, barycentrics, [triangle_a, triangle_b]) = match self.features {
            Features::FaceVertex { .. } => (-1.0, [b, a], [second, first]),
            _ => (1.0, [a, b], [first, second]),
        };
        MotionContact {
            features: self.features,
            triangles: TrianglePair { triangle_a, triangle_b },
            time,
            point: found.point,
            normal: found.normal * side,
            velocity: found.velocity * side,
            barycentrics,
        }
    }

    /// A direction out of the second feature's body and into the first's.
    fn outward(&self, time: f64) -> DVec3 {
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
    stats.feature_tests_at_ends += stages.at_ends;
    stats.exact_feature_tests += stages.exact;
    stats.exact_bits += stages.exact_bits;
    answer
}
