//! The paper's split (Sect. 3): at the mid-value of the node's extents along all three axes at once, triangle midpoints
//! decide, empty octants vanish.

use glam::Vec3;

use crate::bounds::{Aabb, LANES};
use crate::model::MorphModel;

/// The shape on which triangles are put together.
pub(super) struct Partition {
    midpoints: Vec<Vec3>,
    bounds: Vec<Aabb>,
    scratch: Vec<u32>,
}

impl Partition {
    pub(super) fn on_base(model: &MorphModel) -> Self {
        let (midpoints, bounds) = (0..model.triangle_count())
            .map(|triangle| {
                let corners = model.triangle(triangle).map(|vertex| model.base(vertex));
                let third = 1.0 / 3.0;
                let midpoint = corners[0] * third + corners[1] * third + corners[2] * third;
                (midpoint, Aabb::from_points(corners))
            })
            .unzip();
        Self {
            midpoints,
            bounds,
            scratch: Vec::new(),
        }
    }

    /// Reorders a node's triangles child by child and returns the children's lengths: 2 to 8 of them, none zero.
    ///
    /// `triangles` has at least two entries. Midpoints that all fall into one octant are split by the extents of the
    /// midpoints themselves, and midpoints that are all the same by count, so every split makes progress.
    pub(super) fn split(&mut self, triangles: &mut [u32]) -> Vec<usize> {
        let extents = triangles
            .iter()
            .map(|&t| self.bounds[t as usize])
            .fold(Aabb::EMPTY, |hull, b| hull.union(&b));
        let counts = self.split_at(triangles, extents.center());
        if counts.len() > 1 {
            return counts;
        }
        let spread = Aabb::from_points(triangles.iter().map(|&t| self.midpoints[t as usize]));
        let counts = self.split_at(triangles, spread.center());
        if counts.len() > 1 {
            return counts;
        }
        let chunk = triangles.len().div_ceil(LANES);
        triangles.chunks(chunk).map(<[u32]>::len).collect()
    }

    /// A stable sort by octant around `center`; the lengths of the octants that are not empty.
    fn split_at(&mut self, triangles: &mut [u32], center: Vec3) -> Vec<usize> {
        let octant = |midpoint: Vec3| midpoint.cmpgt(center).bitmask() as usize;
        let mut counts = [0; LANES];
        for &t in &*triangles {
            counts[octant(self.midpoints[t as usize])] += 1;
        }
        let mut ends = [0; LANES];
        for i in 1..LANES {
            ends[i] = ends[i - 1] + counts[i - 1];
        }
        self.scratch.clear();
        self.scratch.extend_from_slice(triangles);
        for &t in &self.scratch {
            let end = &mut ends[octant(self.midpoints[t as usize])];
            triangles[*end] = t;
            *end += 1;
        }
        counts.into_iter().filter(|&count| count > 0).collect()
    }
}
