//! The library's answers.

use glam::DVec3;
use morph_collision::motion::{
    MovingPoint, TimeOfImpact, edge_edge_impact, edge_edge_touch, vertex_face_impact, vertex_face_touch,
};
use morph_collision_testkit::motion::{ElementaryMotion, MotionKind};

/// Whether the features touch.
pub(super) fn touches(motion: &ElementaryMotion) -> bool {
    let [a, b, c, d] = points(motion);
    match motion.kind {
        MotionKind::VertexFace => vertex_face_touch(a, [b, c, d]),
        MotionKind::EdgeEdge => edge_edge_touch([a, b], [c, d]),
    }
}

/// An interval that holds the first time of contact, if they touch.
pub(super) fn impact(motion: &ElementaryMotion, tolerance: f64) -> Option<[f64; 2]> {
    let [a, b, c, d] = points(motion);
    let time = match motion.kind {
        MotionKind::VertexFace => vertex_face_impact(a, [b, c, d], tolerance),
        MotionKind::EdgeEdge => edge_edge_impact([a, b], [c, d], tolerance),
    };
    time.map(|TimeOfImpact { earliest, latest }| [earliest, latest])
}

fn points(motion: &ElementaryMotion) -> [MovingPoint; 4] {
    motion.points.map(|motion| {
        let [start, end] = motion.map(DVec3::from_array);
        MovingPoint { start, end }
    })
}
