//! Compares a tree's answers with brute force, for two bodies in every kind of shape and placement.
//!
//! ```text
//! Draw --situations (search: nearly touching)--> Situation --truth--> pairs \
//!                                               AnswerSource (Trees) --> pairs -- judge --> Counts, Reproduction (shrink)
//! ```
//!
//! [`check_containment`] checks the boxes of a posed tree against vertices that it blends itself, and
//! [`check_skinned_containment`] does so for skinned meshes.
//!
//! [`verify_motion`] does the same for contacts during motions from one situation to another.
//!
//! Answers come from the trait [`AnswerSource`], so that the comparison itself can be tested with wrong answers.

mod containment;
mod draw;
mod judge;
mod motion;
mod run;
mod search;
mod shrink;
mod situation;
mod skinned_containment;
mod source;

#[cfg(test)]
mod tests;

pub use containment::{ContainmentReport, ContainmentViolation, check_containment, check_refitted_containment};
pub use draw::Draw;
pub use judge::{Counts, Trouble, judge};
pub use motion::{MotionCounts, touch_geometry, verify_motion};
pub use run::{Finding, Verification, verify};
pub use search::nearly_touching;
pub use shrink::{Reproduction, shrink};
pub use situation::{Meshes, Situation};
pub use skinned_containment::check_skinned_containment;
pub use source::{Answer, AnswerSource, LEAF_SIZES, MotionSource, Trees};
