//! Motions in a plane, and parallel edges.

use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::meeting::{Approach, Meeting, Shape};
use super::numbers::{short_vector, whole_vector};
use crate::motion::elementary::{ElementaryMotion, MotionKind};

/// Parallel edges that meet, at that time or all the time; a vertex that moves along a face's plane.
pub(super) fn parallel(kind: MotionKind, time: f64, rng: &mut Pcg64Mcg) -> ElementaryMotion {
    let approach = Approach::any_kind(rng);
    match kind {
        MotionKind::EdgeEdge => {
            let meeting = Meeting::draw(kind, Shape::Parallel, approach, rng);
            if rng.random_bool(0.5) {
                return meeting.motion(time);
            }
            meeting.with_shape_of_velocities(Shape::Full, rng).motion(time)
        }
        MotionKind::VertexFace => {
            // The face moves as one, and the vertex moves along one of its edges, or beside it.
            let corners: [DVec3; 3] = std::array::from_fn(|_| short_vector(rng));
            let part = |rng: &mut Pcg64Mcg| f64::from(rng.random_range(-4..13)) / 8.0;
            let along = corners[1] - corners[0];
            let height = if rng.random_bool(0.5) { 0.0 } else { part(rng) };
            let beside = corners[0] + (corners[2] - corners[0]) * height;
            let drift = short_vector(rng);
            let [from, to] = [part(rng), part(rng)].map(|part| beside + along * part);
            let moved = |p: DVec3| [p.to_array(), (p + drift).to_array()];
            let [a, b, c] = corners.map(moved);
            let vertex = [from.to_array(), (to + drift).to_array()];
            ElementaryMotion {
                kind,
                points: [vertex, a, b, c],
            }
        }
    }
}

/// Four points that are in one plane all the time: a fixed plane in which they move anyhow, or a plane that moves and turns with
/// them, or turns about a line.
pub(super) fn coplanar(kind: MotionKind, rng: &mut Pcg64Mcg) -> ElementaryMotion {
    let mut frame = || [(); 3].map(|()| whole_vector(9, rng));
    let [first, second] = [frame(), frame()];
    let mut numbers = || [(); 4].map(|()| [(); 2].map(|()| f64::from(rng.random_range(-4..5))));
    let [start, end] = [numbers(), numbers()];
    let at = |[u, v, origin]: [DVec3; 3], [x, y]: [f64; 2]| ((origin + u * x + v * y) / 16.0).to_array();
    let points = match rng.random_range(0..3) {
        // The same plane, or parallel ones.
        0 => {
            let [u, v, _] = first;
            std::array::from_fn(|i| [at(first, start[i]), at([u, v, second[2]], end[i])])
        }
        // The points stay where they are in the plane, which moves.
        1 => std::array::from_fn(|i| [at(first, start[i]), at(second, start[i])]),
        // A coordinate plane.
        _ => {
            let flat = |[x, y]: [f64; 2]| [x, y, 1.0];
            std::array::from_fn(|i| [flat(start[i]), flat(end[i])])
        }
    };
    ElementaryMotion { kind, points }
}
