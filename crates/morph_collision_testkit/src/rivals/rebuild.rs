//! A tree of the posed triangles, rebuilt whenever they have moved: the cost of always having a tree that fits the
//! shape.

use glam::Vec3;

use super::MethodOptions;
use super::blended::WeldedMesh;
use super::boxes::{Box3, Box8};
use super::build::{Builder, Cut, Limits};
use super::tree::{Child, Tree};
use super::walk::Refit;

/// A tree whose topology and boxes are updated at once.
#[derive(Clone, Debug)]
pub(super) struct Rebuild {
    builder: Builder,
    tree: Tree,
    limits: Limits,
    boxes: Vec<Box8>,
}

impl Refit for Rebuild {
    const LAZY: bool = false;

    fn new(_: &WeldedMesh, options: &MethodOptions) -> Self {
        Self {
            builder: Builder::default(),
            tree: Tree::default(),
            limits: Limits {
                arity: options.arity.clamp(2, 8),
                leaf_size: options.tree.leaf_size(),
            },
            boxes: Vec::new(),
        }
    }

    fn update(&mut self, mesh: &WeldedMesh, posed: &[Vec3]) -> u64 {
        self.builder
            .build(&mut self.tree, &mesh.triangles, posed, Cut::Middle, self.limits);
        self.boxes.clear();
        self.boxes.resize(self.tree.groups.len(), Box8::default());
        let corners = |triangle: u32| mesh.triangles[triangle as usize].map(|vertex| posed[vertex as usize]);
        for (index, group) in self.tree.groups.iter().enumerate().rev() {
            for (lane, &child) in group.children().iter().enumerate() {
                let one = match child {
                    Child::Leaf(leaf) => Box3::of(self.tree.leaf(leaf).iter().flat_map(|&t| corners(t))),
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
