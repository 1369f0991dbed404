//! What a look at an entity says.

use std::time::Duration;

/// What is known after a look at one aspect of an entity.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    Done,
    /// Something is missing that may still come.
    Again,
}

/// The time between two frames for apps without a clock.
pub(super) const FRAME: Duration = Duration::from_nanos(16_666_667);
