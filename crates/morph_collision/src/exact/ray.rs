//! A ray against a closed triangle, exact in whether they meet.

use std::cmp::Ordering::{self, Equal, Greater, Less};

use glam::DVec3;

use super::Triangle;
use super::dyadic::Dyadic;
use super::edge_on::edge_on;
use super::number::{Approx, Number, cross, difference, dot, vector};

/// The points `origin + t direction` for real `t` from 0 to `max_t`, which may be infinite.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) origin: DVec3,
    /// Not zero; its largest coordinate of a size around 1.
    pub(crate) direction: DVec3,
    pub(crate) max_t: f64,
}

/// Where a ray meets a triangle first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// To a relative error of a few [`VALUE_ERROR`](super::number::VALUE_ERROR).
    pub(crate) t: f64,
    /// The sign of the direction along the triangle's normal: `Less` on its front; `Equal` where it is seen edge-on.
    pub(crate) along_normal: Ordering,
}

/// Whether, where and from which side a ray meets a closed triangle: exactly, but for the roundings of `t`.
///
/// The line sees the triangle's edges turn one way iff it passes through it: three determinants of the direction and two
/// corners, seen from the origin. Triangles that share an edge share its determinant up to the sign, so nothing slips
/// through between them. All three are zero where the ray lies in the triangle's plane or the triangle is none.
pub(crate) fn ray_meets_triangle(line: &Line, triangle: &Triangle) -> Option<Crossing> {
    match crossing::<Approx>(line, triangle) {
        Some(decided) => decided,
        None => crossing::<Dyadic>(line, triangle).flatten(),
    }
}

/// `None` where the numbers do not suffice to decide.
#[inline]
fn crossing<N: Number>(line: &Line, triangle: &Triangle) -> Option<Option<Crossing>> {
    let [a, b, c] = *triangle;
    let direction: [N; 3] = vector(line.direction);
    let [u, v, w] = triangle.map(|corner| difference::<N>(corner, line.origin));
    let sides = [(&u, &v), (&v, &w), (&w, &u)].map(|(p, q)| dot(&direction, &cross(p, q)).sign());
    if sides.contains(&Some(Less)) && sides.contains(&Some(Greater)) {
        return Some(None);
    }
    let sides = [sides[0]?, sides[1]?, sides[2]?];
    let Some(&turn) = sides.iter().find(|side| **side != Equal) else {
        return Some(edge_on(line, triangle));
    };
    let normal = cross(&difference::<N>(b, a), &difference::<N>(c, a));
    let (height, speed) = (dot(&normal, &u), dot(&normal, &direction));
    // The sides sum to the speed, so that their sign is its.
    let ahead = height.sign()?;
    if ahead != Equal && ahead != turn {
        return Some(None);
    }
    if line.max_t.is_finite() {
        let beyond = height.minus(&speed.times(&N::new(line.max_t))).sign()?;
        if beyond == turn {
            return Some(None);
        }
    }
    Some(Some(Crossing {
        t: if ahead == Equal { 0.0 } else { height.ratio(&speed)? },
        along_normal: turn,
    }))
}
