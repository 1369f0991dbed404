//! The line of a ray.

use glam::DVec3;

/// The points `origin + t direction` for real `t` from 0 to `max_t`, which may be infinite.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) origin: DVec3,
    /// Not zero; its largest absolute coordinate is around 1.
    pub(crate) direction: DVec3,
    pub(crate) max_t: f64,
}
