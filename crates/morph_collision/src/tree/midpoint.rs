//! The paper's split (Sect. 3): at the mid-value of the node's extents along three axes at once, triangle midpoints decide,
//! empty octants vanish. With fewer children the longest one or two axes are taken.

use glam::{BVec3, Vec3};

use super::partition::Shape;
use crate::bounds::{Aabb, LANES};

/// Reorders the triangles child by child; the children's lengths, a single one if their midpoints are all the same.
pub(super) fn split(shape: &Shape, arity: usize, triangles: &mut [u32]) -> Vec<usize> {
    let extents = triangles
        .iter()
        .map(|&t| shape.bounds[t as usize])
        .fold(Aabb::EMPTY, |hull, b| hull.union(&b));
    let counts = split_at(shape, arity, triangles, &extents);
    if counts.len() > 1 {
        return counts;
    }
    // All midpoints in one octant of the extents: split the extents of the midpoints themselves.
    let spread = Aabb::from_points(triangles.iter().map(|&t| shape.midpoints[t as usize]));
    split_at(shape, arity, triangles, &spread)
}

/// A stable sort by octant around the middle of a box; the lengths of the octants that are not empty.
fn split_at(shape: &Shape, arity: usize, triangles: &mut [u32], extents: &Aabb) -> Vec<usize> {
    let axes = longest_axes(extents.size(), arity.ilog2() as usize);
    let center = extents.center();
    let octant = |t: u32| (shape.midpoints[t as usize].cmpgt(center) & axes).bitmask() as usize;
    let mut counts = [0; LANES];
    for &t in &*triangles {
        counts[octant(t)] += 1;
    }
    triangles.sort_by_key(|&t| octant(t));
    counts.into_iter().filter(|&count| count > 0).collect()
}

fn longest_axes(size: Vec3, count: usize) -> BVec3 {
    let mut axes = [0, 1, 2];
    axes.sort_by(|&i, &j| size[j].total_cmp(&size[i]));
    let mut mask = BVec3::FALSE;
    for &axis in &axes[..count] {
        mask.set(axis, true);
    }
    mask
}
