//! The boxes of a node's children in every frame of a query.

use fearless_simd::Simd;

use crate::bounds::{BoxLanes, LANES, Lanes};
use crate::traverse::mapping::Mapping;
use crate::tree::Child;

/// Node pairs are compared in this many frames.
pub(super) const FRAMES: usize = 2;

/// The children of a node in every frame.
#[derive(Clone, Debug, Default)]
pub(super) struct MappedGroup {
    pub(super) frames: [BoxLanes; FRAMES],
    /// The sums of the boxes' sides, in the first body's units.
    pub(super) sizes: Lanes,
    pub(super) children: [Child; LANES],
    pub(super) group: u32,
    pub(super) mask: u8,
    pub(super) len: u8,
}

impl MappedGroup {
    #[inline(always)]
    pub(super) fn fill<S: Simd>(&mut self, simd: S, boxes: &BoxLanes, mappings: &[Mapping], scale: f32) {
        for (frame, mapping) in self.frames.iter_mut().zip(mappings) {
            mapping.all(simd, boxes, frame);
        }
        boxes.girths(simd, scale, &mut self.sizes);
    }

    /// The children that overlap a child of another body in the first `frames` frames, as a bit mask.
    #[inline(always)]
    pub(super) fn overlaps<S: Simd>(&self, simd: S, other: &Self, lane: usize, frames: usize) -> u8 {
        let mut mask = self.mask;
        for (own, other) in self.frames.iter().zip(&other.frames).take(frames) {
            mask &= own.overlap_mask(simd, &other.get(lane));
            if mask == 0 {
                break;
            }
        }
        mask
    }

    /// Roughly how deep each child overlaps a child of another body.
    #[inline(always)]
    pub(super) fn depths<S: Simd>(&self, simd: S, other: &Self, lane: usize) -> [f32; LANES] {
        let mut depths = [0.0; LANES];
        self.frames[0].depths(simd, &other.frames[0].get(lane), &mut depths);
        depths
    }
}
