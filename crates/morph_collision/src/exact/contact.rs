//! How two intersecting triangles touch: the segment that they share, and a normal.

use std::cmp::Ordering::{self, Equal};

use glam::DVec3;

use super::closest::{closest_of_segment_and_triangle, closest_of_triangles, closest_on_triangle, lerp};
use super::intersection::triangles_intersect;
use super::number::{largest, power_of_two, power_of_two_below};
use super::predicates::{Projection, line_crossing, line_height, plane_crossing, plane_height};
use super::segment::{
    Segment, edges, flat_segments_cross, flat_triangle_contains, lexicographic, line_pierces, segments_intersect,
    sorted,
};
use super::triangle::{Triangle, hull_of_line, sides_of_both};

/// Where two intersecting triangles meet.
///
/// Whether they meet, and which edges pierce which triangle, is decided exactly. Coordinates are `f64`: the ends of the segment
/// lie on both triangles up to about `1e-13` times the size of the larger one, plus a few roundings of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleContact {
    /// The two common points that are farthest apart, in lexicographic order.
    ///
    /// - Crossing triangles: the ends of their intersection segment.
    /// - Triangles that touch in one point: that point twice, up to rounding.
    /// - Coplanar triangles: a longest diagonal of the common area.
    pub segment: [DVec3; 2],
    /// The direction in which to move the first triangle out of the second: the unit vector along `n_b - n_a`. `n_a` and `n_b`
    /// are the unit normals of the triangles, whose corners are counter-clockwise seen from outside.
    ///
    /// Zero if `n_a` equals `n_b`: for coplanar triangles that face the same way, and for two triangles without area.
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
        self.segment[0].distance(self.segment[1])
    }
}

/// Where two closed triangles meet; `None` exactly when [`triangles_intersect`](crate::triangles_intersect) is false.
///
/// Swapping the triangles keeps the segment and reverses the normal.
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
    let scale = scale_of(a, b);
    let [a, b] = [a, b].map(|triangle| triangle.map(|corner| corner / scale));
    let segment = match [&a, &b].into_iter().find(|[p, q, r]| p == q && p == r) {
        Some([point, ..]) => [*point; 2],
        None => common_segment(&a, &b).unwrap_or_else(|| {
            let closest = closest_of_triangles(&a, &b);
            sorted([closest.on_a, closest.on_b])
        }),
    };
    let normal = (unit_normal(&b) - unit_normal(&a)).normalize_or_zero();
    let segment = segment.map(|end| end * scale);
    Some(TriangleContact { segment, normal })
}

/// A power of two. After dividing by it, squares and determinants of coordinates stay in range.
fn scale_of(a: &Triangle, b: &Triangle) -> f64 {
    /// Sizes that need no scaling: their fourth powers stay in range.
    const ORDINARY: std::ops::Range<f64> = 1e-60..1e60;
    let sizes = a.iter().chain(b).map(|corner| corner.abs().max_element());
    let size = largest(sizes);
    if size == 0.0 || ORDINARY.contains(&size) {
        return 1.0;
    }
    // Neither the scale nor its inverse may be subnormal.
    power_of_two_below(size).clamp(power_of_two(-1000), power_of_two(1000))
}

/// The unit normal by the right-hand rule; zero for a triangle without area. A sliver's normal is only as accurate as its shape.
pub(crate) fn unit_normal([a, b, c]: &Triangle) -> DVec3 {
    let (u, v) = (b - a, c - a);
    // Scaled first, so that tiny and huge triangles have a normal too.
    let size = u.abs().max(v.abs()).max_element();
    if size == 0.0 {
        return DVec3::ZERO;
    }
    (u / size).cross(v / size).normalize_or_zero()
}

/// The two common points of both triangles that are farthest apart.
///
/// The intersection of two triangles is convex, and each of its corners is a point where an edge of one meets the other.
pub(crate) fn common_segment(a: &Triangle, b: &Triangle) -> Option<Segment> {
    let [a_sides, b_sides] = sides_of_both(a, b)?;
    let mut corners = Corners::default();
    corners.add_edges(b, b_sides, a);
    corners.add_edges(a, a_sides, b);
    corners.farthest()
}

/// The corners of the intersection of two triangles, possibly with duplicates.
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

    fn farthest(mut self) -> Option<Segment> {
        let points = self.points.get_mut(..self.len)?;
        // Sorted, so that ties do not depend on the order of the triangles.
        points.sort_by(lexicographic);
        let mut farthest = [*points.first()?; 2];
        let mut length = 0.0;
        for (i, &p) in points.iter().enumerate() {
            for &q in &points[i..] {
                let distance = p.distance_squared(q);
                if distance > length {
                    (length, farthest) = (distance, [p, q]);
                }
            }
        }
        Some(farthest)
    }

    /// Adds the points where edges of `triangle` meet `other`. The corners of `triangle` lie on these sides of `other`'s plane.
    fn add_edges(&mut self, triangle: &Triangle, sides: [Ordering; 3], other: &Triangle) {
        let projection = Projection::of_plane(*other);
        for (edge, sides) in edges(triangle).into_iter().zip(edges(&sides)) {
            match projection {
                Some(projection) if sides == [Equal, Equal] => self.add_flat(edge, other, projection),
                Some(_) => self.add_piercing(edge, sides, other),
                None => self.add_collapsed(edge, other),
            }
        }
    }

    /// Adds the point where an edge that is not in a triangle's plane meets the triangle.
    fn add_piercing(&mut self, edge: Segment, sides: [Ordering; 2], triangle: &Triangle) {
        if sides[0] == sides[1] || !line_pierces(edge, triangle) {
            return;
        }
        let [a, b, c] = *triangle;
        self.add(match sides {
            [Equal, _] => edge[0],
            [_, Equal] => edge[1],
            _ => {
                let heights = edge.map(|end| plane_height(a, b, c, end));
                crossing(edge, heights, || plane_crossing(*triangle, edge), triangle)
            }
        });
    }

    /// For an edge in the triangle's plane: adds its ends inside the triangle, and the points where it crosses the triangle's edges.
    fn add_flat(&mut self, edge: Segment, triangle: &Triangle, projection: Projection) {
        let flat = |point| projection.apply(point);
        let flat_triangle = triangle.map(flat);
        let inside = |end: &DVec3| flat_triangle_contains(&flat_triangle, flat(*end));
        edge.into_iter().filter(inside).for_each(|end| self.add(end));
        for side in edges(triangle) {
            self.add_flat_crossing(edge, side, projection, triangle);
        }
    }

    /// Adds the point where two coplanar segments cross, unless it is an end of either.
    fn add_flat_crossing(&mut self, edge: Segment, side: Segment, projection: Projection, triangle: &Triangle) {
        let flat = |point| projection.apply(point);
        let ([p, q], [u, v]) = (edge.map(flat), side.map(flat));
        if flat_segments_cross([p, q], [u, v]) {
            let heights = [line_height(u, v, p), line_height(u, v, q)];
            self.add(crossing(edge, heights, || line_crossing([u, v], [p, q]), triangle));
        }
    }

    /// Adds the points where an edge meets a triangle that is a segment or a point.
    fn add_collapsed(&mut self, edge: Segment, triangle: &Triangle) {
        let hull = hull_of_line(triangle);
        if !segments_intersect(edge, hull) {
            return;
        }
        let before = self.len;
        for (ends, other) in [(edge, hull), (hull, edge)] {
            let common = |end: &DVec3| segments_intersect([*end; 2], other);
            ends.into_iter().filter(common).for_each(|end| self.add(end));
        }
        if self.len == before
            && let Some(projection) = Projection::of_plane([edge[0], edge[1], hull[0]])
        {
            self.add_flat_crossing(edge, hull, projection, triangle);
        }
    }
}

/// The point where an edge crosses a triangle, computed from the heights of its ends over the triangle's plane or edge.
///
/// If the edge is nearly in the plane, its heights are mostly rounding error. If the point they give is off the triangle, `exactly`
/// computes the crossing's parameter along the edge. If that point is off too, the edge's point closest to the triangle may be better.
/// Returns the best of the three.
fn crossing(edge: Segment, heights: [f64; 2], exactly: impl FnOnce() -> f64, triangle: &Triangle) -> DVec3 {
    // About 90 roundings; crossings at ordinary angles stay below. Not measured.
    const TOLERANCE: f64 = 1e-14;
    let at = |t: f64| lerp(edge, if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.5 });
    let point = at(heights[0] / (heights[0] - heights[1]));
    let sizes = triangle.map(|corner| corner.distance_squared(point));
    let size = largest(sizes).max(edge[0].distance_squared(edge[1]));
    let off = |p: DVec3| closest_on_triangle(p, triangle).squared;
    if off(point) <= TOLERANCE * TOLERANCE * size {
        return point;
    }
    [at(exactly()), closest_of_segment_and_triangle(edge, triangle).on_a]
        .into_iter()
        .fold(point, |best, other| if off(other) < off(best) { other } else { best })
}
