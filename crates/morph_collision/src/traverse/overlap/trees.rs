//! The two trees of a walk.

/// The trees of the first and of the second body.
pub(super) struct Trees<'t, T> {
    pub(super) a: &'t mut T,
    pub(super) b: &'t mut T,
}
