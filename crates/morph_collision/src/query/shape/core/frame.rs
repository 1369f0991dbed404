//! Where a core is.

use glam::{DMat3, DQuat, DVec3};

use crate::exact::largest;
use crate::input_error::{InputError, check_number, check_vector};

/// The largest value allowed in a [`Shape`](crate::Shape) or its placement.
pub(in super::super) const LARGEST: f64 = 1e37;

/// Takes a core's own space to world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Frame {
    pub(in super::super) rotation: DMat3,
    pub(in super::super) center: DVec3,
}

impl Frame {
    pub(in super::super) fn new(rotation: DQuat, center: DVec3) -> Result<Self, InputError> {
        let length = rotation.length();
        check_number("length of the rotation", length, (length - 1.0).abs() <= 1e-3, "1")?;
        check_vector("translation", center, LARGEST)?;
        Ok(Self {
            rotation: DMat3::from_quat(rotation.normalize()),
            center,
        })
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
