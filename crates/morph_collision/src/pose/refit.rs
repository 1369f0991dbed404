//! Boxes that are fitted to posed vertices at once, instead of being blended when a query visits them.

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use super::blend::max_widening;
use super::blended_vertices::BlendedVertices;
use super::box_source::BoxSource;
use super::fitted_boxes::{around, unbounded};
use super::posed::Posed;
use super::skinning::Skinning;
use crate::bounds::{Corners, LANES, with_simd};
use crate::tree::{ChildKind, SkinTables, Source};

/// The first group below the root's children. Those bound the body: they do not depend on earlier queries.
const FIRST_BELOW: usize = 2;

impl Posed<'_> {
    /// Replaces all cached boxes with tight ones, in one pass over the tree. Vertices that are posed already are not posed again. Cost: `O(n)`.
    pub(super) fn refit(&mut self) {
        self.boxes.next_epoch();
        with_simd!(self.level, simd => self.fit_all(simd));
    }

    #[inline(always)]
    fn fit_all<S: Simd>(&mut self, simd: S) {
        self.pose_all(simd);
        let topology = self.topology;
        self.blended.volumes += topology.node_count() as u64;
        let groups = 0..topology.group_count();
        let (vertices, widening) = all_points(self.skin.as_ref(), self.vertices);
        self.fitted.fit(simd, topology, groups, vertices, widening, self.boxes);
    }

    /// Replaces all cached boxes: poses all vertices and fits the boxes of the upper half of the levels to them. [`Posed::fit`] fits the others.
    pub(super) fn refit_upper(&mut self) {
        self.boxes.next_epoch();
        self.fit_upper(0);
    }

    /// Fits a group's boxes, unless they have to be blended. Returns their slot.
    #[inline]
    pub(super) fn fit_instead(&mut self, group: usize) -> Option<usize> {
        let is_below = group >= FIRST_BELOW;
        match *self.source {
            BoxSource::Refitted => {}
            BoxSource::FittedBelow(_) if is_below => {}
            BoxSource::Loose if is_below => {
                *self.source = BoxSource::FittedBelow(max_widening(self.model, self.weights));
                self.fit_upper(FIRST_BELOW);
                if let Some(slot) = self.boxes.find(group) {
                    return Some(slot);
                }
            }
            _ => return None,
        }
        Some(self.fit(group))
    }

    /// Poses all vertices and fits the boxes of the upper half of the levels to them, from a group on.
    fn fit_upper(&mut self, first: usize) {
        with_simd!(self.level, simd => self.pose_all(simd));
        let topology = self.topology;
        let lowest = topology.depth.saturating_sub(1) / 2;
        // Parents come before their children. The root counts as one level with its children.
        let (mut upper, mut rest) = (vec![0], vec![(topology.group(0).child(0), 0)]);
        while let Some((node, depth)) = rest.pop() {
            if let ChildKind::Group(group) = node.kind() {
                upper.push(group);
                if depth < lowest {
                    rest.extend(topology.group(group).children().iter().map(|&child| (child, depth + 1)));
                }
            }
        }
        for group in upper.into_iter().rev().filter(|&group| group >= first) {
            self.fit_group(group);
        }
    }

    /// Fits a group's boxes to vertices, which are all posed. Returns their slot.
    fn fit(&mut self, group: usize) -> usize {
        if let Some(tree) = self.skin_tree()
            && let Source::Chunk(_) = tree.skin.chunks.source(group)
        {
            return self.open_skinned(group);
        }
        self.fit_group(group)
    }

    fn fit_group(&mut self, group: usize) -> usize {
        with_simd!(self.level, simd => self.fit_children(simd, group))
    }

    /// Fits the boxes of a group's children: to the boxes below them, if these are cached, or else to their vertices.
    #[inline(always)]
    fn fit_children<S: Simd>(&mut self, simd: S, group: usize) -> usize {
        let topology = self.topology;
        let (vertices, mut widening) = all_points(self.skin.as_ref(), self.vertices);
        if let BoxSource::FittedBelow(by) = *self.source {
            widening = by;
        }
        let children = topology.group(group).children();
        self.blended.volumes += children.len() as u64;
        if widening == f32::INFINITY {
            return unbounded(self.boxes, group);
        }
        let mut lanes = [Corners::default(); LANES];
        for (&child, lane) in children.iter().zip(&mut lanes) {
            let cached = match child.kind() {
                ChildKind::Group(below) => self.boxes.find(below).zip(Some(below)),
                ChildKind::Leaf(_) => None,
            };
            if let Some((slot, below)) = cached {
                let hull = self.boxes.get(slot).hull(simd, topology.group(below).children().len());
                *lane = [hull.min, hull.max].map(|corner| corner.extend(0.0).to_array());
            } else {
                let [low, high] = around(simd, topology.vertices_below(child), vertices, widening);
                low.store_slice(&mut lane[0]);
                high.store_slice(&mut lane[1]);
            }
        }
        let slot = self.boxes.claim(group);
        self.boxes.get_mut(slot).set_corners(simd, &lanes);
        slot
    }

    #[inline(always)]
    fn pose_all<S: Simd>(&mut self, simd: S) {
        self.blended.vertices += match (self.skin_tree(), &mut self.skin) {
            (Some(tree), Some((_, skinning))) => skinning.pose_all(simd, tree),
            _ => self.vertices.blend_all(simd, self.model, self.weights),
        };
    }
}

/// The positions of all vertices in the space of the boxes, and by how much they are rounded.
#[inline(always)]
fn all_points<'p>(
    skin: Option<&'p (&SkinTables, &mut Skinning)>,
    vertices: &'p BlendedVertices,
) -> (&'p [[f32; 4]], f32) {
    match skin {
        Some((_, skinning)) => (skinning.vertices.local(), skinning.widening()),
        None => (vertices.points(), 0.0),
    }
}
