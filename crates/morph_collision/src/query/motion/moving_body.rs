//! A body at the start and at the end of a motion.

use std::sync::Arc;

use crate::input_error::InputError;
use crate::query::Body;
use crate::tree::MorphBvh;

/// A body that moves: the same mesh at the start and at the end of a step.
///
/// Every vertex moves on a straight line from its position in the world at the start to that at the end.
#[derive(Debug)]
pub struct MovingBody<'a> {
    pub(super) start: Body<'a>,
    pub(super) end: Body<'a>,
}

impl<'a> MovingBody<'a> {
    /// Creates a moving body from its states at the start and at the end.
    ///
    /// In a loop over frames, keep two poses and swap them: the one that was the end is the next start, and keeps its cache.
    ///
    /// # Errors
    /// [`InputError`] if the poses are of different trees.
    pub fn new(start: Body<'a>, end: Body<'a>) -> Result<Self, InputError> {
        if Arc::ptr_eq(&start.pose.bvh().topology, &end.pose.bvh().topology) {
            return Ok(Self { start, end });
        }
        Err(InputError::DifferentTrees {
            what: "start and end of a moving body".to_owned(),
        })
    }

    /// The mesh's tree.
    pub(super) fn bvh(&self) -> Arc<MorphBvh> {
        self.start.pose.bvh().clone()
    }

    /// Borrows the body again, to use it in several queries.
    #[must_use]
    pub fn reborrow(&mut self) -> MovingBody<'_> {
        MovingBody {
            start: self.start.reborrow(),
            end: self.end.reborrow(),
        }
    }
}
