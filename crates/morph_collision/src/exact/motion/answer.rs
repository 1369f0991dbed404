//! What a stage of the decision returns.

use super::moving::TimeOfImpact;

/// What a stage found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Answer {
    /// No contact at any time.
    Apart,
    /// Contact. The interval contains the first time, if that was asked for, otherwise any time of contact.
    Contact(TimeOfImpact),
    /// A sign is not certain.
    Open,
}
