//! Signs of orientation determinants, adaptive and exact (Shewchuk 1997), through the `robust` crate.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

/// On which side of the plane through `a`, `b`, `c` the point `d` lies; `Equal` on it, or when the plane is none.
#[inline]
pub(crate) fn plane_side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Ordering {
    sign(plane_height(a, b, c, d))
}

/// A number with the sign of [`plane_side`], about in proportion to the height of `d` over the plane.
#[inline]
pub(crate) fn plane_height(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let point = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    robust::orient3d(point(a), point(b), point(c), point(d))
}

/// On which side of the line through `a`, `b` the point `c` lies; `Equal` on it, or when the line is none.
#[inline]
pub(crate) fn line_side(a: DVec2, b: DVec2, c: DVec2) -> Ordering {
    sign(line_height(a, b, c))
}

/// A number with the sign of [`line_side`], about in proportion to the distance of `c` from the line.
#[inline]
pub(crate) fn line_height(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let point = |p: DVec2| Coord { x: p.x, y: p.y };
    robust::orient2d(point(a), point(b), point(c))
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
