//! Tight boxes for weights that rest.
//!
//! An anchor holds every box of the tree fitted to the vertices at weights `w*`; a node at weights `w` is the anchor's
//! box moved by the interval form of `w - w*`. It is exact for weights that do not move: the sliders of a character
//! that were set once cost nothing afterwards.

use glam::Vec3;

use crate::bounds::{Aabb, BoxLanes};
use crate::model::MorphModel;
use crate::tree::{ChildKind, Leaf, Topology};

/// Tight boxes of all groups at some weights.
#[derive(Clone, Debug)]
pub(super) struct Anchor {
    pub(super) boxes: Vec<BoxLanes>,
    /// The weights they were fitted at, one per target of the model.
    weights: Vec<f32>,
    /// The weights in force minus those.
    differences: Vec<f32>,
}

/// What one group needs of an [`Anchor`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchored<'a> {
    pub(super) boxes: &'a BoxLanes,
    pub(super) weights: &'a [f32],
    pub(super) differences: &'a [f32],
}

impl Anchor {
    /// Fits every box to the vertices at `weights`; `O(n)`.
    pub(super) fn fit(model: &MorphModel, topology: &Topology, weights: &[f32]) -> Self {
        let vertices: Vec<Vec3> = (0..model.vertex_count() as u32)
            .map(|vertex| model.blend_vertex(vertex, weights))
            .collect();
        let mut boxes = vec![BoxLanes::default(); topology.group_count()];
        fit_bottom_up(topology, &mut boxes, |leaf| {
            let corners = topology.leaf_triangles(leaf).iter();
            let corners = corners.flat_map(|&triangle| model.triangle(triangle as usize));
            Aabb::from_points(corners.map(|vertex| vertices[vertex as usize]))
        });
        Self {
            boxes,
            weights: weights.to_vec(),
            differences: Vec::new(),
        }
    }

    pub(super) fn follow(&mut self, weights: &[f32]) {
        let anchored = self.weights.iter();
        self.differences.clear();
        self.differences
            .extend(weights.iter().zip(anchored).map(|(w, anchored)| w - anchored));
    }

    pub(super) fn group(&self, group: usize) -> Anchored<'_> {
        Anchored {
            boxes: &self.boxes[group],
            weights: &self.weights,
            differences: &self.differences,
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.boxes) + 2 * size_of_val(&*self.weights)
    }
}

/// Makes the boxes of every group, by number, from those of the leaves.
pub(super) fn fit_bottom_up(topology: &Topology, boxes: &mut [BoxLanes], mut leaf_box: impl FnMut(Leaf) -> Aabb) {
    // Groups are in preorder: children come later.
    for group in (0..boxes.len()).rev() {
        for (lane, child) in topology.group(group).children().iter().enumerate() {
            let bounds = match child.kind() {
                ChildKind::Group(below) => boxes[below].hull(topology.group(below).mask()),
                ChildKind::Leaf(leaf) => leaf_box(leaf),
            };
            boxes[group].set(lane, &bounds);
        }
    }
}
