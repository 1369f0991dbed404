//! Lower bounds on the world distance between boxes of two bodies, in `f64`.

use glam::{DMat3, DVec3};

use super::frame::{Frames, PlacedBounds, frames_in_world, relative};
use super::rounding::U64;
use super::{Aabb, Frame};

/// A box by its centre and half size.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Box64 {
    pub(crate) center: DVec3,
    pub(crate) half: DVec3,
}

impl Box64 {
    /// The slack of a [`GapFrame`] covers the roundings.
    #[inline]
    pub(crate) fn of(bounds: &Aabb) -> Self {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        Self {
            center: 0.5 * (min + max),
            half: 0.5 * (max - min),
        }
    }

    pub(crate) fn point(point: DVec3) -> Self {
        Self {
            center: point,
            half: DVec3::ZERO,
        }
    }
}

/// A frame for boxes of two bodies, with the length of its axes in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GapFrame {
    pub(super) frames: Frames,
    /// A vector `v` of the frame is at least `sqrt(sum metric_i v_i^2)` long in the world.
    metric: DVec3,
    /// The error bound of two boxes in the frame, for all roundings together.
    pub(super) slack: DVec3,
}

impl GapFrame {
    /// The frames of two placed bodies: the spaces of both, where they can be inverted.
    ///
    /// World space is added where neither can be, and where both are so sheared that their coordinates say little about lengths.
    pub(crate) fn list(a: &PlacedBounds, b: &PlacedBounds) -> Vec<Self> {
        let mut any_faithful = false;
        let mut list = Vec::new();
        for (gap, kept) in [Self::of_a(a, b), Self::of_b(a, b)].into_iter().flatten() {
            // Not measured; it decides only how often the third frame is made.
            any_faithful |= kept > 0.5;
            list.push(gap);
        }
        if !any_faithful {
            list.push(Self::world(a, b));
        }
        list
    }

    /// The first of [`list`](Self::list).
    pub(super) fn first(a: &PlacedBounds, b: &PlacedBounds) -> Self {
        let first = Self::of_a(a, b).or_else(|| Self::of_b(a, b));
        first.map_or_else(|| Self::world(a, b), |(gap, _)| gap)
    }

    /// The space of the first body, and how faithful it is to lengths; `None` if it has no inverse.
    fn of_a(a: &PlacedBounds, b: &PlacedBounds) -> Option<(Self, f64)> {
        let mut frame = Frame::default();
        relative(a, b, &mut frame).then(|| {
            let (metric, kept) = diagonal_below(a.world_from_model().linear());
            (Self::new([None, Some(frame)], metric, a, b), kept)
        })
    }

    /// The space of the second body.
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

    /// Whether boxes of `a` are not in the frame already.
    pub(super) fn maps_a(&self) -> bool {
        self.frames[0].is_some()
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

/// A diagonal matrix below `linear^T linear`, and the smallest fraction of that one's diagonal that it keeps: 1 where the axes
/// stay orthogonal, 0 with a zero matrix where they are far from it. With the axes scaled to length 1, the difference of the two is diagonally
/// dominant, so positive semidefinite. That takes every row: a single axis must not be left out.
fn diagonal_below(linear: DMat3) -> (DVec3, f64) {
    let gram = linear.transpose() * linear;
    let lengths = gram.diagonal().map(f64::sqrt);
    // The sum of an axis's cosines with the others, and 1 with itself.
    let cosines = (gram.abs() * lengths.recip()) / lengths;
    let kept = DVec3::splat(2.0 - 64.0 * U64) - cosines;
    if kept.is_finite() && kept.min_element() > 0.0 {
        (kept * gram.diagonal(), kept.min_element())
    } else {
        (DVec3::ZERO, 0.0)
    }
}
