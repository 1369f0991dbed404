//! How the boxes of a skinned body are mapped to the frames of a query.

use super::mapped_group::FRAMES;
use crate::bounds::Frame;
use crate::pose::{BoxTree, EpochCache};
use crate::traverse::mapping::Mapping;

/// How a skinned body's boxes, which are in the spaces of its joints, are mapped to the frames.
#[derive(Debug, Default)]
pub(super) struct JointMappings {
    is_skinned: bool,
    /// The map from the body's space to each frame; `None` if they are the same space.
    frames: [Option<Frame>; FRAMES],
    /// Indexed by joint space.
    mappings: EpochCache<[Mapping; FRAMES]>,
}

impl JointMappings {
    pub(super) fn begin(&mut self, is_skinned: bool) {
        self.is_skinned = is_skinned;
        if is_skinned {
            self.mappings.next_epoch();
        }
    }

    #[inline]
    pub(super) fn push_frame(&mut self, index: usize, frame: Option<&Frame>) {
        if self.is_skinned {
            self.frames[index] = frame.copied();
        }
    }

    pub(super) fn mappings(&mut self, tree: &mut impl BoxTree, frame: usize) -> &[Mapping; FRAMES] {
        let slot = self.mappings.find(frame).unwrap_or_else(|| {
            let to_body = tree.body_from_joint_frame(frame);
            let slot = self.mappings.claim(frame);
            for (mapping, frame) in self.mappings.get_mut(slot).iter_mut().zip(&self.frames) {
                match &to_body {
                    Some(to_body) => mapping.set(Some(&frame.as_ref().map_or(*to_body, |frame| frame.after(to_body)))),
                    None => mapping.set_unbounded(),
                }
            }
            slot
        });
        self.mappings.get(slot)
    }
}
