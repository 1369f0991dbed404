//! Binned surface-area heuristic, over one shape or summed over several.
//!
//! Planes are placed on the first shape; what a split costs is summed over all of them. A node gets more than two children
//! by splitting the costliest child again.

use std::ops::Range;

use super::partition::Shape;
use crate::bounds::Aabb;

const BINS: usize = 16;

/// Reorders the triangles child by child; the children's lengths, a single one if their midpoints are all the same.
pub(super) fn split(shape: &Shape, others: &[Shape], arity: usize, triangles: &mut [u32]) -> Vec<usize> {
    let mut parts = vec![Part::new(shape, others, triangles, 0..triangles.len())];
    while parts.len() < arity {
        let Some(costliest) = (0..parts.len())
            .filter(|&i| parts[i].divisible)
            .max_by(|&i, &j| parts[i].cost.total_cmp(&parts[j].cost))
        else {
            break;
        };
        let range = parts[costliest].range.clone();
        match halve(shape, others, &mut triangles[range.clone()]) {
            Some(count) => {
                let middle = range.start + count;
                let halves = [range.start..middle, middle..range.end];
                let halves = halves.map(|half| Part::new(shape, others, triangles, half));
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
    fn new(shape: &Shape, others: &[Shape], triangles: &[u32], range: Range<usize>) -> Self {
        let part = &triangles[range.clone()];
        let area: f64 = shapes(shape, others).map(|shape| half_area(&hull(shape, part))).sum();
        Self {
            cost: area * part.len() as f64,
            divisible: part.len() > 1,
            range,
        }
    }
}

fn shapes<'a>(shape: &'a Shape, others: &'a [Shape]) -> impl Iterator<Item = &'a Shape> + Clone {
    std::iter::once(shape).chain(others)
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

/// Sorts the triangles to two sides of the best plane; how many are on the first side, `None` if no plane parts them.
fn halve(shape: &Shape, others: &[Shape], triangles: &mut [u32]) -> Option<usize> {
    let spread = Aabb::from_points(triangles.iter().map(|&t| shape.midpoints[t as usize]));
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        let Some(binning) = Binning::new(&spread, axis) else {
            continue;
        };
        let mut counts = [0_usize; BINS];
        for &t in &*triangles {
            counts[binning.bin(shape, t)] += 1;
        }
        let mut costs = [0.0; BINS];
        for measured in shapes(shape, others) {
            let mut bins = [Aabb::EMPTY; BINS];
            for &t in &*triangles {
                let bin = &mut bins[binning.bin(shape, t)];
                *bin = bin.union(&measured.bounds[t as usize]);
            }
            add_costs(&bins, &counts, &mut costs);
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
    let first_side = |t: u32| binning.bin(shape, t) < plane;
    let count = triangles.iter().filter(|&&t| first_side(t)).count();
    triangles.sort_by_key(|&t| !first_side(t));
    Some(count)
}

/// Adds area times count of both sides for the plane before each bin.
fn add_costs(bins: &[Aabb; BINS], counts: &[usize; BINS], costs: &mut [f64; BINS]) {
    let (mut hull, mut count) = (Aabb::EMPTY, 0);
    for i in 1..BINS {
        hull = hull.union(&bins[i - 1]);
        count += counts[i - 1];
        costs[i] += half_area(&hull) * count as f64;
    }
    let (mut hull, mut count) = (Aabb::EMPTY, 0);
    for i in (1..BINS).rev() {
        hull = hull.union(&bins[i]);
        count += counts[i];
        costs[i] += half_area(&hull) * count as f64;
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
