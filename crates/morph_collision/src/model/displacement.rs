//! A displacement of a vertex.

use glam::Vec3;

/// The displacement of one vertex by one target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Displacement {
    pub(crate) target: u16,
    pub(crate) delta: Vec3,
}
