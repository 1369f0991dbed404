//! The setup that queries about two bodies share.

use fearless_simd::{Level, Simd};

use super::neighbourhood::Neighbourhood;
use crate::bounds::{FrameLanes, visit_frames, with_simd};
use crate::pose::{PlacedBody, Posed};
use crate::traverse::OverlapWalk;

/// The two bodies of a query.
#[derive(Clone, Copy)]
pub(in crate::query) struct PlacedPair<'a> {
    pub(in crate::query) a: &'a PlacedBody,
    pub(in crate::query) b: &'a PlacedBody,
}

impl<'a> PlacedPair<'a> {
    pub(in crate::query) fn of(a: &'a mut Posed<'_>, b: &'a mut Posed<'_>) -> Self {
        Self {
            a: a.placed_body(),
            b: b.placed_body(),
        }
    }

    /// Prepares the frames in which nodes are compared; returns whether the roots overlap.
    #[inline]
    pub(in crate::query) fn begin_walk(&self, walk: &mut OverlapWalk, level: Level) -> bool {
        walk.begin([self.a, self.b], self.a_from_b_scale());
        with_simd!(level, simd => self.push_frames(simd, walk))
    }

    #[inline(always)]
    fn push_frames<S: Simd>(&self, simd: S, walk: &mut OverlapWalk) -> bool {
        let mut roots_overlap = true;
        visit_frames(
            simd,
            &self.a.placed,
            &self.b.placed,
            #[inline(always)]
            |frames: [Option<&FrameLanes<S>>; 2]| {
                // One frame that separates the bodies is enough.
                roots_overlap = walk.push_frame(simd, frames, &self.a.bounds, &self.b.bounds);
                roots_overlap
            },
        );
        roots_overlap
    }

    /// Whether both bodies are so small, compared with their distance from the origin or with their rest shapes, that the slack for
    /// rounding is not small compared with their size. Culling is then useless.
    #[inline]
    pub(in crate::query) fn are_collapsed(&self) -> bool {
        Self::are_small([self.a, self.b].map(|placed_body| (placed_body.size, placed_body.slack)))
    }

    /// [`PlacedPair::are_collapsed`], for two bodies with these sizes and this much slack.
    #[inline]
    pub(in crate::query) fn are_small([(size_a, slack_a), (size_b, slack_b)]: [(f64, f64); 2]) -> bool {
        /// Bodies this many times larger than the slack are culled well. Not measured; it affects only the speed.
        const RESOLVED: f64 = 16.0;
        size_a.max(size_b) <= RESOLVED * (slack_a + slack_b)
    }

    /// A neighbourhood that is close to both bodies if they touch.
    pub(in crate::query) fn neighbourhood(&self) -> Neighbourhood {
        let world_from_model = self.a.placed.world_from_model();
        let size = world_from_model.scale() * f64::from(self.a.bounds.size().max_element());
        Neighbourhood::new(world_from_model.translation(), size)
    }

    /// Roughly the factor that converts lengths in B's units to A's.
    pub(in crate::query) fn a_from_b_scale(&self) -> f32 {
        let [a, b] = [self.a, self.b].map(|placed_body| placed_body.placed.world_from_model().scale());
        (b / a) as f32
    }
}
