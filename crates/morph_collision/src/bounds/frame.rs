//! Frames in which boxes of two bodies are compared: the space of either body, or world space where neither can be inverted.
//!
//! All maps are made in `f64` with a bound on their own error. [`BoxMap`] rounds them to `f32` and adds a slack for the
//! roundings of `f32`. `docs/numerics.md` derives both.

use glam::{DMat3, DVec3};

use super::rounding::U64;
use super::{BoxMap, WorldFromModel};

/// An affine map from a body's model space.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Frame {
    pub(crate) linear: DMat3,
    pub(crate) translation: DVec3,
    /// The largest absolute coordinates of the points that will be mapped. Boxes around them may reach farther (docs/numerics.md).
    pub(crate) magnitude: DVec3,
    /// The error bound per axis of the target: of the map, and of where the points are placed.
    pub(crate) error: DVec3,
}

impl Frame {
    /// The map that takes points by `first` and then by this one.
    pub(crate) fn after(&self, first: &Self) -> Self {
        let linear = self.linear * first.linear;
        let translation = self.linear * first.translation + self.translation;
        let reach = self.linear.abs() * first.reach() + self.translation.abs();
        Self {
            linear,
            translation,
            magnitude: first.magnitude,
            // Three products and sums for each of the matrices.
            error: self.error + self.linear.abs() * first.error + 16.0 * U64 * reach,
        }
    }

    /// The largest absolute coordinates after the map.
    pub(super) fn reach(&self) -> DVec3 {
        self.linear.abs() * self.magnitude + self.translation.abs()
    }
}

/// A frame for the boxes of two bodies, as the map of each; a body without a map is in its own space there.
pub(super) type Frames = [Option<Frame>; 2];

/// Calls `visit` with the frames that decide whether boxes of two placed bodies may meet, until it returns false: both bodies'
/// own axes (SAT-lite). A frame is made only when it is visited, and is given as the map from each body's own space, if that is
/// another one.
///
/// World space is added where neither body can be inverted sharply: where each is much flatter or thinner in the world than in its
/// own space.
#[inline]
pub(crate) fn visit_frames(a: &PlacedBounds, b: &PlacedBounds, mut visit: impl FnMut([Option<&Frame>; 2]) -> bool) {
    let mut any_sharp = false;
    let mut frame = Frame::default();
    if relative(a, b, &mut frame) {
        any_sharp |= is_sharp(&frame, a);
        if !visit([None, Some(&frame)]) {
            return;
        }
    }
    if relative(b, a, &mut frame) {
        any_sharp |= is_sharp(&frame, b);
        if !visit([Some(&frame), None]) {
            return;
        }
    }
    if !any_sharp {
        visit(frames_in_turned_world(a, b).each_ref().map(Option::as_ref));
    }
}

/// Whether the error of a map to a body's own space is small beside that body.
#[inline]
fn is_sharp(frame: &Frame, target: &PlacedBounds) -> bool {
    // Not measured; it decides only how often the third frame is made.
    const SMALL: f64 = 1e-3;
    frame.error.max_element() <= SMALL * target.magnitude.max_element()
}

/// A placed body as the maps between bodies need it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PlacedBounds {
    world_from_model: WorldFromModel,
    /// The largest absolute model-space coordinates of its points.
    magnitude: DVec3,
    /// The largest absolute world coordinates of its points, relative to its translation.
    spread: DVec3,
    /// How far its points may be from where they are placed, along any world axis.
    error: f64,
}

impl PlacedBounds {
    pub(crate) fn new(world_from_model: &WorldFromModel, magnitude: DVec3) -> Self {
        let error = world_from_model.placement_error(magnitude).max_element();
        Self::with_error(world_from_model, magnitude, error)
    }

    /// With points that are placed in another way, and so with another error.
    pub(crate) fn with_error(world_from_model: &WorldFromModel, magnitude: DVec3, error: f64) -> Self {
        Self {
            world_from_model: *world_from_model,
            magnitude,
            spread: world_from_model.linear().abs() * magnitude,
            error,
        }
    }

    /// The largest absolute world coordinates of its points.
    pub(crate) fn world_reach(&self) -> DVec3 {
        self.spread + self.world_from_model.translation().abs()
    }

    pub(crate) fn magnitude(&self) -> DVec3 {
        self.magnitude
    }

    /// The map from another body's or frame's space to this one; `None` where this one cannot be inverted.
    pub(crate) fn frame_from(&self, source: &Self) -> Option<Frame> {
        let mut frame = Frame::default();
        relative(self, source, &mut frame).then_some(frame)
    }

    pub(crate) fn world_from_model(&self) -> &WorldFromModel {
        &self.world_from_model
    }

    pub(crate) fn error(&self) -> f64 {
        self.error
    }
}

/// World space moved to A's origin.
pub(super) fn frames_in_world(a: &PlacedBounds, b: &PlacedBounds) -> Frames {
    let origin = a.world_from_model.translation();
    let error = DVec3::splat(a.error + b.error);
    [a, b].map(|body| Some(to_world(&body.world_from_model, origin, body.magnitude, error)))
}

/// World space moved to A's origin, and rotated so that a flat or thin A lies along the axes.
#[cold]
fn frames_in_turned_world(a: &PlacedBounds, b: &PlacedBounds) -> Frames {
    let axes = long_axes(a.world_from_model.linear(), a.magnitude).transpose();
    let turned = |frame: Frame| Frame {
        linear: axes * frame.linear,
        translation: axes * frame.translation,
        magnitude: frame.magnitude,
        // The products of three coordinates round once for the linear part and once for the translation.
        error: axes.abs() * (frame.error + 8.0 * U64 * frame.reach()),
    };
    frames_in_world(a, b).map(|frame| frame.map(turned))
}

/// An orthonormal basis, up to rounding, for the image of a box: the first axis is along the longest side, the second in the
/// plane of the two longest.
fn long_axes(linear: DMat3, half: DVec3) -> DMat3 {
    let mut sides = [linear.x_axis * half.x, linear.y_axis * half.y, linear.z_axis * half.z];
    sides.sort_by(|u, v| v.length_squared().total_cmp(&u.length_squared()));
    let Some(first) = sides[0].try_normalize() else {
        return DMat3::IDENTITY;
    };
    let across = |v: DVec3| (v - first * v.dot(first)).try_normalize();
    // Twice, because what is left of a nearly parallel side is mostly rounding, and not yet orthogonal.
    let second = sides[1..].iter().find_map(|side| across(*side / sides[0].length()));
    let second = second
        .and_then(across)
        .unwrap_or_else(|| first.any_orthonormal_vector());
    DMat3::from_cols(first, second, first.cross(second))
}

/// The map to world space for boxes of a placed body: it holds all its points as they are placed.
/// `None` where world coordinates exceed the range of `f32`.
pub(crate) fn world_map(placed: &PlacedBounds) -> Option<BoxMap> {
    let error = DVec3::splat(placed.error);
    BoxMap::new(&to_world(
        &placed.world_from_model,
        DVec3::ZERO,
        placed.magnitude,
        error,
    ))
}

/// The map to world space relative to `origin`, which keeps small bodies far from the world's origin sharp.
fn to_world(world_from_model: &WorldFromModel, origin: DVec3, magnitude: DVec3, error: DVec3) -> Frame {
    let translation = world_from_model.translation() - origin;
    Frame {
        linear: world_from_model.linear(),
        translation,
        magnitude,
        error: error + 2.0 * U64 * translation.abs(),
    }
}

/// Sets `frame` to the map from one body's space to another's; returns false where the target cannot be inverted safely.
#[inline]
pub(super) fn relative(target: &PlacedBounds, source: &PlacedBounds, frame: &mut Frame) -> bool {
    let Some(inverse) = target.world_from_model.inverse() else {
        return false;
    };
    let (to, from) = (&target.world_from_model, &source.world_from_model);
    let offset = from.translation() - to.translation();
    let world_error = target.error + source.error;
    let reach = (source.spread + offset.abs()).max_element();
    frame.linear = inverse.linear * from.linear();
    frame.translation = inverse.linear * offset;
    frame.magnitude = source.magnitude;
    frame.error = inverse.rows * (world_error + 16.0 * U64 * reach) + inverse.error * (world_error + reach);
    true
}
