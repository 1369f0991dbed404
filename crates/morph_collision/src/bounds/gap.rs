//! How far boxes of two bodies are apart in the world, from below: boxes in `f64`, compared in a frame whose lengths are
//! bounded by world lengths.

use glam::{DMat3, DVec3};

use super::frame::{own_frames, world_frames};
use super::inverse::abs;
use super::rounding::U64;
use super::{Aabb, Frame, Frames, WorldFromModel};

/// A box by its centre and half size.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Box64 {
    pub(crate) center: DVec3,
    pub(crate) half: DVec3,
}

impl Box64 {
    /// Its roundings are part of a [`GapFrame`]'s slack.
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

/// A frame for boxes of a body A and a body B, and how long its axes are in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GapFrame {
    pub(super) frames: Frames,
    /// A vector `v` of the frame is at least `sqrt(sum metric_i v_i^2)` long in the world.
    metric: DVec3,
    /// What boxes may be off in the frame, all roundings together.
    pub(super) slack: DVec3,
}

impl GapFrame {
    /// The frames of two bodies whose model-space points lie within magnitudes.
    ///
    /// The spaces of both, where they can be inverted; and world space, where neither can, or where both are so
    /// sheared that their coordinates say little about lengths.
    pub(crate) fn list(world_from_a: &WorldFromModel, a: DVec3, world_from_b: &WorldFromModel, b: DVec3) -> Vec<Self> {
        let [in_a, in_b] = own_frames(world_from_a, a, world_from_b, b);
        let metric_a = diagonal_below(world_from_a.linear());
        let metric_b = diagonal_below(world_from_b.linear());
        let faithful = [(in_a, metric_a), (in_b, metric_b)]
            .iter()
            .any(|(frames, (_, kept))| frames.is_some() && *kept > 0.5);
        let in_world = (!faithful).then(|| world_frames(world_from_a, a, world_from_b, b));
        [
            in_a.map(|f| (f, metric_a.0)),
            in_b.map(|f| (f, metric_b.0)),
            in_world.map(|f| (f, DVec3::ONE)),
        ]
        .into_iter()
        .flatten()
        .map(|(frames, metric)| Self::new(frames, metric, a, b))
        .collect()
    }

    /// World space: a length there is one in the world, but for a few roundings.
    pub(crate) fn world(world_from_a: &WorldFromModel, a: DVec3, world_from_b: &WorldFromModel, b: DVec3) -> Self {
        Self::new(world_frames(world_from_a, a, world_from_b, b), DVec3::ONE, a, b)
    }

    fn new(frames: Frames, metric: DVec3, a: DVec3, b: DVec3) -> Self {
        let reach = |frame: &Option<Frame>, own: DVec3| frame.as_ref().map_or(own, Frame::reach);
        let error = |frame: &Option<Frame>| frame.as_ref().map_or(DVec3::ZERO, |frame| frame.error);
        Self {
            frames,
            metric,
            slack: error(&frames.a) + error(&frames.b) + 32.0 * U64 * (reach(&frames.a, a) + reach(&frames.b, b)),
        }
    }

    #[inline]
    pub(crate) fn image_of_a(&self, a: &Box64) -> Box64 {
        self.frames.a.as_ref().map_or(*a, |frame| image(frame, a))
    }

    #[inline]
    pub(crate) fn image_of_b(&self, b: &Box64) -> Box64 {
        self.frames.b.as_ref().map_or(*b, |frame| image(frame, b))
    }

    /// A lower bound on the squared world distance of what two boxes hold, by their images.
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
        half: abs(frame.linear) * source.half,
    }
}

/// A diagonal matrix below `linear^T linear` (their difference is diagonally dominant, so positive semidefinite), and the
/// smallest share of its diagonal that it keeps. Nothing is lost where the axes stay orthogonal.
fn diagonal_below(linear: DMat3) -> (DVec3, f64) {
    let gram = linear.transpose() * linear;
    let diagonal = DVec3::new(gram.x_axis.x, gram.y_axis.y, gram.z_axis.z);
    let rows = abs(gram) * DVec3::ONE;
    let rounding = 16.0 * U64 * (diagonal.max_element() + rows.max_element());
    let below = (2.0 * diagonal - rows - DVec3::splat(rounding)).max(DVec3::ZERO);
    let kept = (below / diagonal).min_element();
    (below, if kept.is_finite() { kept } else { 0.0 })
}
