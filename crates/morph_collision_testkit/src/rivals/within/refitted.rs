//! A tree that is refitted, and its walk.

use std::sync::Arc;

use morph_collision::{QueryStats, TrianglePair};

use super::super::PoseError;
use super::super::blended::WeldedMesh;
use super::super::bottom_up::box_around;
use super::super::boxes::{Box3, Box8};
use super::super::build::{Builder, Cut, Limits};
use super::super::tree::{Child, Tree, VertexLists};
use super::SelfMethod;
use super::posed::Posed;

/// A tree whose boxes are all refitted, and a walk over it and itself.
#[derive(Debug)]
pub(super) struct Refitted {
    body: Posed,
    tree: Tree,
    leaves: VertexLists,
    boxes: Vec<Box8>,
    /// Whether the boxes of a node's children are compared at once.
    is_wide: bool,
    work: QueryStats,
}

/// A child of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Node {
    group: u32,
    lane: u8,
}

impl Refitted {
    pub(super) fn new(mesh: &Arc<WeldedMesh>, cut: Cut, limits: Limits) -> Self {
        let mut tree = Tree::default();
        Builder::default().build(&mut tree, &mesh.triangles, &mesh.base, cut, limits);
        let is_leaf = |child| matches!(child, Child::Leaf(_));
        let mut refitted = Self {
            body: Posed::new(mesh),
            leaves: VertexLists::new(&tree, &mesh.triangles, |_, child| is_leaf(child)),
            boxes: vec![Box8::default(); tree.groups.len()],
            is_wide: limits.arity > 2,
            tree,
            work: QueryStats::default(),
        };
        refitted.refit();
        refitted.work = QueryStats::default();
        refitted
    }

    fn refit(&mut self) {
        // Children come after their parents.
        for (index, group) in self.tree.groups.iter().enumerate().rev() {
            for (lane, &child) in group.children().iter().enumerate() {
                let one = match child {
                    Child::Leaf(_) => box_around(self.leaves.of(index, lane), &self.body.vertices),
                    Child::Group(below) => {
                        let below = below as usize;
                        self.boxes[below].hull(self.tree.groups[below].children().len())
                    }
                };
                self.boxes[index].set(lane, &one);
            }
        }
        self.work.nodes_blended += self.tree.node_count();
    }

    fn child(&self, node: Node) -> Child {
        self.tree.groups[node.group as usize].children()[usize::from(node.lane)]
    }

    fn box_of(&self, node: Node) -> Box3 {
        self.boxes[node.group as usize].get(usize::from(node.lane))
    }

    /// The children of a group from a lane on that overlap a box, as a mask.
    fn overlapping(&mut self, group: u32, from: usize, other: &Box3) -> u8 {
        let (boxes, count) = (
            &self.boxes[group as usize],
            self.tree.groups[group as usize].children().len(),
        );
        self.work.node_tests += (count - from) as u64;
        if self.is_wide {
            return boxes.overlap_mask(other) & u8::MAX << from;
        }
        let lanes = (from..count).filter(|&lane| boxes.get(lane).overlaps(other));
        lanes.fold(0, |mask, lane| mask | 1 << lane)
    }

    fn walk(&mut self, pairs: &mut Vec<TrianglePair>) {
        let root = Node { group: 0, lane: 0 };
        let mut stack = vec![(root, root)];
        while let Some((a, b)) = stack.pop() {
            if a == b {
                match self.child(a) {
                    Child::Leaf(leaf) => self.leaves(leaf, leaf, pairs),
                    Child::Group(group) => {
                        let count = self.tree.groups[group as usize].children().len();
                        for lane in 0..count {
                            let node = Node {
                                group,
                                lane: lane as u8,
                            };
                            stack.push((node, node));
                            if lane + 1 < count {
                                let mask = self.overlapping(group, lane + 1, &self.box_of(node));
                                stack.extend(lanes(group, mask).map(|other| (node, other)));
                            }
                        }
                    }
                }
                continue;
            }
            let size = |of: Box3| (of.max - of.min).element_sum();
            let (group, other) = match (self.child(a), self.child(b)) {
                (Child::Leaf(a), Child::Leaf(b)) => {
                    self.leaves(a, b, pairs);
                    continue;
                }
                (Child::Group(_), Child::Group(group)) if size(self.box_of(a)) < size(self.box_of(b)) => (group, a),
                (Child::Group(group), _) => (group, b),
                (Child::Leaf(_), Child::Group(group)) => (group, a),
            };
            let mask = self.overlapping(group, 0, &self.box_of(other));
            stack.extend(lanes(group, mask).map(|child| (child, other)));
        }
    }

    fn leaves(&mut self, a: u32, b: u32, pairs: &mut Vec<TrianglePair>) {
        let (of_a, of_b) = (self.tree.leaf(a), self.tree.leaf(b));
        for (i, &one) in of_a.iter().enumerate() {
            let from = if a == b { i + 1 } else { 0 };
            for &other in &of_b[from..] {
                self.body.test(one, other, &mut self.work, pairs);
            }
        }
    }
}

/// The children of a group in a mask.
fn lanes(group: u32, mask: u8) -> impl Iterator<Item = Node> {
    (0..8)
        .filter(move |lane| mask >> lane & 1 == 1)
        .map(move |lane| Node { group, lane })
}

impl SelfMethod for Refitted {
    fn find(&mut self, weights: &[f32], pairs: &mut Vec<TrianglePair>) -> Result<(), PoseError> {
        if self.body.set(weights, &mut self.work)? {
            self.refit();
        }
        self.walk(pairs);
        Ok(())
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}
