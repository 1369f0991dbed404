use std::cmp::Ordering::{self, Equal};

use glam::DVec3;

use super::between::closest_between;
use super::closest::closest_on_triangle;
use super::nearest::{closest_of_segment_and_triangle, edges, lerp, unit_normal};
use super::predicates::{Projection, line_crossing, line_height, line_side, plane_crossing, plane_height, plane_side};
use super::segment::{Segment, all_on_one_side, flat_segments_cross, lexicographic, segments_intersect, sorted};
use super::triangle::{Triangle, hull_of_line, projection_of, sides, strictly_one_side, triangles_intersect};

/// Where two intersecting triangles meet.
///
/// That they meet, and which edges pierce which triangle, is decided exactly; coordinates are `f64`. The ends lie on both
/// triangles but for about `1e-13` times the larger one's size and a few roundings of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleContact {
    /// The two points common to both triangles that are farthest apart, in lexicographic order.
    ///
    /// Of two triangles that cross, the ends of their line of intersection; the same point twice, up to rounding, where they
    /// touch in one; a longest diagonal of the common area of two coplanar triangles.
    pub segment: [DVec3; 2],
    /// The direction in which the first triangle leaves the second: the unit vector along `n_b - n_a`, with the unit
    /// normals `n_a`, `n_b` of triangles whose corners turn counter-clockwise seen from outside.
    ///
    /// Zero where that is zero: for two coplanar triangles that face the same way, and two without area.
    pub normal: DVec3,
}

impl TriangleContact {
    /// The middle of the segment.
    #[must_use]
    pub fn point(&self) -> DVec3 {
        let [p, q] = self.segment;
        p + (q - p) * 0.5
    }

    /// The length of the segment.
    #[must_use]
    pub fn length(&self) -> f64 {
        let [p, q] = self.segment;
        p.distance(q)
    }
}

/// Where two closed triangles meet; `None` exactly when [`triangles_intersect`](crate::triangles_intersect) says they do
/// not.
///
/// With the triangles exchanged the segment is the same and the normal the opposite.
///
/// ```
/// use glam::DVec3;
/// use morph_collision::triangle_contact;
///
/// let floor = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
/// let wall = [DVec3::new(1.0, 1.0, -1.0), DVec3::new(2.0, 1.0, -1.0), DVec3::new(1.0, 1.0, 1.0)];
/// let contact = triangle_contact(&wall, &floor).expect("the wall stands in the floor");
/// assert_eq!(contact.segment, [DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.5, 1.0, 0.0)]);
/// assert!(contact.normal.z > 0.0); // out of the floor, and away from the side that the wall faces
/// ```
#[must_use]
pub fn triangle_contact(a: &Triangle, b: &Triangle) -> Option<TriangleContact> {
    if !triangles_intersect(a, b) {
        return None;
    }
    // Lengths and determinants need room in both directions; scaling by a power of two loses nothing that they would show.
    let scale = power_of_two_near(
        a.iter()
            .chain(b)
            .map(|corner| corner.abs().max_element())
            .fold(0.0, f64::max),
    );
    let [a, b] = [a, b].map(|triangle| triangle.map(|corner| corner / scale));
    let (a, b) = (&a, &b);
    let segment = match point_of(a).or_else(|| point_of(b)) {
        Some(point) => [point; 2],
        None => common_segment(a, b).unwrap_or_else(|| {
            let between = closest_between(a, b);
            sorted([between.on_a, between.on_b])
        }),
    };
    let segment = segment.map(|end| end * scale);
    let normal = (unit_normal(b) - unit_normal(a)).normalize_or_zero();
    Some(TriangleContact { segment, normal })
}

/// The point that a triangle is, if all its corners are one.
fn point_of([a, b, c]: &Triangle) -> Option<DVec3> {
    (a == b && a == c).then_some(*a)
}

/// A power of two by which lengths like `largest` become ordinary; 1 where they are.
fn power_of_two_near(largest: f64) -> f64 {
    const ORDINARY: std::ops::Range<f64> = 1e-60..1e60;
    if largest == 0.0 || ORDINARY.contains(&largest) {
        return 1.0;
    }
    // Short of the ends of the range, so that neither it nor its inverse is subnormal.
    2.0_f64.powi((largest.log2() as i32).clamp(-1000, 1000))
}

/// The two points common to both triangles that are farthest apart.
///
/// What two triangles have in common is convex, and each of its corners is a point where an edge of one meets the other.
pub(crate) fn common_segment(a: &Triangle, b: &Triangle) -> Option<Segment> {
    let b_sides = sides(a, b);
    if strictly_one_side(b_sides) {
        return None;
    }
    let a_sides = sides(b, a);
    if strictly_one_side(a_sides) {
        return None;
    }
    let mut corners = Corners::default();
    corners.add_edges(b, b_sides, a);
    corners.add_edges(a, a_sides, b);
    corners.farthest()
}

/// Corners of what two triangles have in common, some of them twice.
#[derive(Default)]
struct Corners {
    /// At most four from each of six edges.
    points: [DVec3; 24],
    len: usize,
}

impl Corners {
    fn add(&mut self, point: DVec3) {
        if let Some(free) = self.points.get_mut(self.len) {
            *free = point;
            self.len += 1;
        }
    }

    /// In lexicographic order first, so that it does not depend on which triangle was named first.
    fn farthest(mut self) -> Option<Segment> {
        let points = self.points.get_mut(..self.len)?;
        points.sort_by(|p, q| lexicographic(*p, *q));
        let mut farthest = [*points.first()?; 2];
        let mut length = 0.0;
        for (i, &p) in points.iter().enumerate() {
            for &q in &points[i + 1..] {
                let distance = p.distance_squared(q);
                if distance > length {
                    (length, farthest) = (distance, [p, q]);
                }
            }
        }
        Some(farthest)
    }

    /// Where the edges of `triangle`, whose corners lie on these sides of the plane of `other`, meet `other`.
    fn add_edges(&mut self, triangle: &Triangle, sides: [Ordering; 3], other: &Triangle) {
        let projection = projection_of(other);
        let sides = [[sides[0], sides[1]], [sides[1], sides[2]], [sides[2], sides[0]]];
        for (edge, sides) in edges(triangle).into_iter().zip(sides) {
            match projection {
                Some(projection) => self.add_edge(edge, sides, other, projection),
                None => self.add_collapsed(edge, other),
            }
        }
    }

    fn add_edge(&mut self, edge: Segment, sides: [Ordering; 2], triangle: &Triangle, projection: Projection) {
        let [a, b, c] = *triangle;
        let [p, q] = edge;
        if sides == [Equal, Equal] {
            self.add_flat(edge, triangle, projection);
        } else if sides[0] != sides[1]
            && all_on_one_side([plane_side(p, q, a, b), plane_side(p, q, b, c), plane_side(p, q, c, a)])
        {
            self.add(match sides {
                [Equal, _] => p,
                [_, Equal] => q,
                _ => {
                    let heights = [p, q].map(|end| plane_height(a, b, c, end));
                    crossing(edge, heights, || plane_crossing(*triangle, edge), triangle)
                }
            });
        }
    }

    /// An edge in the plane of the triangle: its ends inside, and where it crosses the triangle's edges.
    fn add_flat(&mut self, edge: Segment, triangle: &Triangle, projection: Projection) {
        let flat = |point| projection.apply(point);
        let [a, b, c] = triangle.map(flat);
        for end in edge {
            let p = flat(end);
            if all_on_one_side([line_side(a, b, p), line_side(b, c, p), line_side(c, a, p)]) {
                self.add(end);
            }
        }
        for side in edges(triangle) {
            self.add_flat_crossing(edge, side, projection, triangle);
        }
    }

    /// Where two segments cross each other inside, if they do.
    fn add_flat_crossing(&mut self, edge: Segment, side: Segment, projection: Projection, triangle: &Triangle) {
        let flat = |point| projection.apply(point);
        let ([p, q], [u, v]) = (edge.map(flat), side.map(flat));
        if flat_segments_cross([p, q], [u, v]) {
            let heights = [line_height(u, v, p), line_height(u, v, q)];
            self.add(crossing(edge, heights, || line_crossing([u, v], [p, q]), triangle));
        }
    }

    /// An edge and a triangle that is a segment or a point.
    fn add_collapsed(&mut self, edge: Segment, triangle: &Triangle) {
        let hull = hull_of_line(triangle);
        if !segments_intersect(edge, hull) {
            return;
        }
        let before = self.len;
        for end in edge {
            if segments_intersect([end; 2], hull) {
                self.add(end);
            }
        }
        for end in hull {
            if segments_intersect([end; 2], edge) {
                self.add(end);
            }
        }
        if self.len == before
            && let Some(projection) = Projection::keeping_apart(edge[0], edge[1], hull[0])
        {
            self.add_flat_crossing(edge, hull, projection, triangle);
        }
    }
}

/// Where an edge crosses a triangle, from the signed heights of its ends over the triangle's plane or edge.
///
/// Heights of an edge that lies nearly in the plane are mostly rounding. Where the point they lead to is off, `exactly` tells
/// where along itself the edge crosses; and if that is still off, the point of the edge that is closest to the triangle's own
/// edges may serve better.
fn crossing(edge: Segment, heights: [f64; 2], exactly: impl FnOnce() -> f64, triangle: &Triangle) -> DVec3 {
    const TOLERANCE: f64 = 1e-14;
    let at = |t: f64| lerp(edge, if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.5 });
    let point = at(heights[0] / (heights[0] - heights[1]));
    let size = triangle
        .iter()
        .map(|corner| corner.distance_squared(point))
        .fold(edge[0].distance_squared(edge[1]), f64::max);
    let off = |p: DVec3| closest_on_triangle(p, triangle).squared;
    if off(point) <= TOLERANCE * TOLERANCE * size {
        return point;
    }
    let others = [at(exactly()), closest_of_segment_and_triangle(edge, triangle).0];
    others
        .into_iter()
        .fold(point, |best, other| if off(other) < off(best) { other } else { best })
}
