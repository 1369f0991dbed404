//! Larsson and Akenine-Moller's hybrid (*Collision detection for continuously deforming bodies*, Eurographics 2001), the
//! method that the morphing paper compares itself with. When the vertices have moved, the upper half of the tree's levels
//! is refitted bottom-up; the nodes below are refitted top-down when a walk reaches them.

use std::sync::Arc;

use glam::Vec3;

use super::MethodOptions;
use super::blended::WeldedMesh;
use super::bottom_up::{box_around, tree_at_rest};
use super::boxes::Box8;
use super::tree::{Child, Tree, VertexLists};
use super::walk::Refit;

/// A tree whose upper half of levels is updated at once, and the rest on demand.
#[derive(Clone, Debug)]
pub(super) struct Hybrid {
    tree: Arc<Tree>,
    /// The vertices under every node that is refitted from its vertices: leaves, and all nodes from the middle level down.
    vertices: Arc<VertexLists>,
    /// The groups above the middle level, children after their parents.
    upper: Arc<Vec<u32>>,
    /// Groups at this depth are the last to be updated at once.
    middle: u8,
    boxes: Vec<Box8>,
    /// The frame in which a group's boxes were computed.
    stamps: Vec<u32>,
    frame: u32,
}

impl Hybrid {
    /// Computes the boxes of a group. A child whose own group is up to date takes that group's hull.
    fn refit(&mut self, index: usize, posed: &[Vec3]) -> u64 {
        let group = &self.tree.groups[index];
        for (lane, &child) in group.children().iter().enumerate() {
            let one = match child {
                Child::Group(below) if group.depth < self.middle => {
                    let below = below as usize;
                    self.boxes[below].hull(self.tree.groups[below].children().len())
                }
                _ => box_around(self.vertices.of(index, lane), posed),
            };
            self.boxes[index].set(lane, &one);
        }
        self.stamps[index] = self.frame;
        group.children().len() as u64
    }
}

impl Refit for Hybrid {
    const LAZY: bool = true;

    fn new(mesh: &WeldedMesh, options: &MethodOptions) -> Self {
        let tree = tree_at_rest(mesh, options);
        let deepest = tree.groups.iter().map(|group| group.depth).max().unwrap_or(0);
        let middle = deepest / 2;
        let upper = (0..).zip(&tree.groups).filter(|(_, group)| group.depth <= middle);
        Self {
            upper: Arc::new(upper.map(|(index, _)| index).collect()),
            vertices: Arc::new(VertexLists::new(&tree, &mesh.triangles, |group, child| {
                group.depth >= middle || matches!(child, Child::Leaf(_))
            })),
            middle,
            boxes: vec![Box8::default(); tree.groups.len()],
            stamps: vec![0; tree.groups.len()],
            frame: 0,
            tree: Arc::new(tree),
        }
    }

    fn update(&mut self, _: &WeldedMesh, posed: &[Vec3]) -> u64 {
        self.frame = self.frame.wrapping_add(1);
        if self.frame == 0 {
            self.stamps.fill(0);
            self.frame = 1;
        }
        let upper = Arc::clone(&self.upper);
        upper.iter().rev().map(|&group| self.refit(group as usize, posed)).sum()
    }

    #[inline]
    fn open(&mut self, group: usize, posed: &[Vec3]) -> u64 {
        if self.stamps[group] == self.frame {
            return 0;
        }
        self.refit(group, posed)
    }

    fn tree(&self) -> &Tree {
        &self.tree
    }

    #[inline]
    fn boxes(&self, group: usize) -> &Box8 {
        &self.boxes[group]
    }
}
