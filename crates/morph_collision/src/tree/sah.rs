//! The surface-area heuristic, summed over several shapes.
//!
//! Planes are placed on the base, and the cost of a split is summed over all shapes. A node is split in two, then its costliest
//! child is split again, until it has eight children or all of them can be leaves. Triangles count as the number of leaves they
//! fill, rounded up, because a leaf is tested as a whole. This makes leaves nearly full.

use std::ops::Range;

use glam::Vec3;

use super::budget::Budget;
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

/// The base: the midpoints and boxes of all triangles.
#[derive(Clone)]
pub(super) struct Base {
    pub(super) midpoints: Vec<Vec3>,
    pub(super) bounds: Vec<Aabb>,
}

/// The boxes of all triangles with one target at weight 1.
///
/// Targets of faces move a small part of a body each. So boxes that equal those of the base are not stored if they are many.
struct Moved {
    /// For each triangle, its index in `bounds`, or [`UNMOVED`]. Empty if `bounds` has a box for every triangle.
    slots: Vec<u32>,
    bounds: Vec<Aabb>,
}

const UNMOVED: u32 = u32::MAX;

impl Moved {
    fn new(base: &[Aabb], mut bounds: Vec<Aabb>) -> Self {
        let is_moved = |(base, bounds): &(&Aabb, &Aabb)| base != bounds;
        let moved = base.iter().zip(&bounds).filter(is_moved).count();
        // A box takes six times as much memory as a slot.
        if 6 * moved >= 5 * base.len() {
            let slots = Vec::new();
            return Self { slots, bounds };
        }
        let mut kept = 0;
        let slot = |(triangle, base): (usize, &Aabb)| {
            if bounds[triangle] == *base {
                return UNMOVED;
            }
            bounds[kept] = bounds[triangle];
            kept += 1;
            kept as u32 - 1
        };
        let slots = base.iter().enumerate().map(slot).collect();
        bounds.truncate(kept);
        bounds.shrink_to_fit();
        Self { slots, bounds }
    }

    /// Calls `visit` with some triangles' boxes. Written out for both kinds, because this is where a build spends its time.
    #[inline(always)]
    fn each<T: Copy>(&self, base: &Base, items: &[T], triangle: impl Fn(T) -> u32, mut visit: impl FnMut(T, &Aabb)) {
        if self.slots.is_empty() {
            items
                .iter()
                .for_each(|&item| visit(item, &self.bounds[triangle(item) as usize]));
            return;
        }
        for &item in items {
            let triangle = triangle(item) as usize;
            visit(
                item,
                match self.slots[triangle] {
                    UNMOVED => &base.bounds[triangle],
                    slot => &self.bounds[slot as usize],
                },
            );
        }
    }

    fn moves(&self, triangle: usize) -> bool {
        self.slots.get(triangle).is_none_or(|&slot| slot != UNMOVED)
    }
}

/// Splits nodes by the surface-area heuristic, summed over the base and the targets with the largest displacements, so that one
/// tree suits all shapes.
pub(super) struct Partition {
    pub(super) leaf_size: usize,
    base: Base,
    targets: Vec<Moved>,
    /// For each triangle, a bit mask of the targets that move it.
    moved_by: Vec<u16>,
}

/// A contiguous range of a node's triangles that may become a child.
struct Part {
    range: Range<usize>,
    cost: f64,
    is_divisible: bool,
}

/// Bins and their triangles, in pairs.
type Binned = Vec<(usize, u32)>;

/// The costs of both sides of the plane before each bin.
type Sides = Vec<[f64; 2]>;

/// Half of a box's surface area; 0 for an empty box.
fn half_area(bounds: &Aabb) -> f64 {
    let s = bounds.size().max(Vec3::ZERO).as_dvec3();
    s.x * s.y + s.y * s.z + s.z * s.x
}

impl Partition {
    pub(super) async fn new(model: &MorphModel, leaf_size: usize, budget: &Budget) -> Self {
        let mut targets: Vec<usize> = (0..model.target_count()).collect();
        targets.sort_by(|&i, &j| model.target_reach()[j].total_cmp(&model.target_reach()[i]));
        targets.truncate(MAX_TARGETS);
        let mut weights = vec![0.0; model.target_count()];
        let work = model.vertex_count() + model.triangle_count();
        budget.spend(work).await;
        let mut partition = Self::over(leaf_size, Base::new(model, &weights));
        for target in targets {
            budget.spend(work).await;
            weights[target] = 1.0;
            let positions = positions(model, &weights);
            partition.add_target(corners(model, &positions).map(Aabb::from_points).collect());
            weights[target] = 0.0;
        }
        partition
    }

    /// A partition by the base alone.
    pub(super) fn over(leaf_size: usize, base: Base) -> Self {
        Self {
            leaf_size,
            moved_by: vec![0; base.bounds.len()],
            targets: Vec::new(),
            base,
        }
    }

    /// Adds the triangles' boxes under the next target.
    pub(super) fn add_target(&mut self, bounds: Vec<Aabb>) {
        let moved = Moved::new(&self.base.bounds, bounds);
        let bit = 1 << self.targets.len();
        for (triangle, moved_by) in self.moved_by.iter_mut().enumerate() {
            *moved_by |= if moved.moves(triangle) { bit } else { 0 };
        }
        self.targets.push(moved);
    }

    /// Reorders the triangles child by child and returns the number of triangles of each child. There are 1 to 8 children, none
    /// empty. There is just one child if no plane separates the midpoints, or if the triangles fit a leaf.
    pub(super) async fn by_area(&self, triangles: &mut [u32], budget: &Budget) -> Vec<usize> {
        let mut parts = vec![self.part(triangles, 0..triangles.len(), budget).await];
        while parts.len() < LANES {
            let Some(costliest) = (0..parts.len())
                .filter(|&i| parts[i].is_divisible)
                .max_by(|&i, &j| parts[i].cost.total_cmp(&parts[j].cost))
            else {
                break;
            };
            let range = parts[costliest].range.clone();
            match self.halve(&mut triangles[range.clone()], budget).await {
                Some(count) => {
                    let middle = range.start + count;
                    parts[costliest] = self.part(triangles, range.start..middle, budget).await;
                    let second = self.part(triangles, middle..range.end, budget).await;
                    parts.insert(costliest + 1, second);
                }
                None => parts[costliest].is_divisible = false,
            }
        }
        parts.into_iter().map(|part| part.range.len()).collect()
    }

    async fn part(&self, triangles: &[u32], range: Range<usize>, budget: &Budget) -> Part {
        let part = &triangles[range.clone()];
        let moving = self.moving(part);
        let (mut area, mut of_base) = (0.0, 0.0);
        for shapes in self.pieces(part) {
            budget.spend(self.count(shapes.clone(), moving) * part.len()).await;
            for shape in shapes {
                let of_shape = match self.target(shape, moving) {
                    Some(target) => half_area(&self.hull(target, part)),
                    None if shape == 0 => {
                        of_base = half_area(&self.base_hull(part));
                        of_base
                    }
                    None => of_base,
                };
                area += of_shape;
            }
        }
        Part {
            cost: area * self.leaves(part.len()),
            is_divisible: part.len() > self.leaf_size,
            range,
        }
    }

    /// The targets that move any of these triangles.
    fn moving(&self, triangles: &[u32]) -> u16 {
        triangles
            .iter()
            .fold(0, |moving, &triangle| moving | self.moved_by[triangle as usize])
    }

    /// The target of a shape, unless all triangles have the same boxes as at the base. Shape 0 is the base.
    fn target(&self, shape: usize, moving: u16) -> Option<&Moved> {
        let target = shape.checked_sub(1)?;
        (moving >> target & 1 == 1).then(|| &self.targets[target])
    }

    /// The number of shapes that have to be looked at.
    fn count(&self, shapes: Range<usize>, moving: u16) -> usize {
        let is_other = |&shape: &usize| shape == 0 || self.target(shape, moving).is_some();
        shapes.filter(is_other).count()
    }

    fn base_hull(&self, triangles: &[u32]) -> Aabb {
        let bounds = triangles.iter().map(|&triangle| &self.base.bounds[triangle as usize]);
        bounds.fold(Aabb::EMPTY, |hull, bounds| hull.union(bounds))
    }

    fn hull(&self, target: &Moved, triangles: &[u32]) -> Aabb {
        let mut hull = Aabb::EMPTY;
        target.each(
            &self.base,
            triangles,
            |triangle| triangle,
            |_, bounds| hull = hull.union(bounds),
        );
        hull
    }

    /// The number of leaves that this many triangles fill, rounded up.
    fn leaves(&self, triangles: usize) -> f64 {
        triangles.div_ceil(self.leaf_size) as f64
    }

    /// Reorders the triangles by their side of the best plane. Returns the number on the first side, or `None` if no plane
    /// separates them.
    async fn halve(&self, triangles: &mut [u32], budget: &Budget) -> Option<usize> {
        let moving = self.moving(triangles);
        let mut best: Option<(f64, usize, Binned)> = None;
        for axis in 0..3 {
            budget.spend(triangles.len()).await;
            let Some((bins, binned)) = self.binned(triangles, axis) else {
                continue;
            };
            let (mut costs, mut of_base, mut sides) = (vec![0.0; bins], Sides::new(), Sides::new());
            for shapes in self.pieces(triangles) {
                budget.spend(self.count(shapes.clone(), moving) * triangles.len()).await;
                for shape in shapes {
                    let sides = match self.target(shape, moving) {
                        Some(target) => {
                            self.sides(target, &binned, bins, &mut sides);
                            &sides
                        }
                        None if shape == 0 => {
                            self.base_sides(&binned, bins, &mut of_base);
                            &of_base
                        }
                        None => &of_base,
                    };
                    for (cost, [before, after]) in costs.iter_mut().zip(sides) {
                        *cost += before;
                        *cost += after;
                    }
                }
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

    /// The base and all targets, in chunks that are small enough for a piece of work over these triangles.
    fn pieces(&self, triangles: &[u32]) -> impl Iterator<Item = Range<usize>> + use<> {
        const PIECE: usize = 1 << 14;
        let (count, size) = (1 + self.targets.len(), (PIECE / triangles.len().max(1)).max(1));
        (0..count)
            .step_by(size)
            .map(move |first| first..count.min(first + size))
    }

    /// Sets `sides` to the costs of the planes on the base.
    fn base_sides(&self, binned: &[(usize, u32)], bins: usize, sides: &mut Sides) {
        let mut boxes = vec![(Aabb::EMPTY, 0); bins];
        for &(bin, triangle) in binned {
            put(&mut boxes[bin], &self.base.bounds[triangle as usize]);
        }
        self.set_sides(&boxes, sides);
    }

    /// Sets `sides` to the costs of the planes with a target.
    fn sides(&self, target: &Moved, binned: &[(usize, u32)], bins: usize, sides: &mut Sides) {
        let mut boxes = vec![(Aabb::EMPTY, 0); bins];
        target.each(
            &self.base,
            binned,
            |(_, triangle)| triangle,
            |(bin, _), bounds| put(&mut boxes[bin], bounds),
        );
        self.set_sides(&boxes, sides);
    }

    /// The number of bins along an axis, and each triangle with its bin; `None` if one bin would hold all midpoints. A few
    /// triangles are sorted and get a bin each, so that every plane is tried. The sort is stable.
    fn binned(&self, triangles: &[u32], axis: usize) -> Option<(usize, Binned)> {
        let midpoint = |t: &u32| self.base.midpoints[*t as usize][axis];
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

    /// Sets `sides` to the cost of each side of the plane before each box: area times number of leaves. Each box comes with its number of
    /// triangles.
    fn set_sides(&self, boxes: &[(Aabb, usize)], sides: &mut Sides) {
        let add = |(hull, count): &mut (Aabb, usize), (bounds, more): &(Aabb, usize)| {
            (*hull, *count) = (hull.union(bounds), *count + more);
            half_area(hull) * self.leaves(*count)
        };
        sides.clear();
        sides.resize(boxes.len(), [0.0; 2]);
        let mut before = (Aabb::EMPTY, 0);
        for (side, of_bin) in sides.iter_mut().skip(1).zip(boxes) {
            side[0] = add(&mut before, of_bin);
        }
        let mut after = (Aabb::EMPTY, 0);
        for (side, of_bin) in sides.iter_mut().zip(boxes).rev() {
            side[1] = add(&mut after, of_bin);
        }
    }
}

/// Adds a triangle's box to those of a bin.
#[inline(always)]
fn put((hull, count): &mut (Aabb, usize), bounds: &Aabb) {
    *hull = hull.union(bounds);
    *count += 1;
}

impl Base {
    fn new(model: &MorphModel, at_rest: &[f32]) -> Self {
        let positions = positions(model, at_rest);
        let third = 1.0 / 3.0;
        let midpoint = |[a, b, c]: [Vec3; 3]| a * third + b * third + c * third;
        Self {
            midpoints: corners(model, &positions).map(midpoint).collect(),
            bounds: corners(model, &positions).map(Aabb::from_points).collect(),
        }
    }
}

/// All vertices at some weights.
fn positions(model: &MorphModel, weights: &[f32]) -> Vec<Vec3> {
    let weights = Weights::new(weights);
    let vertices = 0..model.vertex_count() as u32;
    vertices
        .map(|vertex| model.blend_vertex(vertex, &weights).into())
        .collect()
}

/// The corners of all triangles.
fn corners<'p>(model: &'p MorphModel, positions: &'p [Vec3]) -> impl Iterator<Item = [Vec3; 3]> + 'p {
    let triangles = 0..model.triangle_count() as u32;
    triangles.map(|triangle| model.corners(triangle).map(|vertex| positions[vertex as usize]))
}
