//! A tree over the boxes of all colliders, so that a query visits only a few of them.
//!
//! The first query after a run with changes updates the tree. While colliders move, its boxes are refitted. The tree is rebuilt
//! when refitting has made the boxes loose, or when many colliders were added or removed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use bevy::math::FloatOrd;
use bevy::prelude::*;
use morph_collision::Aabb;

/// The maximum number of boxes in a leaf.
const LEAF_SIZE: usize = 4;
/// The tree is rebuilt when its looseness has grown by this factor. Not tuned by measurement.
const MAX_GROWTH: f32 = 2.0;

/// A tree over colliders, which it identifies by their index in a sorted list of colliders.
#[derive(Clone, Debug, Default)]
pub(super) struct ColliderIndex {
    /// The run of the list from which it was last updated.
    pub(super) version: u64,
    /// In preorder: a node precedes its descendants, and its first child comes right after it.
    nodes: Vec<Node>,
    items: Vec<Item>,
    /// The colliders among the items, ascending, with their item numbers.
    members: Vec<(Entity, u32)>,
    /// Places of colliders outside the tree: those added since it was built, and those whose boxes are not finite.
    loose: Vec<(u32, Aabb)>,
    /// The looseness when the tree was built.
    built_looseness: f32,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// The number of items in a leaf; 0 for an inner node, whose `start` is then the second child.
    count: u32,
    start: u32,
}

#[derive(Clone, Copy, Debug)]
struct Item {
    bounds: Aabb,
    /// The index in the list of colliders; [`GONE`] if the collider was removed.
    index: u32,
}

const GONE: u32 = u32::MAX;

impl ColliderIndex {
    /// Takes over the current boxes of the colliders. The list is sorted by entity.
    ///
    /// Costs `O(n)`, and `O(n log n)` when the tree is rebuilt.
    pub(super) fn update(&mut self, colliders: impl ExactSizeIterator<Item = (Entity, Aabb)> + Clone) {
        let all = colliders.len();
        self.loose.clear();
        self.items.iter_mut().for_each(|item| {
            *item = Item {
                bounds: Aabb::EMPTY,
                index: GONE,
            };
        });
        let (mut came, mut found) = (0, 0);
        let mut members = self.members.iter().peekable();
        for (index, (entity, bounds)) in (0..).zip(colliders.clone()) {
            while members.next_if(|(member, _)| *member < entity).is_some() {}
            if let Some(&(_, item)) = members.next_if(|(member, _)| *member == entity) {
                self.items[item as usize] = Item { bounds, index };
                found += 1;
            } else {
                came += usize::from(is_bounded(&bounds));
                self.loose.push((index, bounds));
            }
        }
        let went = self.members.len() - found;
        self.fit();
        if came + went > 32 + all.isqrt() || self.looseness() > MAX_GROWTH * self.built_looseness {
            self.build(colliders);
        }
    }

    fn build(&mut self, colliders: impl Iterator<Item = (Entity, Aabb)>) {
        self.nodes.clear();
        self.items.clear();
        self.members.clear();
        self.loose.clear();
        let mut inside = Vec::new();
        for (index, (entity, bounds)) in (0..).zip(colliders) {
            if is_bounded(&bounds) {
                inside.push((entity, Item { bounds, index }));
            } else {
                self.loose.push((index, bounds));
            }
        }
        self.split(&mut inside);
        self.members.sort_unstable();
        self.fit();
        self.built_looseness = self.looseness();
    }

    /// Adds a node for some colliders and everything below it. Splits them in half by the centres of their boxes, along the axis
    /// with the largest spread.
    fn split(&mut self, inside: &mut [(Entity, Item)]) {
        let node = self.nodes.len();
        self.nodes.push(Node {
            bounds: Aabb::EMPTY,
            count: 0,
            start: self.items.len() as u32,
        });
        if inside.len() <= LEAF_SIZE {
            self.nodes[node].count = inside.len() as u32;
            for (entity, item) in inside {
                self.members.push((*entity, self.items.len() as u32));
                self.items.push(*item);
            }
            return;
        }
        let centers = Aabb::from_points(inside.iter().map(|(_, item)| item.bounds.center()));
        let axis = centers.size().max_position();
        let middle = inside.len() / 2;
        inside.select_nth_unstable_by(middle, |(a, x), (b, y)| {
            let along = |item: &Item| item.bounds.center()[axis];
            along(x).total_cmp(&along(y)).then(a.cmp(b))
        });
        let (low, high) = inside.split_at_mut(middle);
        self.split(low);
        self.nodes[node].start = self.nodes.len() as u32;
        self.split(high);
    }

    /// Refits all nodes, from the last one to the root.
    fn fit(&mut self) {
        for node in (0..self.nodes.len()).rev() {
            let Node { count, start, .. } = self.nodes[node];
            let start = start as usize;
            self.nodes[node].bounds = match count {
                0 if start > node => self.nodes[node + 1].bounds.union(&self.nodes[start].bounds),
                _ => {
                    let items = &self.items[start..start + count as usize];
                    items.iter().fold(Aabb::EMPTY, |hull, item| hull.union(&item.bounds))
                }
            };
        }
    }

    /// The sum of the sizes of all nodes, relative to that of the root; 0 without nodes.
    fn looseness(&self) -> f32 {
        let sizes = self
            .nodes
            .iter()
            .map(|node| &node.bounds)
            .filter(|bounds| !is_empty(bounds));
        let mut sizes = sizes.map(|bounds| bounds.size().element_sum());
        match sizes.next() {
            // Boxes that are no longer finite have to leave the tree.
            Some(f32::INFINITY) => f32::INFINITY,
            Some(root) if root > 0.0 => 1.0 + sizes.sum::<f32>() / root,
            _ => 0.0,
        }
    }

    /// Calls `at` with the places of colliders in ascending order of their bounds, until all remaining bounds are above the limit
    /// that `at` returns.
    ///
    /// `bound` computes a lower bound for everything in a box, or `None` if the box contains nothing of interest. It must be
    /// monotonic: never lower for a smaller box.
    pub(super) fn walk(
        &self,
        queue: &mut Queue,
        mut limit: f32,
        mut bound: impl FnMut(&Aabb) -> Option<f32>,
        mut at: impl FnMut(usize) -> f32,
    ) {
        queue.clear();
        let mut offer = |queue: &mut Queue, bounds: &Aabb, what: Queued, limit: f32| {
            if is_empty(bounds) {
                return;
            }
            if let Some(bound) = bound(bounds).filter(|bound| bound.is_nan() || *bound <= limit) {
                queue.push(Reverse((FloatOrd(bound), what)));
            }
        };
        for (index, bounds) in &self.loose {
            offer(queue, bounds, Queued::Collider(*index), limit);
        }
        if let Some(root) = self.nodes.first() {
            offer(queue, &root.bounds, Queued::Node(0), limit);
        }
        while let Some(Reverse((FloatOrd(lowest), what))) = queue.pop() {
            if lowest > limit {
                break;
            }
            let node = match what {
                Queued::Collider(index) => {
                    limit = at(index as usize);
                    continue;
                }
                Queued::Node(node) => node,
            };
            let Node { count, start, .. } = self.nodes[node as usize];
            if count == 0 && start > node {
                for child in [node + 1, start] {
                    offer(queue, &self.nodes[child as usize].bounds, Queued::Node(child), limit);
                }
            } else {
                for item in &self.items[start as usize..(start + count) as usize] {
                    offer(queue, &item.bounds, Queued::Collider(item.index), limit);
                }
            }
        }
    }
}

fn is_bounded(bounds: &Aabb) -> bool {
    bounds.min.is_finite() && bounds.max.is_finite()
}

fn is_empty(bounds: &Aabb) -> bool {
    bounds.min.x > bounds.max.x
}

/// The nodes and items still to visit, lowest bound first. A NaN bound comes before all others. Walks reuse the memory.
pub(super) type Queue = BinaryHeap<Reverse<(FloatOrd, Queued)>>;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Queued {
    Node(u32),
    Collider(u32),
}

#[cfg(test)]
#[path = "index_tests.rs"]
mod tests;
