//! Points that move on straight lines, and times of impact.

use glam::DVec3;

/// A point that moves from `start` at time 0 to `end` at time 1, on a straight line and at constant speed.
///
/// Its place at time `t` is `start + t (end - start)` in real arithmetic, without any rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingPoint {
    /// Where the point is at time 0.
    pub start: DVec3,
    /// Where the point is at time 1.
    pub end: DVec3,
}

impl MovingPoint {
    /// A point that moves from `start` to `end`.
    #[must_use]
    pub const fn new(start: DVec3, end: DVec3) -> Self {
        Self { start, end }
    }

    /// A point that does not move.
    #[must_use]
    pub const fn resting(position: DVec3) -> Self {
        Self {
            start: position,
            end: position,
        }
    }

    /// Where the point is at a time, rounded.
    pub(crate) fn at(&self, time: f64) -> DVec3 {
        self.start * (1.0 - time) + self.end * time
    }

    /// Whether all coordinates are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.start.is_finite() && self.end.is_finite()
    }
}

/// When two moving features touch first. Times go from 0 to 1.
///
/// The first time of contact is in the closed interval from `earliest` to `latest`. Nothing touches before `earliest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeOfImpact {
    /// The first contact is not before this time. 0 if the features touch at the start.
    pub earliest: f64,
    /// The first contact is not after this time.
    pub latest: f64,
}
