//! Where a core is.

use glam::{DMat3, DVec3};

use crate::exact::largest;

/// Takes a core's own space to world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Frame {
    pub(in super::super) rotation: DMat3,
    pub(in super::super) center: DVec3,
}

impl Frame {
    /// Along the world's axes.
    pub(super) fn at(center: DVec3) -> Self {
        Self {
            rotation: DMat3::IDENTITY,
            center,
        }
    }

    pub(super) fn local(&self, point: DVec3) -> DVec3 {
        self.local_direction(point - self.center)
    }

    pub(super) fn local_direction(&self, direction: DVec3) -> DVec3 {
        self.rotation.transpose() * direction
    }

    pub(super) fn world(&self, local: DVec3) -> DVec3 {
        self.rotation * local + self.center
    }

    /// The largest distance that a corner of a local box has moved. It bounds how far any point in the box has moved, up to rounding of the
    /// lengths.
    pub(super) fn displacement_from(&self, before: &Self, low: DVec3, high: DVec3) -> f64 {
        let corners = (0..8).map(|i| {
            let pick = |bit: usize, axis: usize| if i & bit == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(1, 0), pick(2, 1), pick(4, 2))
        });
        largest(corners.map(|corner| self.world(corner).distance(before.world(corner))))
    }
}
