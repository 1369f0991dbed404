//! Frames in which the boxes of two bodies are compared: the space of either body, or world space if neither body's map can be
//! inverted.
//!
//! All maps are computed in `f64` with a bound on their error. [`BoxMap`](super::BoxMap) rounds them to `f32` and adds a slack for its own
//! roundings. `docs/numerics.md` derives both bounds.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::{DMat3, DVec3};

use super::kernel::with_simd;
use super::rounding::U64;
use super::{Kernel, WorldFromModel};

/// An affine map from a body's model space.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Frame {
    pub(crate) linear: DMat3,
    pub(crate) translation: DVec3,
    /// The largest absolute coordinates of the points to be mapped. Boxes around them may reach farther (docs/numerics.md).
    pub(crate) magnitude: DVec3,
    /// The error bound for each axis of the target space. It covers the map itself and the rounding of placed points.
    pub(crate) error: DVec3,
}

impl Frame {
    /// The largest absolute coordinates of mapped points.
    pub(super) fn reach(&self) -> DVec3 {
        self.linear.abs() * self.magnitude + self.translation.abs()
    }
}

/// A [`Frame`] in registers. The fourth lane is padding.
#[derive(Clone, Copy)]
pub(crate) struct FrameLanes<S: Simd> {
    /// The columns of the linear part.
    pub(super) axes: [f64x4<S>; 3],
    pub(super) translation: f64x4<S>,
    pub(super) magnitude: f64x4<S>,
    pub(super) error: f64x4<S>,
}

impl<S: Simd> FrameLanes<S> {
    #[inline(always)]
    pub(crate) fn load(simd: S, frame: &Frame) -> Self {
        let DMat3 { x_axis, y_axis, z_axis } = frame.linear;
        Self {
            axes: [lanes(simd, x_axis), lanes(simd, y_axis), lanes(simd, z_axis)],
            translation: lanes(simd, frame.translation),
            magnitude: lanes(simd, frame.magnitude),
            error: lanes(simd, frame.error),
        }
    }

    #[inline(always)]
    pub(crate) fn store(&self) -> Frame {
        let [x, y, z] = self.axes;
        Frame {
            linear: DMat3::from_cols(vector(x), vector(y), vector(z)),
            translation: vector(self.translation),
            magnitude: vector(self.magnitude),
            error: vector(self.error),
        }
    }
}

#[inline(always)]
fn lanes<S: Simd>(simd: S, v: DVec3) -> f64x4<S> {
    f64x4::from_slice(simd, &[v.x, v.y, v.z, 0.0])
}

#[inline(always)]
fn vector<S: Simd>(lanes: f64x4<S>) -> DVec3 {
    let mut numbers = [0.0; 4];
    lanes.store_slice(&mut numbers);
    let [x, y, z, _] = numbers;
    DVec3::new(x, y, z)
}

/// A frame for the boxes of two bodies: the map of each body into it, or `None` if the frame is that body's own space.
pub(super) type Frames = [Option<Frame>; 2];

/// The frames in which boxes of two placed bodies are compared: the two bodies' own spaces (SAT-lite), or only A's if both have the same
/// axes. World space is added if neither body's map has an accurate inverse, which happens if both are much flatter or thinner in the world
/// than in their own space.
///
/// Calls `visit` with each frame, as soon as it is computed, until it returns false: with the map of each body into the frame, `None` if
/// it is that body's own space.
#[inline(always)]
pub(crate) fn visit_frames<S: Simd>(
    simd: S,
    a: &PlacedBounds,
    b: &PlacedBounds,
    mut visit: impl FnMut([Option<&FrameLanes<S>>; 2]) -> bool,
) {
    let of_b = relative_lanes(simd, &a.world_from_model, a.error, b);
    if let Some(of_b) = &of_b {
        // B's space would have the same axes.
        let is_enough = is_diagonal(of_b) && is_sharp(of_b, a);
        if !visit([None, Some(of_b)]) || is_enough {
            return;
        }
    }
    let of_a = relative_lanes(simd, &b.world_from_model, b.error, a);
    if let Some(of_a) = &of_a
        && !visit([Some(of_a), None])
    {
        return;
    }
    if of_b.is_some_and(|frame| is_sharp(&frame, a)) || of_a.is_some_and(|frame| is_sharp(&frame, b)) {
        return;
    }
    let in_world = frames_in_turned_world(a, b).map(|frame| frame.map(|frame| FrameLanes::load(simd, &frame)));
    visit(in_world.each_ref().map(Option::as_ref));
}

/// Whether a map keeps the directions of the axes.
#[inline(always)]
fn is_diagonal<S: Simd>(frame: &FrameLanes<S>) -> bool {
    let [x, y, z] = frame.axes.map(vector);
    [x.y, x.z, y.x, y.z, z.x, z.y] == [0.0; 6]
}

/// Whether the error of a map to a body's own space is small compared with that body.
#[inline(always)]
fn is_sharp<S: Simd>(frame: &FrameLanes<S>, target: &PlacedBounds) -> bool {
    // Not measured; it only affects how often the third frame is computed.
    const SMALL: f64 = 1e-3;
    vector(frame.error).max_element() <= SMALL * target.magnitude.max_element()
}

/// The data of a placed body from which maps between bodies are computed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PlacedBounds {
    world_from_model: WorldFromModel,
    /// The largest absolute model-space coordinates of its points.
    magnitude: DVec3,
    /// The largest absolute world coordinates of its points, relative to its translation.
    spread: DVec3,
    /// The largest placement error of its points along any world axis.
    error: f64,
}

impl PlacedBounds {
    pub(crate) fn new(world_from_model: &WorldFromModel, magnitude: DVec3) -> Self {
        let error = world_from_model.placement_error(magnitude).max_element();
        Self::with_error(world_from_model, magnitude, error)
    }

    /// Like [`PlacedBounds::new`], with a given error, for points that are placed in another way.
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

    pub(super) fn spread(&self) -> DVec3 {
        self.spread
    }

    /// The map from the space of another body or frame to this body's; `None` if this body's map cannot be inverted.
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

/// World space, translated to A's origin.
pub(super) fn frames_in_world(a: &PlacedBounds, b: &PlacedBounds) -> Frames {
    let origin = a.world_from_model.translation();
    let error = DVec3::splat(a.error + b.error);
    [a, b].map(|body| Some(to_world(&body.world_from_model, origin, body.magnitude, error)))
}

/// World space, translated to A's origin and rotated so that a flat or thin A lies along the axes.
#[cold]
fn frames_in_turned_world(a: &PlacedBounds, b: &PlacedBounds) -> Frames {
    let axes = long_axes(a.world_from_model.linear(), a.magnitude).transpose();
    let turned = |frame: Frame| Frame {
        linear: axes * frame.linear,
        translation: axes * frame.translation,
        magnitude: frame.magnitude,
        // Two rounded matrix products: one for the linear part and one for the translation.
        error: axes.abs() * (frame.error + 8.0 * U64 * frame.reach()),
    };
    frames_in_world(a, b).map(|frame| frame.map(turned))
}

/// An orthonormal basis, up to rounding, for the image of a box. The first axis is along the longest side, the second in the
/// plane of the two longest sides.
fn long_axes(linear: DMat3, half: DVec3) -> DMat3 {
    let mut sides = [linear.x_axis * half.x, linear.y_axis * half.y, linear.z_axis * half.z];
    sides.sort_by(|u, v| v.length_squared().total_cmp(&u.length_squared()));
    let Some(first) = sides[0].try_normalize() else {
        return DMat3::IDENTITY;
    };
    let across = |v: DVec3| (v - first * v.dot(first)).try_normalize();
    // Orthogonalised twice: what the first pass leaves of a nearly parallel side is mostly rounding error.
    let second = sides[1..].iter().find_map(|side| across(*side / sides[0].length()));
    let second = second
        .and_then(across)
        .unwrap_or_else(|| first.any_orthonormal_vector());
    DMat3::from_cols(first, second, first.cross(second))
}

/// The map to world space relative to `origin`, which keeps boxes of small bodies tight far from the world's origin.
pub(super) fn to_world(world_from_model: &WorldFromModel, origin: DVec3, magnitude: DVec3, error: DVec3) -> Frame {
    let translation = world_from_model.translation() - origin;
    Frame {
        linear: world_from_model.linear(),
        translation,
        magnitude,
        error: error + 2.0 * U64 * translation.abs(),
    }
}

/// Sets `frame` to the map from the source's space to the target's; returns false if the target's map has no safe inverse.
pub(super) fn relative(target: &PlacedBounds, source: &PlacedBounds, frame: &mut Frame) -> bool {
    relative_to(&target.world_from_model, target.error, source, frame)
}

/// Sets `frame` to the map from the source's space to the model space of `to`; returns false if that has no safe inverse.
#[inline]
pub(super) fn relative_to(to: &WorldFromModel, error: f64, source: &PlacedBounds, frame: &mut Frame) -> bool {
    let level = Kernel::default().level;
    let relative = with_simd!(level, simd => relative_lanes(simd, to, error, source).map(|frame| frame.store()));
    if let Some(relative) = relative {
        *frame = relative;
    }
    relative.is_some()
}

/// The map from the source's space to the model space of `to`; `None` if that has no safe inverse.
#[inline(always)]
fn relative_lanes<S: Simd>(simd: S, to: &WorldFromModel, error: f64, source: &PlacedBounds) -> Option<FrameLanes<S>> {
    let inverse = to.inverse()?;
    let from = &source.world_from_model;
    let offset = lanes(simd, from.translation()) - lanes(simd, to.translation());
    let world_error = error + source.error;
    let reach = vector(lanes(simd, source.spread) + offset.abs()).max_element();
    let columns = [inverse.linear.x_axis, inverse.linear.y_axis, inverse.linear.z_axis];
    let columns = [
        lanes(simd, columns[0]),
        lanes(simd, columns[1]),
        lanes(simd, columns[2]),
    ];
    let DMat3 { x_axis, y_axis, z_axis } = from.linear();
    Some(FrameLanes {
        axes: [
            product(simd, columns, x_axis),
            product(simd, columns, y_axis),
            product(simd, columns, z_axis),
        ],
        translation: product(simd, columns, vector(offset)),
        magnitude: lanes(simd, source.magnitude),
        error: lanes(simd, inverse.rows) * f64x4::splat(simd, world_error + 16.0 * U64 * reach)
            + f64x4::splat(simd, inverse.error * (world_error + reach)),
    })
}

/// A matrix, by its columns, times a vector.
#[inline(always)]
fn product<S: Simd>(simd: S, [x, y, z]: [f64x4<S>; 3], v: DVec3) -> f64x4<S> {
    (x * f64x4::splat(simd, v.x) + y * f64x4::splat(simd, v.y)) + z * f64x4::splat(simd, v.z)
}
