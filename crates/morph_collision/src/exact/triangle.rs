//! Triangles, and on which sides of each other's planes they are.

use std::cmp::Ordering::{self, Equal};

use glam::DVec3;

use super::predicates::plane_side;
use super::segment::{Segment, sorted};

/// Three corners in any order and winding. They may be collinear or equal.
pub type Triangle = [DVec3; 3];

/// The sides of `b`'s plane on which the corners of `a` lie, and the reverse. All are `Equal` if the other triangle spans no
/// plane. `None` if one of the planes separates the triangles.
pub(super) fn sides_of_both(a: &Triangle, b: &Triangle) -> Option<[[Ordering; 3]; 2]> {
    let sides = |[a, b, c]: &Triangle, points: &Triangle| {
        let sides = points.map(|p| plane_side(*a, *b, *c, p));
        (!strictly_one_side(sides)).then_some(sides)
    };
    let b_sides = sides(a, b)?;
    Some([sides(b, a)?, b_sides])
}

#[inline]
pub(super) fn strictly_one_side(sides: [Ordering; 3]) -> bool {
    sides[0] != Equal && sides[0] == sides[1] && sides[1] == sides[2]
}

/// The segment that a degenerate triangle covers: from its lexicographically first corner to its last.
pub(super) fn hull_of_line(triangle: &Triangle) -> Segment {
    let [first, _, last] = sorted(*triangle);
    [first, last]
}
