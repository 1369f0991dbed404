//! The surface-area heuristic, summed over several shapes.
//!
//! Planes are placed on the base; the cost of a split is summed over all shapes. A node gets up to eight children by splitting
//! its costliest child again, unless that child can be a leaf. The cost of triangles is that of the leaves they fill, rounded
//! up, since a leaf is tested as a whole. So leaves come out nearly full.

use std::ops::Range;

use super::partition::{Partition, Shape};
use crate::bounds::{Aabb, LANES};

/// Bins per axis. Not measured; a common choice.
const BINS: usize = 16;
/// Up to this many leaves' triangles every plane is tried instead of the planes between bins, at a cost of `O(n log n)`. Not
/// measured; bins are too coarse to fill the last leaves.
const SWEPT_LEAVES: usize = 8;

/// A contiguous range of a node's triangles that may become a child.
struct Part {
    range: Range<usize>,
    cost: f64,
    is_divisible: bool,
}

fn hull(shape: &Shape, triangles: &[u32]) -> Aabb {
    let bounds = triangles.iter().map(|&triangle| shape.bounds[triangle as usize]);
    bounds.fold(Aabb::EMPTY, |hull, bounds| hull.union(&bounds))
}

/// Half of a box's surface area; 0 for an empty box.
fn half_area(bounds: &Aabb) -> f64 {
    let s = bounds.size().max(glam::Vec3::ZERO).as_dvec3();
    s.x * s.y + s.y * s.z + s.z * s.x
}

impl Partition {
    /// Reorders the triangles child by child and returns the number of triangles of each child: 1 to 8 children, none empty. There is
    /// one child only if no plane separates the midpoints.
    pub(super) fn by_area(&self, triangles: &mut [u32]) -> Vec<usize> {
        let mut parts = vec![self.part(triangles, 0..triangles.len())];
        while parts.len() < LANES {
            let Some(costliest) = (0..parts.len())
                .filter(|&i| parts[i].is_divisible)
                .max_by(|&i, &j| parts[i].cost.total_cmp(&parts[j].cost))
            else {
                break;
            };
            let range = parts[costliest].range.clone();
            match self.halve(&mut triangles[range.clone()]) {
                Some(count) => {
                    let middle = range.start + count;
                    let halves = [range.start..middle, middle..range.end];
                    let halves = halves.map(|half| self.part(triangles, half));
                    parts.splice(costliest..=costliest, halves);
                }
                None => parts[costliest].is_divisible = false,
            }
        }
        parts.into_iter().map(|part| part.range.len()).collect()
    }

    fn part(&self, triangles: &[u32], range: Range<usize>) -> Part {
        let part = &triangles[range.clone()];
        let area: f64 = self.shapes.iter().map(|shape| half_area(&hull(shape, part))).sum();
        Part {
            cost: area * self.leaves(part.len()),
            is_divisible: part.len() > self.leaf_size,
            range,
        }
    }

    /// The number of leaves that some triangles fill, rounded up.
    fn leaves(&self, triangles: usize) -> f64 {
        triangles.div_ceil(self.leaf_size) as f64
    }

    /// Moves the triangles to the two sides of the best plane. Returns the number on the first side, `None` if no plane
    /// separates them.
    fn halve(&self, triangles: &mut [u32]) -> Option<usize> {
        if triangles.len() <= SWEPT_LEAVES * self.leaf_size {
            self.halve_swept(triangles)
        } else {
            self.halve_binned(triangles)
        }
    }

    /// Tries the planes between every two triangles along each axis. Ties stay in order.
    fn halve_swept(&self, triangles: &mut [u32]) -> Option<usize> {
        let mut best: Option<(f64, usize, Vec<u32>)> = None;
        let mut costs = vec![0.0; triangles.len()];
        for axis in 0..3 {
            let mut sorted = triangles.to_vec();
            let midpoint = |t: &u32| self.shapes[0].midpoints[*t as usize][axis];
            sorted.sort_by(|s, t| midpoint(s).total_cmp(&midpoint(t)));
            costs.fill(0.0);
            for shape in &self.shapes {
                self.add_costs(sorted.iter().map(|&t| (shape.bounds[t as usize], 1)), &mut costs);
            }
            // Among equal costs, as of triangles without area, the middle.
            let imbalance = |count: usize| (2 * count).abs_diff(costs.len());
            let cheapest = costs
                .iter()
                .enumerate()
                .skip(1)
                .min_by(|(i, a), (j, b)| a.total_cmp(b).then(imbalance(*i).cmp(&imbalance(*j))));
            if let Some((count, &cost)) = cheapest
                && best.as_ref().is_none_or(|(least, ..)| cost < *least)
            {
                best = Some((cost, count, sorted));
            }
        }
        let (_, count, sorted) = best?;
        triangles.copy_from_slice(&sorted);
        Some(count)
    }

    /// Tries the planes between equal bins along each axis.
    fn halve_binned(&self, triangles: &mut [u32]) -> Option<usize> {
        let midpoint = |&t: &u32| self.shapes[0].midpoints[t as usize];
        let spread = Aabb::from_points(triangles.iter().map(midpoint));
        let mut best: Option<(f64, Vec<usize>, usize)> = None;
        for axis in 0..3 {
            let (start, end) = (f64::from(spread.min[axis]), f64::from(spread.max[axis]));
            if end <= start {
                continue;
            }
            let per_unit = BINS as f64 / (end - start);
            let bin = |t: &u32| ((f64::from(midpoint(t)[axis]) - start) * per_unit) as usize;
            let bins: Vec<usize> = triangles.iter().map(|t| bin(t).min(BINS - 1)).collect();
            let mut costs = [0.0; BINS];
            for shape in &self.shapes {
                let mut boxes = [(Aabb::EMPTY, 0); BINS];
                for (&t, &bin) in triangles.iter().zip(&bins) {
                    let (bounds, count) = &mut boxes[bin];
                    *bounds = bounds.union(&shape.bounds[t as usize]);
                    *count += 1;
                }
                self.add_costs(boxes.into_iter(), &mut costs);
            }
            // The plane before bin `i`. Neither side is empty because the first and the last bin are not.
            let planes = costs.into_iter().enumerate().skip(1);
            if let Some((plane, cost)) = planes.min_by(|(_, a), (_, b)| a.total_cmp(b))
                && best.as_ref().is_none_or(|(least, ..)| cost < *least)
            {
                best = Some((cost, bins, plane));
            }
        }
        let (_, bins, plane) = best?;
        let (first, second): (Vec<_>, Vec<_>) = triangles.iter().copied().zip(bins).partition(|&(_, bin)| bin < plane);
        for (slot, (triangle, _)) in triangles.iter_mut().zip(first.iter().chain(&second)) {
            *slot = *triangle;
        }
        Some(first.len())
    }

    /// For the plane before each box adds to its cost area times leaves of both sides. Each box comes with a number of triangles.
    fn add_costs(&self, boxes: impl DoubleEndedIterator<Item = (Aabb, usize)> + Clone, costs: &mut [f64]) {
        let sides = |(hull, count): &mut (Aabb, usize), (bounds, more): (Aabb, usize)| {
            (*hull, *count) = (hull.union(&bounds), *count + more);
            Some((*hull, *count))
        };
        let cost = |(hull, count): (Aabb, usize)| half_area(&hull) * self.leaves(count);
        let none = (Aabb::EMPTY, 0);
        for (sum, side) in costs.iter_mut().skip(1).zip(boxes.clone().scan(none, sides)) {
            *sum += cost(side);
        }
        for (sum, side) in costs.iter_mut().rev().zip(boxes.rev().scan(none, sides)) {
            *sum += cost(side);
        }
    }
}
