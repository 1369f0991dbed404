//! Whether a triangle meets a convex region, which half-spaces bound.

use std::cmp::Ordering::{Equal, Less};

use glam::DVec3;

use super::dyadic::Dyadic;
use super::number::{Approx, Number, UNIT_ROUNDOFF, Vector, cross, dot, vector};
use super::triangle::Triangle;

/// The points `x` with `normal . x + offset >= 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
}

/// Whether a closed triangle shares a point with the intersection of half-spaces. The answer is exact.
///
/// In barycentric coordinates, the shared points are a bounded polygon, cut out by one line per half-space and one per edge. The
/// polygon is not empty iff it has a corner: a crossing of two lines that is on the right side of all others. Degenerate
/// triangles and empty regions need no special case.
pub(crate) fn triangle_meets_region(triangle: &Triangle, sides: &[Plane]) -> bool {
    filter(triangle, sides)
        .or_else(|| meets::<Approx>(triangle, sides))
        .or_else(|| meets::<Dyadic>(triangle, sides))
        .unwrap_or(false)
}

/// Decides most triangles: those with a corner that is certainly inside, and those that are certainly outside one half-space.
fn filter(triangle: &Triangle, sides: &[Plane]) -> Option<bool> {
    // Three products and three sums round by at most 6 half units in the last place of the sum of magnitudes.
    const RELATIVE: f64 = 16.0 * UNIT_ROUNDOFF;
    let mut inside = [true; 3];
    for Plane { normal, offset } in sides {
        let mut outside = true;
        for (inside, corner) in inside.iter_mut().zip(triangle) {
            let depth = normal.dot(*corner) + offset;
            let error = RELATIVE * (normal.abs().dot(corner.abs()) + offset.abs()) + f64::MIN_POSITIVE;
            *inside &= depth > error;
            outside &= depth < -error;
        }
        if outside {
            return Some(false);
        }
    }
    inside.contains(&true).then_some(true)
}

/// Decides by the corners of the polygon; `None` if the numbers are not exact enough.
fn meets<N: Number>(triangle: &Triangle, sides: &[Plane]) -> Option<bool> {
    let corners = triangle.map(vector::<N>);
    let mut inside = [true; 3];
    let mut cuts: Vec<Vector<N>> = Vec::new();
    for side in sides {
        let (normal, offset) = (vector(side.normal), N::new(side.offset));
        let depths: [N; 3] = std::array::from_fn(|i| dot(&normal, &corners[i]).plus(&offset));
        let signs = [depths[0].sign(), depths[1].sign(), depths[2].sign()];
        if signs == [Some(Less); 3] {
            return Some(false);
        }
        for (inside, sign) in inside.iter_mut().zip(signs) {
            *inside &= sign? != Less;
        }
        if signs.contains(&Some(Less)) {
            cuts.push(depths);
        }
    }
    if inside.contains(&true) {
        return Some(true);
    }
    let edges = [DVec3::X, DVec3::Y, DVec3::Z].map(vector::<N>);
    cuts.extend(edges);
    for (i, first) in cuts.iter().enumerate() {
        for (j, second) in cuts[..i].iter().enumerate() {
            // The point is on the two cuts that define it, so they are not tested: that would ask for the sign of zero.
            let others = cuts.iter().enumerate().filter(|(k, _)| *k != i && *k != j);
            if is_common_point(&cross(first, second), others.map(|(_, cut)| cut))? {
                return Some(true);
            }
        }
    }
    Some(false)
}

/// Whether homogeneous barycentric coordinates describe a point on the right side of every cut.
fn is_common_point<'a, N: Number + 'a>(point: &Vector<N>, cuts: impl Iterator<Item = &'a Vector<N>>) -> Option<bool> {
    let wrong = point[0].plus(&point[1]).plus(&point[2]).sign()?.reverse();
    if wrong == Equal {
        // The lines are parallel.
        return Some(false);
    }
    let mut decided = Some(true);
    for cut in cuts {
        match dot(cut, point).sign() {
            Some(sign) if sign == wrong => return Some(false),
            Some(_) => {}
            None => decided = None,
        }
    }
    decided
}
