//! Van den Bergen's method (*Efficient collision detection of complex deformable models using AABB trees*, Journal of
//! Graphics Tools 2, 1997): a tree built once. Whenever the vertices have moved, all its boxes are refitted from the
//! leaves up.

use std::sync::Arc;

use glam::Vec3;

use super::MethodOptions;
use super::blended::WeldedMesh;
use super::boxes::{Box3, Box8};
use super::build::{Builder, Cut, Limits};
use super::tree::{Child, Tree, VertexLists};
use super::walk::Refit;

/// A tree whose boxes are all updated at once.
#[derive(Clone, Debug)]
pub(super) struct BottomUp {
    tree: Arc<Tree>,
    leaves: Arc<VertexLists>,
    boxes: Vec<Box8>,
}

/// The tree of [`BottomUp`] and the hybrid: a good one, because it is built only once.
pub(super) fn tree_at_rest(mesh: &WeldedMesh, options: &MethodOptions) -> Tree {
    let mut tree = Tree::default();
    let limits = Limits {
        arity: options.arity.clamp(2, 8),
        leaf_size: options.tree.leaf_size(),
    };
    Builder::default().build(&mut tree, &mesh.triangles, &mesh.base, Cut::Sah, limits);
    tree
}

/// The box around some vertices.
#[inline]
pub(super) fn box_around(vertices: &[u32], posed: &[Vec3]) -> Box3 {
    Box3::of(vertices.iter().map(|&vertex| posed[vertex as usize]))
}

impl Refit for BottomUp {
    const LAZY: bool = false;

    fn new(mesh: &WeldedMesh, options: &MethodOptions) -> Self {
        let tree = tree_at_rest(mesh, options);
        let is_leaf = |child| matches!(child, Child::Leaf(_));
        Self {
            leaves: Arc::new(VertexLists::new(&tree, &mesh.triangles, |_, child| is_leaf(child))),
            boxes: vec![Box8::default(); tree.groups.len()],
            tree: Arc::new(tree),
        }
    }

    fn update(&mut self, _: &WeldedMesh, posed: &[Vec3]) -> u64 {
        // Children come after their parents.
        for (index, group) in self.tree.groups.iter().enumerate().rev() {
            for (lane, &child) in group.children().iter().enumerate() {
                let one = match child {
                    Child::Leaf(_) => box_around(self.leaves.of(index, lane), posed),
                    Child::Group(below) => {
                        let below = below as usize;
                        self.boxes[below].hull(self.tree.groups[below].children().len())
                    }
                };
                self.boxes[index].set(lane, &one);
            }
        }
        self.tree.node_count()
    }

    fn open(&mut self, _: usize, _: &[Vec3]) -> u64 {
        0
    }

    fn tree(&self) -> &Tree {
        &self.tree
    }

    #[inline]
    fn boxes(&self, group: usize) -> &Box8 {
        &self.boxes[group]
    }
}
