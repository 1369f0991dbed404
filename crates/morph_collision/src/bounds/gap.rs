//! Lower bounds, in `f64`, on the world distance between boxes of two bodies.

use glam::{DMat3, DVec3};

use super::frame::{Frames, PlacedBounds, frames_in_world, relative};
use super::rounding::U64;
use super::{Aabb, Frame};

/// A box given by its center and half size.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Box64 {
    pub(crate) center: DVec3,
    pub(crate) half: DVec3,
}

impl Box64 {
    /// Converts a box. The slack of a [`GapFrame`] covers the roundings.
    #[inline]
    pub(crate) fn of(bounds: &Aabb) -> Self {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        Self {
            center: 0.5 * (min + max),
            half: 0.5 * (max - min),
        }
    }
}

/// A frame for the boxes of two bodies, with a lower bound on the world lengths of its vectors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GapFrame {
    pub(super) frames: Frames,
    /// A vector `v` of the frame is at least `sqrt(sum metric_i v_i^2)` long in the world.
    metric: DVec3,
    /// The error bound for comparing two boxes in the frame. It covers all roundings.
    pub(super) slack: DVec3,
}

impl GapFrame {
    /// The frames of two placed bodies: the space of each body whose map can be inverted.
    ///
    /// World space is added if neither can be inverted, or if both are so sheared that their coordinates say little about
    /// lengths.
    pub(crate) fn list(a: &PlacedBounds, b: &PlacedBounds) -> Vec<Self> {
        let mut any_faithful = false;
        let mut list = Vec::new();
        for (gap, kept) in [Self::of_a(a, b), Self::of_b(a, b)].into_iter().flatten() {
            // Not measured; it only affects how often the third frame is computed.
            any_faithful |= kept > 0.5;
            list.push(gap);
        }
        if !any_faithful {
            list.push(Self::world(a, b));
        }
        list
    }

    /// The space of the first body, and the second result of [`diagonal_below`]; `None` if its map has no inverse.
    fn of_a(a: &PlacedBounds, b: &PlacedBounds) -> Option<(Self, f64)> {
        let mut frame = Frame::default();
        relative(a, b, &mut frame).then(|| {
            let (metric, kept) = diagonal_below(a.world_from_model().linear());
            (Self::new([None, Some(frame)], metric, a, b), kept)
        })
    }

    /// The same for the second body.
    fn of_b(a: &PlacedBounds, b: &PlacedBounds) -> Option<(Self, f64)> {
        let mut frame = Frame::default();
        relative(b, a, &mut frame).then(|| {
            let (metric, kept) = diagonal_below(b.world_from_model().linear());
            (Self::new([Some(frame), None], metric, a, b), kept)
        })
    }

    /// World space, where lengths are world lengths up to a few roundings.
    pub(crate) fn world(a: &PlacedBounds, b: &PlacedBounds) -> Self {
        Self::new(frames_in_world(a, b), DVec3::ONE, a, b)
    }

    fn new(frames: Frames, metric: DVec3, a: &PlacedBounds, b: &PlacedBounds) -> Self {
        let slack = |frame: &Option<Frame>, own: DVec3| {
            let (error, reach) = frame.as_ref().map_or((DVec3::ZERO, own), |f| (f.error, f.reach()));
            error + 32.0 * U64 * reach
        };
        Self {
            frames,
            metric,
            slack: slack(&frames[0], a.magnitude()) + slack(&frames[1], b.magnitude()),
        }
    }

    #[inline]
    pub(crate) fn image_of_a(&self, a: &Box64) -> Box64 {
        self.frames[0].as_ref().map_or(*a, |frame| image(frame, a))
    }

    #[inline]
    pub(crate) fn image_of_b(&self, b: &Box64) -> Box64 {
        self.frames[1].as_ref().map_or(*b, |frame| image(frame, b))
    }

    /// A lower bound on the squared world distance between points of two boxes, given the boxes' images.
    #[inline]
    pub(crate) fn squared(&self, a: &Box64, b: &Box64) -> f64 {
        let gap = ((a.center - b.center).abs() - (a.half + b.half) - self.slack).max(DVec3::ZERO);
        (self.metric * gap).dot(gap) * (1.0 - 8.0 * U64)
    }
}

#[inline]
fn image(frame: &Frame, source: &Box64) -> Box64 {
    Box64 {
        center: frame.linear * source.center + frame.translation,
        half: frame.linear.abs() * source.half,
    }
}

/// A diagonal matrix below `linear^T linear`, and the smallest fraction of that matrix's diagonal that it keeps.
///
/// The fraction is 1 if the axes stay orthogonal. If they are far from orthogonal, both results are zero. With the axes scaled
/// to length 1, the difference of the two matrices is diagonally dominant and therefore positive semidefinite. This needs
/// every row to be dominant, so it is all axes or none.
pub(super) fn diagonal_below(linear: DMat3) -> (DVec3, f64) {
    let gram = linear.transpose() * linear;
    let lengths = gram.diagonal().map(f64::sqrt);
    // For each axis, the sum of its absolute cosines with all axes, including 1 with itself.
    let cosines = (gram.abs() * lengths.recip()) / lengths;
    let kept = DVec3::splat(2.0 - 64.0 * U64) - cosines;
    if kept.is_finite() && kept.min_element() > 0.0 {
        (kept * gram.diagonal(), kept.min_element())
    } else {
        (DVec3::ZERO, 0.0)
    }
}
