//! Surface-area heuristic, summed over several shapes: binned, and by a sweep over all planes where few triangles
//! are left.
//!
//! Planes are placed on the first shape; what a split costs is summed over all of them. A node gets more than two children
//! by splitting the costliest child again, but no child that can be a leaf. Triangles cost by the leaf they fill, whole or
//! not, since a leaf is tested as a whole; so leaves come out nearly full.

use std::ops::Range;

use super::partition::Shape;
use crate::bounds::{Aabb, LANES};

const BINS: usize = 16;
/// Up to so many leaves' triangles are swept.
const SWEPT_LEAVES: usize = 8;

/// What triangles are put together by.
pub(super) struct Rule<'a> {
    pub(super) shape: &'a Shape,
    /// Further shapes that costs are summed over.
    pub(super) others: &'a [Shape],
    pub(super) leaf_size: usize,
}

/// Reorders the triangles child by child; the children's lengths, a single one if their midpoints are all the same.
pub(super) fn split(rule: &Rule<'_>, triangles: &mut [u32]) -> Vec<usize> {
    let mut parts = vec![Part::new(rule, triangles, 0..triangles.len())];
    while parts.len() < LANES {
        let Some(costliest) = (0..parts.len())
            .filter(|&i| parts[i].divisible)
            .max_by(|&i, &j| parts[i].cost.total_cmp(&parts[j].cost))
        else {
            break;
        };
        let range = parts[costliest].range.clone();
        match rule.halve(&mut triangles[range.clone()]) {
            Some(count) => {
                let middle = range.start + count;
                let halves = [range.start..middle, middle..range.end];
                let halves = halves.map(|half| Part::new(rule, triangles, half));
                parts.splice(costliest..=costliest, halves);
            }
            None => parts[costliest].divisible = false,
        }
    }
    parts.into_iter().map(|part| part.range.len()).collect()
}

/// Some of a node's triangles on their way to becoming a child.
struct Part {
    range: Range<usize>,
    cost: f64,
    divisible: bool,
}

impl Part {
    fn new(rule: &Rule<'_>, triangles: &[u32], range: Range<usize>) -> Self {
        let part = &triangles[range.clone()];
        let area: f64 = rule.shapes().map(|shape| half_area(&hull(shape, part))).sum();
        Self {
            cost: area * rule.leaves(part.len()),
            divisible: part.len() > rule.leaf_size,
            range,
        }
    }
}

fn hull(shape: &Shape, triangles: &[u32]) -> Aabb {
    triangles
        .iter()
        .fold(Aabb::EMPTY, |hull, &t| hull.union(&shape.bounds[t as usize]))
}

/// Half a box's surface; 0 for an empty one.
fn half_area(bounds: &Aabb) -> f64 {
    let s = bounds.size().max(glam::Vec3::ZERO).as_dvec3();
    s.x * s.y + s.y * s.z + s.z * s.x
}

impl Rule<'_> {
    fn shapes(&self) -> impl Iterator<Item = &Shape> + Clone {
        std::iter::once(self.shape).chain(self.others)
    }

    /// How many leaves so many triangles fill, the last one perhaps not wholly.
    fn leaves(&self, triangles: usize) -> f64 {
        triangles.div_ceil(self.leaf_size) as f64
    }

    /// Sorts the triangles to two sides of the best plane; how many are on the first side, `None` if no plane parts them.
    fn halve(&self, triangles: &mut [u32]) -> Option<usize> {
        if triangles.len() <= SWEPT_LEAVES * self.leaf_size {
            self.halve_swept(triangles)
        } else {
            self.halve_binned(triangles)
        }
    }

    /// Between every two triangles along each axis; ties are kept in order.
    fn halve_swept(&self, triangles: &mut [u32]) -> Option<usize> {
        let mut best: Option<(f64, usize, Vec<u32>)> = None;
        let mut costs = vec![0.0; triangles.len()];
        for axis in 0..3 {
            let mut sorted = triangles.to_vec();
            let midpoint = |t: &u32| self.shape.midpoints[*t as usize][axis];
            sorted.sort_by(|s, t| midpoint(s).total_cmp(&midpoint(t)));
            costs.fill(0.0);
            for shape in self.shapes() {
                self.add_costs(sorted.iter().map(|&t| (shape.bounds[t as usize], 1)), &mut costs);
            }
            // Where all cost the same, as without any area, in the middle.
            let imbalance = |count: usize| (2 * count).abs_diff(costs.len());
            let least = costs
                .iter()
                .enumerate()
                .skip(1)
                .min_by(|(i, a), (j, b)| a.total_cmp(b).then(imbalance(*i).cmp(&imbalance(*j))));
            if let Some((count, &cost)) = least
                && best.as_ref().is_none_or(|(least, ..)| cost < *least)
            {
                best = Some((cost, count, sorted));
            }
        }
        let (_, count, sorted) = best?;
        triangles.copy_from_slice(&sorted);
        Some(count)
    }

    /// Between equal bins along each axis.
    fn halve_binned(&self, triangles: &mut [u32]) -> Option<usize> {
        let spread = Aabb::from_points(triangles.iter().map(|&t| self.shape.midpoints[t as usize]));
        let mut best: Option<(f64, usize, usize)> = None;
        for axis in 0..3 {
            let Some(binning) = Binning::new(&spread, axis) else {
                continue;
            };
            let bins: Vec<u8> = triangles.iter().map(|&t| binning.bin(self.shape, t) as u8).collect();
            let mut costs = [0.0; BINS];
            for shape in self.shapes() {
                let mut boxes = [(Aabb::EMPTY, 0); BINS];
                for (&t, &bin) in triangles.iter().zip(&bins) {
                    let (bounds, count) = &mut boxes[usize::from(bin)];
                    *bounds = bounds.union(&shape.bounds[t as usize]);
                    *count += 1;
                }
                self.add_costs(boxes.into_iter(), &mut costs);
            }
            // The plane before bin `i`; both sides hold something because the first and last bins do.
            for (i, &cost) in costs.iter().enumerate().skip(1) {
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, i));
                }
            }
        }
        let (_, axis, plane) = best?;
        let binning = Binning::new(&spread, axis)?;
        let first_side = |t: u32| binning.bin(self.shape, t) < plane;
        let count = triangles.iter().filter(|&&t| first_side(t)).count();
        triangles.sort_by_key(|&t| !first_side(t));
        Some(count)
    }

    /// Adds area times leaves of both sides for the plane before each box, of so many triangles.
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

/// Equal bins along an axis over the midpoints.
struct Binning {
    axis: usize,
    start: f64,
    per_unit: f64,
}

impl Binning {
    /// `None` when all midpoints agree along the axis.
    fn new(spread: &Aabb, axis: usize) -> Option<Self> {
        let (start, end) = (f64::from(spread.min[axis]), f64::from(spread.max[axis]));
        (end > start).then(|| Self {
            axis,
            start,
            per_unit: BINS as f64 / (end - start),
        })
    }

    fn bin(&self, shape: &Shape, triangle: u32) -> usize {
        let midpoint = f64::from(shape.midpoints[triangle as usize][self.axis]);
        (((midpoint - self.start) * self.per_unit) as usize).min(BINS - 1)
    }
}
