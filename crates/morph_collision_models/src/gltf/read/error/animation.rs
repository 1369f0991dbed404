//! What can be wrong with an animation.

use super::{AccessorProblem, Remedy};
use crate::gltf::read::document::ElementError;
use crate::memory::OverBudget;
use crate::text::Printable;

/// A problem with an animation of weights or joints.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum AnimationProblem {
    /// The animation's JSON is malformed.
    #[error("it {0}")]
    Element(ElementError),
    /// A channel's JSON is malformed.
    #[error("channel {channel} {problem}")]
    Channel {
        /// The channel's index in the animation.
        channel: usize,
        /// The problem.
        problem: ElementError,
    },
    /// A channel would take more memory than the file may.
    #[error("channel {channel}: {over}")]
    OverBudget {
        /// The channel's index in the animation.
        channel: usize,
        /// The part that exceeds the limit.
        over: OverBudget,
    },
    /// A tangent of a cubic spline is not finite.
    #[error("channel {channel}, key {key}, target {target}: the tangent {tangent} is not finite")]
    Tangent {
        /// The channel's index in the animation.
        channel: usize,
        /// The key's index.
        key: usize,
        /// The target's index.
        target: usize,
        /// The tangent.
        tangent: f32,
    },
    /// A channel animates a part of the file that this reader does not animate.
    #[error("channel {channel} animates {}, which is not applied", Printable(pointer))]
    NotApplied {
        /// The channel's index in the animation.
        channel: usize,
        /// The pointer to the part.
        pointer: String,
    },
    /// A channel needs a sampler, a node or a mesh that does not exist or is malformed.
    #[error("channel {channel}: {what} {index} {problem}")]
    Dangling {
        /// The channel's index in the animation.
        channel: usize,
        /// A sampler, a node or a mesh.
        what: &'static str,
        /// Its index: in the animation for a sampler, otherwise in the file.
        index: usize,
        /// The problem.
        problem: ElementError,
    },
    /// A sampler's accessor cannot be decoded.
    #[error("channel {channel}, {what}: {problem}")]
    Accessor {
        /// The channel's index in the animation.
        channel: usize,
        /// Key times or weights.
        what: &'static str,
        /// Why it cannot be decoded.
        problem: AccessorProblem,
    },
    /// A sampler's interpolation is not one that glTF defines.
    #[error("channel {channel} has an unknown interpolation")]
    UnknownInterpolation {
        /// The channel's index in the animation.
        channel: usize,
    },
    /// The number of keys does not match the number of weights.
    #[error("channel {channel} has {found} weights, but {keys} keys of {targets} targets need {expected}")]
    WeightCount {
        /// The channel's index in the animation.
        channel: usize,
        /// The number of weights in the file.
        found: usize,
        /// The number of keys.
        keys: usize,
        /// The number of targets of the mesh.
        targets: usize,
        /// The number of weights there should be.
        expected: usize,
    },
    /// The number of keys does not match the number of translations, rotations or scales.
    #[error("channel {channel} has {found} {what}, but {keys} keys need {expected}")]
    ValueCount {
        /// The channel's index in the animation.
        channel: usize,
        /// Translations, rotations or scales.
        what: &'static str,
        /// The number in the file.
        found: usize,
        /// The number of keys.
        keys: usize,
        /// The number there should be.
        expected: usize,
    },
    /// A translation, rotation or scale is not finite.
    #[error("channel {channel}, key {key}: the {what} are not finite")]
    NotFinite {
        /// The channel's index in the animation.
        channel: usize,
        /// The key's index.
        key: usize,
        /// Translations, rotations or scales.
        what: &'static str,
    },
    /// A key's time is not finite, or earlier than the key before it.
    #[error("channel {channel}, key {key} is at {time} s, which is not after the key before it")]
    KeyOrder {
        /// The channel's index in the animation.
        channel: usize,
        /// The key's index.
        key: usize,
        /// Its time.
        time: f32,
    },
    /// A weight is not finite.
    #[error("channel {channel}, key {key}, target {target}: the weight {weight} is not finite")]
    Weight {
        /// The channel's index in the animation.
        channel: usize,
        /// The key's index.
        key: usize,
        /// The target's index.
        target: usize,
        /// The weight.
        weight: f32,
    },
}

impl AnimationProblem {
    pub(super) fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget { .. } => Some(Remedy::MoreMemory),
            Self::Element(problem) | Self::Channel { problem, .. } | Self::Dangling { problem, .. } => problem.remedy(),
            Self::Accessor { problem, .. } => problem.remedy(),
            _ => None,
        }
    }
}
