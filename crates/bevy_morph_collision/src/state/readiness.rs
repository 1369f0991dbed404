//! Which readiness event a collider got last.

use crate::import::TreeKey;

/// The last event that a collider got.
#[derive(Clone, Copy, Default, PartialEq)]
pub(crate) enum Readiness {
    #[default]
    Nothing,
    /// It is ready, with this tree; `None` for a shape.
    Ready(Option<TreeKey>),
    /// This mesh cannot be used.
    Failed(TreeKey),
}
