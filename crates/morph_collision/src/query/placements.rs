//! The set-up that queries about two bodies share.

use super::body::Body;
use super::neighbourhood::Neighbourhood;
use super::patches::Patches;
use crate::bounds::{WorldFromModel, visit_frames};
use crate::pose::Posed;
use crate::traverse::OverlapWalk;

/// The placements of the two bodies of a query.
pub(super) struct Placements<'a> {
    pub(super) world_from_a: &'a WorldFromModel,
    pub(super) world_from_b: &'a WorldFromModel,
}

impl<'a> Placements<'a> {
    pub(super) fn of(a: &Body<'a>, b: &Body<'a>) -> Self {
        Self {
            world_from_a: a.world_from_model,
            world_from_b: b.world_from_model,
        }
    }

    /// Prepares the frames in which nodes are compared; returns whether the roots overlap.
    pub(super) fn begin_walk(&self, a: &mut Posed<'_>, b: &mut Posed<'_>, walk: &mut OverlapWalk) -> bool {
        let (a, b) = (a.bounds(), b.bounds());
        let mut roots_overlap = true;
        walk.begin(self.a_from_b_scale());
        visit_frames(self.world_from_a, &a, self.world_from_b, &b, |frames| {
            // A frame that separates the bodies is enough.
            roots_overlap = walk.push_frame(frames, &a, &b);
            roots_overlap
        });
        roots_overlap
    }

    /// Whether both bodies are so small, compared with their distance from the origin or with their rest shapes, that the slack
    /// for rounding is not small beside them. Culling is then useless.
    pub(super) fn are_collapsed(&self, a: &mut Posed<'_>, b: &mut Posed<'_>) -> bool {
        /// Bodies this many times larger than the slack are culled well. Not measured; it decides only the speed.
        const RESOLVED: f64 = 16.0;
        let size_and_slack = |place: &WorldFromModel, tree: &mut Posed<'_>| {
            let bounds = tree.bounds();
            let (size, linear) = (bounds.size().as_dvec3(), place.linear());
            let rounding = f64::from(tree.rounding(bounds.size().max_element()));
            let slack = place.placement_error(bounds.magnitude().as_dvec3()).max_element() + rounding * place.scale();
            let [x, y, z] = [linear.x_axis * size.x, linear.y_axis * size.y, linear.z_axis * size.z];
            (x.abs().max(y.abs()).max(z.abs()).max_element(), slack)
        };
        let (size_a, slack_a) = size_and_slack(self.world_from_a, a);
        let (size_b, slack_b) = size_and_slack(self.world_from_b, b);
        size_a.max(size_b) <= RESOLVED * (slack_a + slack_b)
    }

    /// Prepares the caches of patches.
    pub(super) fn begin_leaves(&self, a: &mut Posed<'_>, [patches_a, patches_b]: [&mut Patches; 2]) {
        // Close to both bodies if they touch.
        let size = self.world_from_a.scale() * f64::from(a.bounds().size().max_element());
        let neighbourhood = Neighbourhood::new(self.world_from_a.translation(), size);
        patches_a.begin(neighbourhood);
        patches_b.begin(neighbourhood);
    }

    /// The length in A's units of a length of 1 in B's, roughly.
    pub(super) fn a_from_b_scale(&self) -> f32 {
        (self.world_from_b.scale() / self.world_from_a.scale()) as f32
    }
}
