//! Traversals' access to the root's children of a skinned mesh, which are blended one by one: whichever a query needs.

use super::posed::Posed;
use crate::bounds::{Aabb, BoxLanes, PlacedBounds};
use crate::tree::{BODY_FRAME, RootChildren};

impl Posed<'_> {
    /// Whether a group is that of the root's children, and these are blended one by one.
    #[inline(always)]
    pub(super) fn is_one_by_one(&self, group: usize) -> bool {
        match &self.skin {
            Some((tables, _)) => tables
                .root_children
                .as_ref()
                .is_some_and(|children| children.group == group),
            None => false,
        }
    }

    /// Whether a query about one body starts a group with [`Posed::outer_boxes`], and calls [`Posed::blended_child`] for each child that it
    /// cannot rule out.
    #[inline(always)]
    pub(crate) fn is_lazy(&self, group: usize) -> bool {
        self.is_one_by_one(group) && !self.is_open(group)
    }

    /// The group with which a query about one body starts.
    #[inline]
    pub(crate) fn first_group(&self) -> usize {
        let top = self.top_group();
        if self.is_lazy(top) { top } else { 0 }
    }

    /// The body in the world, for a query that starts at [`Posed::first_group`].
    pub(crate) fn placed(&mut self) -> PlacedBounds {
        match &self.skin {
            Some((_, skinning)) if self.first_group() > 0 => skinning.placed(BODY_FRAME),
            _ => self.placed_body().placed,
        }
    }

    /// A box around each child of the root in the body's frame: the blended box if it has been blended for this pose, otherwise a looser
    /// one, from one box per child and joint. Also returns a mask of the latter. `None` if the children are always blended together.
    #[inline(never)]
    pub(crate) fn outer_boxes(&mut self) -> Option<(&BoxLanes, u8)> {
        let tree = self.skin_tree()?;
        let (_, skinning) = self.skin.as_mut()?;
        let outer = skinning.outer(tree)?;
        Some((&outer.boxes, outer.are_outer))
    }

    /// The blended box of a child of the root in the body's frame.
    #[inline(never)]
    pub(crate) fn blended_child(&mut self, lane: usize) -> Aabb {
        let Some(tree) = self.skin_tree() else {
            return Aabb::UNBOUNDED;
        };
        let (Some(RootChildren { first, .. }), Some((_, skinning))) = (&tree.skin.root_children, &mut self.skin) else {
            return Aabb::UNBOUNDED;
        };
        let (bounds, was_blended) = skinning.root_child(tree, *first, lane);
        self.blended.volumes += u64::from(was_blended);
        bounds
    }

    /// Blends all children of the root. Returns false if they are not blended one by one.
    pub(super) fn blend_children(&mut self, group: usize, boxes: &mut BoxLanes) -> bool {
        if !self.is_one_by_one(group) {
            return false;
        }
        for lane in 0..self.topology.group(group).children().len() {
            let bounds = self.blended_child(lane);
            boxes.set(lane, &bounds);
        }
        true
    }
}
