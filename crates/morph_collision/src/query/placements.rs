//! The set-up that queries about two bodies share.

use super::neighbourhood::Neighbourhood;
use super::patches::Patches;
use crate::bounds::{WorldFromModel, are_below_resolution, visit_frames};
use crate::pose::Posed;
use crate::traverse::Culls;

/// The placements of the two bodies of a query.
pub(super) struct Placements<'a> {
    pub(super) world_from_a: &'a WorldFromModel,
    pub(super) world_from_b: &'a WorldFromModel,
}

impl Placements<'_> {
    /// Prepares the frames in which nodes are compared; returns whether the roots overlap.
    pub(super) fn begin_culls(&self, a: &mut Posed<'_>, b: &mut Posed<'_>, culls: &mut Culls) -> bool {
        let (a, b) = (a.bounds(), b.bounds());
        let mut roots_overlap = true;
        culls.begin();
        visit_frames(self.world_from_a, &a, self.world_from_b, &b, |frames| {
            // A frame that separates the bodies is enough.
            roots_overlap = culls.push(frames, &a, &b);
            roots_overlap
        });
        roots_overlap
    }

    /// Whether both bodies are too small for culling, compared with their distance from the origin or with their rest shapes.
    pub(super) fn are_collapsed(&self, a: &mut Posed<'_>, b: &mut Posed<'_>) -> bool {
        let bounds = |tree: &mut Posed<'_>| {
            let bounds = tree.bounds();
            let rounding = f64::from(tree.rounding(bounds.size().max_element()));
            (bounds, rounding)
        };
        let [(bounds_a, rounding_a), (bounds_b, rounding_b)] = [bounds(a), bounds(b)];
        are_below_resolution([
            (self.world_from_a, &bounds_a, rounding_a),
            (self.world_from_b, &bounds_b, rounding_b),
        ])
    }

    /// Prepares the caches of leaves.
    pub(super) fn begin_leaves(&self, a: &mut Posed<'_>, b: &mut Posed<'_>, [leaves_a, leaves_b]: [&mut Patches; 2]) {
        // Close to both bodies if they touch.
        let size = self.world_from_a.scale() * f64::from(a.bounds().size().max_element());
        let neighbourhood = Neighbourhood::new(self.world_from_a.translation(), size);
        leaves_a.begin(a.topology.leaf_count(), self.world_from_a, neighbourhood);
        leaves_b.begin(b.topology.leaf_count(), self.world_from_b, neighbourhood);
    }

    /// The length in A's units of a length of 1 in B's, roughly.
    pub(super) fn a_from_b_scale(&self) -> f32 {
        (self.world_from_b.scale() / self.world_from_a.scale()) as f32
    }
}
