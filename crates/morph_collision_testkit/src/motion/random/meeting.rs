//! Two features that share a point at one time, exactly.

use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::numbers::{between, short, short_vector};
use crate::motion::elementary::{ElementaryMotion, MotionKind};

/// Where the features share a point, and whether they are degenerate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// Inside both.
    Full,
    /// A little outside one of them, so that they may not touch.
    Beside,
    /// At a corner or on an edge of the face; at an end of an edge.
    AtBoundary,
    /// All corners of the face are on a line; the second edge is a point.
    OnLine,
    /// The face is a point; both edges are points.
    Point,
    /// Edges are parallel; faces are [`Shape::Full`].
    Parallel,
}

/// How the shared points move relative to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Approach {
    /// Not at all: the features share this point all the time.
    None,
    /// In any direction.
    Any,
    /// In the plane of the face, or in that of the two edges.
    Tangential,
}

impl Shape {
    /// Inside or a little outside.
    pub(super) fn full(rng: &mut Pcg64Mcg) -> Self {
        if rng.random_bool(0.7) { Self::Full } else { Self::Beside }
    }

    /// One of those with a degenerate feature.
    pub(super) fn flat(rng: &mut Pcg64Mcg) -> Self {
        if rng.random_bool(0.7) {
            Self::OnLine
        } else {
            Self::Point
        }
    }
}

impl Approach {
    pub(super) fn any_kind(rng: &mut Pcg64Mcg) -> Self {
        [Self::None, Self::Any, Self::Any, Self::Tangential][rng.random_range(0..4)]
    }
}

/// Which points of the features meet, and how long degenerate features are.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Barycentric coordinates in the face.
    face: [f64; 3],
    /// Shares of the second end, for both edges.
    edges: [f64; 2],
    /// Length of a feature's second segment, as a multiple of the first.
    ratio: f64,
}

/// Positions and velocities at the time of contact.
#[derive(Clone, Debug)]
pub(super) struct Meeting {
    kind: MotionKind,
    place: Place,
    positions: [DVec3; 4],
    velocities: [DVec3; 4],
    /// The velocity of the vertex relative to the point of the face, or of the second edge's point relative to the first's.
    relative: DVec3,
}

impl Meeting {
    pub(super) fn draw(kind: MotionKind, shape: Shape, approach: Approach, rng: &mut Pcg64Mcg) -> Self {
        let place = Place::draw(shape, rng);
        let positions = place.joined(kind, shape, rng);
        let [a, b, c, d] = positions;
        let relative = match approach {
            Approach::None => DVec3::ZERO,
            Approach::Any => short_vector(rng),
            Approach::Tangential => {
                let plane = match kind {
                    MotionKind::VertexFace => [c - b, d - b],
                    MotionKind::EdgeEdge => [b - a, d - c],
                };
                plane[0] * between(rng) * short(rng).signum() + plane[1] * (short(rng) * 16.0).round()
            }
        };
        Self {
            kind,
            place,
            positions,
            velocities: place.joined(kind, shape, rng),
            relative,
        }
    }

    /// The same positions with other velocities, which need not keep degenerate features degenerate.
    pub(super) fn with_shape_of_velocities(mut self, shape: Shape, rng: &mut Pcg64Mcg) -> Self {
        self.velocities = self.place.joined(self.kind, shape, rng);
        self
    }

    /// Moves everything by a random vector and turns and scales it, with rounding.
    pub(super) fn with_random_digits(mut self, rng: &mut Pcg64Mcg) -> Self {
        let mut any = || DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let columns = [any(), any(), any()];
        let turned = |v: DVec3| columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
        let (offset, drift) = (any(), any());
        self.positions = self.positions.map(|p| turned(p) + offset);
        self.velocities = self.velocities.map(|v| turned(v) + drift);
        self.relative = turned(self.relative);
        self
    }

    /// The motion with the contact at this time.
    pub(super) fn motion(&self, time: f64) -> ElementaryMotion {
        let points = std::array::from_fn(|point| {
            let moves = match self.kind {
                MotionKind::VertexFace => point == 0,
                MotionKind::EdgeEdge => point >= 2,
            };
            let relative = if moves { self.relative } else { DVec3::ZERO };
            let (position, velocity) = (self.positions[point], self.velocities[point] + relative);
            let (start, end) = (position - velocity * time, position + velocity * (1.0 - time));
            [start.to_array(), end.to_array()]
        });
        ElementaryMotion {
            kind: self.kind,
            points,
        }
    }
}

impl Place {
    fn draw(shape: Shape, rng: &mut Pcg64Mcg) -> Self {
        let (mut face, mut edges) = ([0.0; 3], [between(rng), between(rng)]);
        if shape == Shape::AtBoundary {
            let corner = rng.random_range(0..3_usize);
            face[corner] = if rng.random_bool(0.4) { 1.0 } else { between(rng) };
            face[(corner + 1) % 3] = 1.0 - face[corner];
            let end = |rng: &mut Pcg64Mcg| f64::from(rng.random_range(0..2));
            edges[0] = end(rng);
            if rng.random_bool(0.4) {
                edges[1] = end(rng);
            }
        } else {
            let first = rng.random_range(1..15);
            let second = rng.random_range(1..16 - first);
            face = [first, second, 16 - first - second].map(|part| f64::from(part) / 16.0);
        }
        if shape == Shape::Beside {
            let corner = rng.random_range(0..3_usize);
            let change = face[corner] + 1.0 / 16.0;
            face[corner] -= change;
            face[(corner + 1) % 3] += change;
            edges[rng.random_range(0..2_usize)] = if rng.random_bool(0.5) { -1.0 / 16.0 } else { 17.0 / 16.0 };
        }
        let ratio = f64::from(rng.random_range(-4..7)) / 2.0;
        Self { face, edges, ratio }
    }

    /// Four vectors, such that the shared point of both features is the same.
    fn joined(&self, kind: MotionKind, shape: Shape, rng: &mut Pcg64Mcg) -> [DVec3; 4] {
        let first = short_vector(rng);
        let segment = if shape == Shape::Point {
            DVec3::ZERO
        } else {
            short_vector(rng)
        };
        let other = match shape {
            Shape::OnLine | Shape::Point => segment * self.ratio,
            _ => short_vector(rng),
        };
        match kind {
            MotionKind::VertexFace => {
                let corners = [first, first + segment, first + other];
                let [u, v, w] = self.face;
                [
                    corners[0] * u + corners[1] * v + corners[2] * w,
                    corners[0],
                    corners[1],
                    corners[2],
                ]
            }
            MotionKind::EdgeEdge => {
                let other = match shape {
                    Shape::OnLine | Shape::Point => DVec3::ZERO,
                    Shape::Parallel => segment * self.ratio,
                    Shape::Full | Shape::Beside | Shape::AtBoundary => other,
                };
                let [s, u] = self.edges;
                let shared = first + segment * s;
                [first, first + segment, shared - other * u, shared + other * (1.0 - u)]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::motion::first_contact;

    #[test]
    fn features_touch_at_the_time_of_their_meeting() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut exactly_then = 0;
        for index in 0..600 {
            let kind = MotionKind::ALL[index % 2];
            let shapes = [
                Shape::Full,
                Shape::AtBoundary,
                Shape::OnLine,
                Shape::Point,
                Shape::Parallel,
            ];
            let approaches = [Approach::None, Approach::Any, Approach::Tangential];
            let (shape, approach) = (shapes[index % 5], approaches[index % 3]);
            let time = f64::from(rng.random_range(0..17)) / 16.0;
            let motion = Meeting::draw(kind, shape, approach, &mut rng).motion(time);
            let first = first_contact(&motion).unwrap_or_else(|| panic!("{shape:?} {approach:?}: {motion:?}"));
            let expected = if approach == Approach::None { 0.0 } else { time };
            assert!(first.cmp_f64(expected).is_le(), "{shape:?} {approach:?}: {motion:?}");
            exactly_then += usize::from(approach != Approach::None && first.cmp_f64(time).is_eq());
        }
        assert!(exactly_then > 250, "{exactly_then}");
    }
}
