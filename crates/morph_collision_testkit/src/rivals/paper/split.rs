//! Splits a node's triangles among its children (Sect. 3).

use glam::DVec3;

use super::references::References;

/// Splits a node's triangles, at least two, into 2 to 8 nonempty children. Reorders them child by child and returns the
/// children's lengths.
///
/// Only the base counts. Space is cut at the mid-value of the node's extents along the three axes, and a triangle goes
/// to the octant of its midpoint. The paper does not say what happens if all midpoints are in one octant. Here the
/// extents of the midpoints are cut, and triangles with the same midpoint are distributed by index.
pub(super) fn split(references: &References, triangles: &mut [u32]) -> Vec<usize> {
    let corners = |triangle: u32| references.triangles[triangle as usize].map(|vertex| references.position(vertex, 0));
    let midpoint = |triangle: u32| corners(triangle).iter().sum::<DVec3>() / 3.0;
    let middle = middle(triangles.iter().flat_map(|&triangle| corners(triangle)));
    let counts = octants(triangles, middle, midpoint);
    if counts.len() > 1 {
        return counts;
    }
    let middle = self::middle(triangles.iter().map(|&triangle| midpoint(triangle)));
    let counts = octants(triangles, middle, midpoint);
    if counts.len() > 1 {
        return counts;
    }
    triangles
        .chunks(triangles.len().div_ceil(8))
        .map(<[u32]>::len)
        .collect()
}

/// The middle of some points' extents.
fn middle(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (least, most) = points.fold(start, |(least, most), point| (least.min(point), most.max(point)));
    0.5 * (least + most)
}

/// Sorts triangles by the octant around `middle` of their midpoints; returns the lengths of the nonempty octants.
fn octants(triangles: &mut [u32], middle: DVec3, midpoint: impl Fn(u32) -> DVec3) -> Vec<usize> {
    let octant = |triangle: u32| midpoint(triangle).cmpgt(middle).bitmask() as usize;
    let mut counts = [0; 8];
    for &triangle in &*triangles {
        counts[octant(triangle)] += 1;
    }
    triangles.sort_by_cached_key(|&triangle| octant(triangle));
    counts.into_iter().filter(|&count| count > 0).collect()
}
