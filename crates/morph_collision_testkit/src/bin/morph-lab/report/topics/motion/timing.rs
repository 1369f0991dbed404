//! Times, and the library's tests of recorded motions.

use std::hint::black_box;

use glam::DVec3;
use morph_collision::motion::{
    MovingPoint, StageCounts, TimeOfImpact, edge_edge_impact_counting, edge_edge_touch_counting,
    vertex_face_impact_counting, vertex_face_touch_counting,
};
use morph_collision_testkit::bench::{Stopwatch, median};
use morph_collision_testkit::motion::{ElementaryMotion, MotionKind};

/// Of the times of impact.
pub(super) const TOLERANCE: f64 = 1e-6;

/// The median over the rounds of the seconds that `work` takes. A first round fills caches and does not count. Only `work` is
/// measured, `prepare` runs before it.
pub(super) fn median_seconds<T, R>(rounds: usize, mut prepare: impl FnMut() -> T, mut work: impl FnMut(T) -> R) -> f64 {
    let times: Vec<f64> = (0..=rounds)
        .map(|_| {
            let prepared = prepare();
            let watch = Stopwatch::start();
            black_box(work(prepared));
            watch.elapsed().as_secs_f64()
        })
        .collect();
    median(times.into_iter().skip(1))
}

/// A recorded motion as the library takes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Features {
    pub(super) kind: MotionKind,
    corners: [MovingPoint; 4],
}

impl Features {
    pub(super) fn new(motion: &ElementaryMotion) -> Self {
        let point = |ends: [[f64; 3]; 2]| {
            let [start, end] = ends.map(DVec3::from_array);
            MovingPoint::new(start, end)
        };
        Self {
            kind: motion.kind,
            corners: motion.points.map(point),
        }
    }

    pub(super) fn touch(&self, stages: &mut StageCounts) -> bool {
        let [a, b, c, d] = self.corners;
        match self.kind {
            MotionKind::VertexFace => vertex_face_touch_counting(a, [b, c, d], stages),
            MotionKind::EdgeEdge => edge_edge_touch_counting([a, b], [c, d], stages),
        }
    }

    pub(super) fn impact(&self, stages: &mut StageCounts) -> Option<TimeOfImpact> {
        let [a, b, c, d] = self.corners;
        match self.kind {
            MotionKind::VertexFace => vertex_face_impact_counting(a, [b, c, d], TOLERANCE, stages),
            MotionKind::EdgeEdge => edge_edge_impact_counting([a, b], [c, d], TOLERANCE, stages),
        }
    }
}
