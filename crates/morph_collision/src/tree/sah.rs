//! The surface-area heuristic, summed over several shapes.
//!
//! Planes are placed on the base, and the cost of a split is summed over all shapes. A node is split in two, then its costliest
//! child is split again, until it has eight children or all of them can be leaves. Triangles count as the number of leaves they
//! fill, rounded up, because a leaf is tested as a whole. This makes leaves nearly full.

use std::ops::Range;

use glam::Vec3;

use super::pace::Pace;
use crate::bounds::{Aabb, LANES};
use crate::model::{MorphModel, Weights};

/// Bins per axis. Not measured; a common choice.
const BINS: usize = 16;
/// If a node's triangles fill at most this many leaves, every plane is tried instead of only those between bins, at a cost of
/// `O(n log n)`. The number is not measured; without this, queries cost up to 2 % more (docs/tried.md).
const SWEPT_LEAVES: usize = 8;

/// The maximum number of targets that a split considers besides the base. Build time grows with it. The number is not measured;
/// with splits on the base only, queries take 0.91 to 1.08 times as long (docs/tried.md), so more targets can gain little.
const MAX_TARGETS: usize = 16;

/// The midpoints and boxes of all triangles of one shape.
#[derive(Clone)]
pub(super) struct Shape {
    pub(super) midpoints: Vec<Vec3>,
    pub(super) bounds: Vec<Aabb>,
}

impl Shape {
    fn new(model: &MorphModel, weights: &[f32]) -> Self {
        let weights = Weights::new(weights);
        let vertices = 0..model.vertex_count() as u32;
        let positions: Vec<Vec3> = vertices
            .map(|vertex| model.blend_vertex(vertex, &weights).into())
            .collect();
        let (midpoints, bounds) = (0..model.triangle_count() as u32)
            .map(|triangle| {
                let corners = model.corners(triangle).map(|vertex| positions[vertex as usize]);
                let third = 1.0 / 3.0;
                let midpoint = corners[0] * third + corners[1] * third + corners[2] * third;
                (midpoint, Aabb::from_points(corners))
            })
            .unzip();
        Self { midpoints, bounds }
    }
}

/// Splits nodes by the surface-area heuristic, summed over the base and the targets with the largest displacements, so that one
/// tree suits all shapes.
pub(super) struct Partition {
    pub(super) leaf_size: usize,
    /// The base comes first.
    pub(super) shapes: Vec<Shape>,
}

/// A contiguous range of a node's triangles that may become a child.
struct Part {
    range: Range<usize>,
    cost: f64,
    is_divisible: bool,
}

/// Bins and their triangles, in pairs.
type Binned = Vec<(usize, u32)>;

fn hull(shape: &Shape, triangles: &[u32]) -> Aabb {
    let bounds = triangles.iter().map(|&triangle| shape.bounds[triangle as usize]);
    bounds.fold(Aabb::EMPTY, |hull, bounds| hull.union(&bounds))
}

/// Half of a box's surface area; 0 for an empty box.
fn half_area(bounds: &Aabb) -> f64 {
    let s = bounds.size().max(Vec3::ZERO).as_dvec3();
    s.x * s.y + s.y * s.z + s.z * s.x
}

impl Partition {
    pub(super) async fn new(model: &MorphModel, leaf_size: usize, pace: &Pace) -> Self {
        let mut targets: Vec<usize> = (0..model.target_count()).collect();
        targets.sort_by(|&i, &j| model.target_reach()[j].total_cmp(&model.target_reach()[i]));
        targets.truncate(MAX_TARGETS);
        let mut weights = vec![0.0; model.target_count()];
        let work = model.vertex_count() + model.triangle_count();
        pace.spend(work).await;
        let mut shapes = vec![Shape::new(model, &weights)];
        for target in targets {
            pace.spend(work).await;
            weights[target] = 1.0;
            shapes.push(Shape::new(model, &weights));
            weights[target] = 0.0;
        }
        Self { leaf_size, shapes }
    }

    /// Reorders the triangles child by child and returns the number of triangles of each child. There are 1 to 8 children, none
    /// empty. There is just one child if no plane separates the midpoints, or if the triangles fit a leaf.
    pub(super) async fn by_area(&self, triangles: &mut [u32], pace: &Pace) -> Vec<usize> {
        let mut parts = vec![self.part(triangles, 0..triangles.len(), pace).await];
        while parts.len() < LANES {
            let Some(costliest) = (0..parts.len())
                .filter(|&i| parts[i].is_divisible)
                .max_by(|&i, &j| parts[i].cost.total_cmp(&parts[j].cost))
            else {
                break;
            };
            let range = parts[costliest].range.clone();
            match self.halve(&mut triangles[range.clone()], pace).await {
                Some(count) => {
                    let middle = range.start + count;
                    parts[costliest] = self.part(triangles, range.start..middle, pace).await;
                    let second = self.part(triangles, middle..range.end, pace).await;
                    parts.insert(costliest + 1, second);
                }
                None => parts[costliest].is_divisible = false,
            }
        }
        parts.into_iter().map(|part| part.range.len()).collect()
    }

    async fn part(&self, triangles: &[u32], range: Range<usize>, pace: &Pace) -> Part {
        let part = &triangles[range.clone()];
        let mut area = 0.0;
        for shapes in self.pieces(part) {
            pace.spend(shapes.len() * part.len()).await;
            area = shapes
                .iter()
                .fold(area, |area, shape| area + half_area(&hull(shape, part)));
        }
        Part {
            cost: area * self.leaves(part.len()),
            is_divisible: part.len() > self.leaf_size,
            range,
        }
    }

    /// The number of leaves that this many triangles fill, rounded up.
    fn leaves(&self, triangles: usize) -> f64 {
        triangles.div_ceil(self.leaf_size) as f64
    }

    /// Reorders the triangles by their side of the best plane. Returns the number on the first side, or `None` if no plane
    /// separates them.
    async fn halve(&self, triangles: &mut [u32], pace: &Pace) -> Option<usize> {
        let mut best: Option<(f64, usize, Binned)> = None;
        for axis in 0..3 {
            pace.spend(triangles.len()).await;
            let Some((bins, binned)) = self.binned(triangles, axis) else {
                continue;
            };
            let mut costs = vec![0.0; bins];
            for shapes in self.pieces(triangles) {
                pace.spend(shapes.len() * triangles.len()).await;
                shapes
                    .iter()
                    .for_each(|shape| self.add_shape(shape, &binned, &mut costs));
            }
            // Breaks ties in favour of the middle, for example if no triangle has any area.
            let imbalance = |plane: usize| (2 * plane).abs_diff(bins);
            // Plane `i` is before bin `i`. Neither side is empty, because the first and the last bin are not.
            let planes = costs.into_iter().enumerate().skip(1);
            let cheapest = planes.min_by(|(i, a), (j, b)| a.total_cmp(b).then(imbalance(*i).cmp(&imbalance(*j))));
            if let Some((plane, cost)) = cheapest
                && best.as_ref().is_none_or(|(least, ..)| cost < *least)
            {
                best = Some((cost, plane, binned));
            }
        }
        let (_, plane, binned) = best?;
        let (first, second): (Vec<_>, Vec<_>) = binned.into_iter().partition(|&(bin, _)| bin < plane);
        for (slot, (_, triangle)) in triangles.iter_mut().zip(first.iter().chain(&second)) {
            *slot = *triangle;
        }
        Some(first.len())
    }

    /// All shapes, in chunks that are small enough for a piece of work over these triangles.
    fn pieces(&self, triangles: &[u32]) -> std::slice::Chunks<'_, Shape> {
        const PIECE: usize = 1 << 14;
        self.shapes.chunks((PIECE / triangles.len().max(1)).max(1))
    }

    /// Adds to the cost of the plane before each bin its cost on one shape.
    fn add_shape(&self, shape: &Shape, binned: &[(usize, u32)], costs: &mut [f64]) {
        let mut boxes = vec![(Aabb::EMPTY, 0); costs.len()];
        for &(bin, triangle) in binned {
            let (bounds, count) = &mut boxes[bin];
            *bounds = bounds.union(&shape.bounds[triangle as usize]);
            *count += 1;
        }
        self.add_costs(boxes.into_iter(), costs);
    }

    /// The number of bins along an axis, and each triangle with its bin; `None` if one bin would hold all midpoints. A few
    /// triangles are sorted and get a bin each, so that every plane is tried. The sort is stable.
    fn binned(&self, triangles: &[u32], axis: usize) -> Option<(usize, Binned)> {
        let midpoint = |t: &u32| self.shapes[0].midpoints[*t as usize][axis];
        if triangles.len() <= SWEPT_LEAVES * self.leaf_size {
            let mut sorted = triangles.to_vec();
            sorted.sort_by(|s, t| midpoint(s).total_cmp(&midpoint(t)));
            return Some((sorted.len(), sorted.into_iter().enumerate().collect()));
        }
        let start = triangles.iter().map(midpoint).fold(f32::INFINITY, f32::min);
        let end = triangles.iter().map(midpoint).fold(f32::NEG_INFINITY, f32::max);
        let per_unit = BINS as f64 / (f64::from(end) - f64::from(start));
        let bin = |t: &u32| ((f64::from(midpoint(t)) - f64::from(start)) * per_unit) as usize;
        let binned = || triangles.iter().map(|t| (bin(t).min(BINS - 1), *t)).collect();
        (end > start).then(|| (BINS, binned()))
    }

    /// Adds to the cost of the plane before each box: area times number of leaves, for both sides. Each box comes with its number of
    /// triangles.
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
