//! Builds a tree over triangles in their current positions, top-down.

use glam::{Vec3, Vec3A};

use super::boxes::Box3;
use super::tree::{Child, Group, Tree};

/// Bins along an axis.
const BINS: usize = 16;

/// How to cut triangles in two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// At the lowest cost by the binned surface-area heuristic: a good tree.
    Sah,
    /// In the middle of the midpoints' extents, along their longest axis: a tree that is fast to
    /// build.
    Middle,
}

/// Most children of a node, and most triangles in a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) arity: usize,
    pub(super) leaf_size: usize,
}

/// A triangle's index and midpoint, moved together.
#[derive(Clone, Copy, Debug)]
struct Item {
    midpoint: Vec3,
    triangle: u32,
}

/// Memory reused from build to build.
#[derive(Clone, Debug, Default)]
pub(super) struct Builder {
    items: Vec<Item>,
    /// Per triangle; only for the surface-area heuristic.
    boxes: Vec<Box3>,
}

impl Builder {
    /// Builds `tree` over posed triangles.
    pub(super) fn build(&mut self, tree: &mut Tree, corners: &[[u32; 3]], posed: &[Vec3], cut: Cut, limits: Limits) {
        let points = |corners: &[u32; 3]| corners.map(|vertex| posed[vertex as usize]);
        self.items.clear();
        self.items.extend((0..).zip(corners).map(|(triangle, corners)| {
            let [p, q, r] = points(corners);
            let midpoint = p * (1.0 / 3.0) + q * (1.0 / 3.0) + r * (1.0 / 3.0);
            Item { midpoint, triangle }
        }));
        self.boxes.clear();
        if cut == Cut::Sah {
            let boxes = corners.iter().map(|corners| Box3::of(points(corners).into_iter()));
            self.boxes.extend(boxes);
        }
        tree.groups.clear();
        tree.leaf_starts.clear();
        tree.triangles.clear();
        tree.leaf_starts.push(0);
        tree.groups.push(Group::new(0));
        let mut descent = Descent {
            tree,
            boxes: &self.boxes,
            cut,
            limits,
        };
        let root = descent.node(&mut self.items, 1);
        tree.groups[0].push(root);
    }
}

struct Descent<'a> {
    tree: &'a mut Tree,
    boxes: &'a [Box3],
    cut: Cut,
    limits: Limits,
}

impl Descent<'_> {
    fn node(&mut self, items: &mut [Item], depth: usize) -> Child {
        if items.len() <= self.limits.leaf_size {
            let leaf = self.tree.leaf_starts.len() - 1;
            self.tree.triangles.extend(items.iter().map(|item| item.triangle));
            self.tree.leaf_starts.push(self.tree.triangles.len() as u32);
            return Child::Leaf(leaf as u32);
        }
        let group = self.tree.groups.len();
        self.tree.groups.push(Group::new(depth));
        let (mut ends, mut parts) = ([0; 8], 1);
        ends[0] = items.len();
        while parts < self.limits.arity {
            let start = |part: usize| if part == 0 { 0 } else { ends[part - 1] };
            let Some(largest) = (0..parts)
                .filter(|&part| ends[part] - start(part) > 1)
                .max_by(|&p, &q| {
                    let weight = |part| self.weight(&items[start(part)..ends[part]]);
                    weight(p).total_cmp(&weight(q))
                })
            else {
                break;
            };
            let begin = start(largest);
            let count = self.cut(&mut items[begin..ends[largest]]);
            ends.copy_within(largest..parts, largest + 1);
            ends[largest] = begin + count;
            parts += 1;
        }
        let mut rest = items;
        for part in 0..parts {
            let begin = if part == 0 { 0 } else { ends[part - 1] };
            let (of_part, others) = rest.split_at_mut(ends[part] - begin);
            let child = self.node(of_part, depth + 1);
            self.tree.groups[group].push(child);
            rest = others;
        }
        Child::Group(group as u32)
    }

    /// A part's priority: the most expensive part is cut next.
    fn weight(&self, items: &[Item]) -> f32 {
        match self.cut {
            Cut::Sah => self.hull(items).half_area() * items.len() as f32,
            Cut::Middle => items.len() as f32,
        }
    }

    fn hull(&self, items: &[Item]) -> Box3 {
        let boxes = items.iter().map(|item| &self.boxes[item.triangle as usize]);
        boxes.fold(Box3::EMPTY, |hull, one| hull.union(one))
    }

    /// Sorts items into two sides, neither empty; returns how many are in the first.
    fn cut(&self, items: &mut [Item]) -> usize {
        let spread = Box3::of(items.iter().map(|item| item.midpoint));
        let first = match self.cut {
            Cut::Middle => {
                let axis = longest_axis(spread.max - spread.min);
                let middle = 0.5 * spread.min[axis] + 0.5 * spread.max[axis];
                partition(items, |item| item.midpoint[axis] < middle)
            }
            Cut::Sah => self.cheapest(items, &spread).map_or(0, |(axis, plane)| {
                partition(items, |item| bin(&spread, axis, item) < plane)
            }),
        };
        // All midpoints are in one place, so any halves will do.
        if first == 0 || first == items.len() {
            items.len() / 2
        } else {
            first
        }
    }

    /// The axis, and the bin to cut before.
    fn cheapest(&self, items: &[Item], spread: &Box3) -> Option<(usize, usize)> {
        let mut best: Option<(f32, usize, usize)> = None;
        for axis in (0..3).filter(|&axis| spread.max[axis] > spread.min[axis]) {
            let mut bins = [(Box3::EMPTY, 0_u32); BINS];
            for item in items {
                let (hull, count) = &mut bins[bin(spread, axis, item)];
                *hull = hull.union(&self.boxes[item.triangle as usize]);
                *count += 1;
            }
            let mut costs = [0.0; BINS];
            let (mut hull, mut count) = (Box3::EMPTY, 0);
            for plane in 1..BINS {
                hull = hull.union(&bins[plane - 1].0);
                count += bins[plane - 1].1;
                costs[plane] = hull.half_area() * count as f32;
            }
            (hull, count) = (Box3::EMPTY, 0);
            for plane in (1..BINS).rev() {
                hull = hull.union(&bins[plane].0);
                count += bins[plane].1;
                let cost = costs[plane] + hull.half_area() * count as f32;
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, plane));
                }
            }
        }
        best.map(|(_, axis, plane)| (axis, plane))
    }
}

fn bin(spread: &Box3, axis: usize, item: &Item) -> usize {
    let (start, end) = (spread.min[axis], spread.max[axis]);
    // Halving keeps the difference within `f32`.
    let share = (0.5 * item.midpoint[axis] - 0.5 * start) / (0.5 * end - 0.5 * start);
    ((share * BINS as f32) as usize).min(BINS - 1)
}

fn longest_axis(size: Vec3A) -> usize {
    if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    }
}

/// Moves the items for which `first` holds to the front; returns their number.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        if first(&items[i]) {
            items.swap(i, count);
            count += 1;
        }
    }
    count
}
