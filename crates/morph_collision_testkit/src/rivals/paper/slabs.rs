//! k-DOPs as `k / 2` slabs, and their blend (Sect. 3.2). A box is the 6-DOP.

use glam::DVec3;

use super::directions::normals;
use super::slab_maps::SlabMap;
use super::volume::Volume;
use crate::rivals::relative::{Frame, RoundedBody};

/// The region between `start` and `end` along each of the `H` normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slabs<const H: usize> {
    pub(super) start: [f64; H],
    pub(super) end: [f64; H],
}

impl<const H: usize> Volume for Slabs<H> {
    type Culling = Vec<Frame<SlabMap<H>>>;

    const ZERO: Self = Self {
        start: [0.0; H],
        end: [0.0; H],
    };

    /// The reference k-DOP of Eq. 4.
    fn around(points: &[DVec3]) -> Self {
        let normals = const { normals::<H>() };
        let mut slabs = Self {
            start: [f64::INFINITY; H],
            end: [f64::NEG_INFINITY; H],
        };
        for &point in points {
            for (i, &normal) in normals.iter().enumerate() {
                let along = point.dot(normal);
                slabs.start[i] = slabs.start[i].min(along);
                slabs.end[i] = slabs.end[i].max(along);
            }
        }
        slabs
    }

    /// A term of Eq. 3: `(s', e') = sum of w_i (s_i, e_i)`.
    ///
    /// Eq. 5 multiplies `s <= p . n <= e` by `w >= 0`. With `w < 0` the inequalities are reversed, and so are the ends;
    /// the paper has no such weights.
    #[inline]
    fn add(&mut self, weight: f64, other: &Self) {
        let (start, end) = if weight < 0.0 {
            (&other.end, &other.start)
        } else {
            (&other.start, &other.end)
        };
        for i in 0..H {
            self.start[i] += weight * start[i];
            self.end[i] += weight * end[i];
        }
    }

    /// Along a normal, the errors of all its nonzero coordinates add up.
    #[inline]
    fn widen(&mut self, error: f64) {
        let normals = const { normals::<H>() };
        for (i, normal) in normals.iter().enumerate() {
            let along = error * normal.abs().element_sum();
            self.start[i] -= along;
            self.end[i] += along;
        }
    }

    #[inline]
    fn aabb(&self) -> [DVec3; 2] {
        [&self.start, &self.end].map(|ends| DVec3::new(ends[0], ends[1], ends[2]))
    }

    fn culling(a: &RoundedBody, b: &RoundedBody) -> Self::Culling {
        Frame::all(a, b, SlabMap::new)
    }

    /// SAT-lite: tries only the normals of either body.
    #[inline]
    fn overlap(frames: &Self::Culling, a: &Self, b: &Self) -> bool {
        frames.iter().all(|frame| {
            (0..H).all(|i| {
                let (start_a, end_a) = along(frame.a.as_ref(), a, i);
                let (start_b, end_b) = along(frame.b.as_ref(), b, i);
                start_a <= end_b && start_b <= end_a
            })
        })
    }

    #[cfg(test)]
    fn contains(&self, point: DVec3) -> bool {
        let normals = normals::<H>();
        (0..H).all(|i| (self.start[i]..=self.end[i]).contains(&point.dot(normals[i])))
    }
}

/// The slab along a normal of a frame, mapped if there is a map.
#[inline]
fn along<const H: usize>(map: Option<&SlabMap<H>>, slabs: &Slabs<H>, normal: usize) -> (f64, f64) {
    match map {
        Some(map) => map.along(slabs, normal),
        None => (slabs.start[normal], slabs.end[normal]),
    }
}
