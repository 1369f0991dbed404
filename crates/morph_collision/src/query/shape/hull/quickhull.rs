//! The faces of a convex hull, by Quickhull (Barber, Dobkin and Huhdanpaa 1996) with exact signs.
//!
//! A face sees the points strictly above its plane. That is decided exactly, so points in one plane or on one line are no special case: a
//! point beside a face in its plane is seen by a neighbour of the face, and no face is without area.

use std::cmp::Ordering;
use std::mem;

use glam::DVec3;

use crate::exact::{plane_side, unit_normal};

/// Why there is no hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Failure {
    Flat,
    TooManyCorners,
}

/// A face, and the points above it that no other face has.
struct Face {
    corners: [u32; 3],
    above: Vec<u32>,
}

struct Hull<'a> {
    points: &'a [DVec3],
    /// Anticlockwise seen from outside.
    faces: Vec<Face>,
}

/// Returns the faces of the hull, anticlockwise seen from outside.
pub(super) fn quickhull(points: &[DVec3], max_corners: usize) -> Result<Vec<[u32; 3]>, Failure> {
    // A polyhedron of triangles has twice as many faces as corners, less four.
    let max_faces = 2 * max_corners - 4;
    let mut hull = Hull::of_tetrahedron(points)?;
    // Each step adds a corner; it may vanish inside later.
    let mut steps = 0;
    while let Some(corner) = hull.next_corner() {
        hull.add(corner);
        steps += 1;
        if steps > 2 * max_corners || hull.faces.len() > max_faces {
            return Err(Failure::TooManyCorners);
        }
    }
    Ok(hull.faces.into_iter().map(|face| face.corners).collect())
}

impl<'a> Hull<'a> {
    fn of_tetrahedron(points: &'a [DVec3]) -> Result<Self, Failure> {
        let [a, b, c, d] = tetrahedron(points).ok_or(Failure::Flat)?;
        let faces = [[a, b, c], [a, d, b], [b, d, c], [c, d, a]];
        let mut hull = Self {
            points,
            faces: faces.map(Face::new).into(),
        };
        if hull.sees(faces[0], d) {
            hull.faces.iter_mut().for_each(|face| face.corners.swap(1, 2));
        }
        hull.assign(0, (0..points.len() as u32).collect());
        Ok(hull)
    }

    fn sees(&self, [a, b, c]: [u32; 3], point: u32) -> bool {
        let at = |corner: u32| self.points[corner as usize];
        // The sign of a point below an anticlockwise triangle is positive.
        plane_side(at(a), at(b), at(c), at(point)) == Ordering::Less
    }

    /// Of the points above some face, the one that is farthest from it. Among equal ones, the last by its coordinates is a corner.
    fn next_corner(&self) -> Option<u32> {
        let face = self.faces.iter().find(|face| !face.above.is_empty())?;
        let [a, b, c] = face.corners.map(|corner| self.points[corner as usize]);
        let normal = unit_normal(&[a, b, c]);
        let height = |point: u32| normal.dot(self.points[point as usize] - a);
        let above = face.above.iter().copied();
        above.max_by(|&p, &q| {
            let by_place = || by_coordinates(self.points[p as usize], self.points[q as usize]);
            height(p).total_cmp(&height(q)).then_with(by_place)
        })
    }

    /// Replaces all faces that see a point by faces from the border of what it sees to the point.
    fn add(&mut self, point: u32) {
        let (seen, kept) = mem::take(&mut self.faces)
            .into_iter()
            .partition::<Vec<_>, _>(|face| self.sees(face.corners, point));
        let edges = |face: &Face| {
            let [a, b, c] = face.corners;
            [(a, b), (b, c), (c, a)]
        };
        let mut inner: Vec<_> = seen.iter().flat_map(edges).collect();
        inner.sort_unstable();
        let border = inner.iter().filter(|(p, q)| inner.binary_search(&(*q, *p)).is_err());
        let first_new = kept.len();
        self.faces = kept;
        self.faces.extend(border.map(|&(p, q)| Face::new([p, q, point])));
        self.assign(first_new, seen.into_iter().flat_map(|face| face.above).collect());
    }

    /// Gives each point to the first face from a number on that sees it. The others are inside: a point that a replaced face saw, and that
    /// is still outside, is seen by a new one.
    fn assign(&mut self, from: usize, points: Vec<u32>) {
        for point in points {
            let seer = (from..self.faces.len()).find(|&face| self.sees(self.faces[face].corners, point));
            if let Some(seer) = seer {
                self.faces[seer].above.push(point);
            }
        }
    }
}

impl Face {
    fn new(corners: [u32; 3]) -> Self {
        Self {
            corners,
            above: Vec::new(),
        }
    }
}

fn by_coordinates(p: DVec3, q: DVec3) -> Ordering {
    let each = p.to_array().into_iter().zip(q.to_array());
    each.fold(Ordering::Equal, |order, (p, q)| order.then(p.total_cmp(&q)))
}

/// Four points that span a volume, far apart.
fn tetrahedron(points: &[DVec3]) -> Option<[u32; 4]> {
    let farthest = |measure: &dyn Fn(DVec3) -> f64| {
        let all = (0..points.len()).map(|index| (measure(points[index]), points[index], index as u32));
        let last = all.max_by(|(p, at_p, _), (q, at_q, _)| p.total_cmp(q).then_with(|| by_coordinates(*at_p, *at_q)));
        last.map(|(_, point, index)| (index, point))
    };
    let (a, at_a) = farthest(&|p| p.x)?;
    let (b, at_b) = farthest(&|p| p.distance_squared(at_a))?;
    // A triangle with an area has a plane, which holds at most three of these.
    let beside_a_plane = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let is_on_line = |p: DVec3| {
        let mut sides = beside_a_plane.iter().map(|q| plane_side(at_a, at_b, p, *q));
        sides.all(|side| side == Ordering::Equal)
    };
    let (c, at_c) = farthest(&|p| {
        if is_on_line(p) {
            -1.0
        } else {
            (at_b - at_a).cross(p - at_a).length_squared()
        }
    })?;
    let normal = unit_normal(&[at_a, at_b, at_c]);
    let is_beside = |p: DVec3| plane_side(at_a, at_b, at_c, p) != Ordering::Equal;
    let (d, at_d) = farthest(&|p| {
        if is_beside(p) { normal.dot(p - at_a).abs() } else { -1.0 }
    })?;
    is_beside(at_d).then_some([a, b, c, d])
}
