//! Signs of orientation determinants, exact for all finite points: by the adaptive predicates of the `robust` crate
//! (Shewchuk 1997) where their products stay in range, in whole numbers elsewhere.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

use super::dyadic::Dyadic;
use super::number::{Number, Vector, cross, cross_coordinate, difference, dot};

/// On which side of the plane through `a`, `b`, `c` the point `d` lies; `Equal` on it, or when the plane is none.
#[inline]
pub(crate) fn plane_side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Ordering {
    if !in_range([a, b, c, d].iter().flat_map(DVec3::to_array)) {
        return plane_determinant(a, b, c, d).order();
    }
    sign(plane_height(a, b, c, d))
}

/// A number about in proportion to the height of `d` over the plane; it has the sign of [`plane_side`] for points in range.
#[inline]
pub(crate) fn plane_height(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let point = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    robust::orient3d(point(a), point(b), point(c), point(d))
}

/// Where the segment from `p` to `q` crosses the plane, as a share of its length: to a few roundings, however flat the angle.
#[cold]
pub(crate) fn plane_crossing([a, b, c]: [DVec3; 3], [p, q]: [DVec3; 2]) -> f64 {
    share(plane_determinant(a, b, c, p), plane_determinant(a, b, c, q))
}

/// Where the segment from `p` to `q` crosses the line through `a` and `b`, likewise.
#[cold]
pub(crate) fn line_crossing([a, b]: [DVec2; 2], [p, q]: [DVec2; 2]) -> f64 {
    share(line_determinant(a, b, p), line_determinant(a, b, q))
}

fn share(first: Dyadic, second: Dyadic) -> f64 {
    first.over(&first.minus(&second))
}

/// On which side of the line through `a`, `b` the point `c` lies; `Equal` on it, or when the line is none.
#[inline]
pub(crate) fn line_side(a: DVec2, b: DVec2, c: DVec2) -> Ordering {
    if !in_range([a, b, c].iter().flat_map(DVec2::to_array)) {
        return line_determinant(a, b, c).order();
    }
    sign(line_height(a, b, c))
}

/// A number about in proportion to the distance of `c` from the line; it has the sign of [`line_side`] for points in range.
#[inline]
pub(crate) fn line_height(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let point = |p: DVec2| Coord { x: p.x, y: p.y };
    robust::orient2d(point(a), point(b), point(c))
}

/// Whether products of three differences of these coordinates, and all parts of them, are `f64` that neither overflow nor
/// underflow: each is 0 or between `2^-277` and `2^300` in size, and so a whole multiple of `2^-330`.
///
/// Bodies' corners in world space are whole multiples of `2^-298` below `2^256` whatever the mesh and its place, so that
/// only tiny ones are sent the long way, and needlessly.
#[inline]
fn in_range(mut coordinates: impl Iterator<Item = f64>) -> bool {
    const LEAST: f64 = f64::from_bits((1023 - 277) << 52);
    const MOST: f64 = f64::from_bits((1023 + 300) << 52);
    coordinates.all(|c| c == 0.0 || (LEAST..=MOST).contains(&c.abs()))
}

#[cold]
fn plane_determinant(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Dyadic {
    let [a, b, c]: [Vector<Dyadic>; 3] = [a, b, c].map(|corner| difference(corner, d));
    dot(&a, &cross(&b, &c))
}

#[cold]
fn line_determinant(a: DVec2, b: DVec2, c: DVec2) -> Dyadic {
    let [a, b] = [a, b].map(|end| difference(end.extend(0.0), c.extend(0.0)));
    cross_coordinate(&a, &b, 2)
}

/// Determinants of finite points are numbers; -0 is zero.
fn sign(determinant: f64) -> Ordering {
    determinant.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// A coordinate plane to which points are projected by leaving out one coordinate, which is exact.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Projection {
    AlongX,
    AlongY,
    AlongZ,
}

impl Projection {
    const ALL: [Self; 3] = [Self::AlongX, Self::AlongY, Self::AlongZ];

    pub(crate) fn apply(self, p: DVec3) -> DVec2 {
        match self {
            Self::AlongX => DVec2::new(p.y, p.z),
            Self::AlongY => DVec2::new(p.z, p.x),
            Self::AlongZ => DVec2::new(p.x, p.y),
        }
    }

    /// A projection in which the three points are not on one line; `None` when they are on one line in space.
    ///
    /// Projection is one to one on the points' plane then.
    pub(crate) fn keeping_apart(a: DVec3, b: DVec3, c: DVec3) -> Option<Self> {
        Self::ALL.into_iter().find(|projection| {
            let [a, b, c] = [a, b, c].map(|p| projection.apply(p));
            line_side(a, b, c) != Ordering::Equal
        })
    }
}
