//! Frames in which boxes of two bodies are compared: the space of either body, or world space where neither can be inverted.
//!
//! All maps are made in `f64` with a bound on their own error. [`BoxMap`] rounds them to `f32` and adds a slack for the
//! roundings of `f32`. `docs/numerics.md` derives both.

use glam::{DMat3, DVec3};

use super::inverse::{Inverse, abs};
use super::rounding::U64;
use super::{Aabb, BoxMap, WorldFromModel};

/// An affine map from a body's model space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) linear: DMat3,
    pub(crate) translation: DVec3,
    /// The largest absolute coordinates of the points that will be mapped.
    pub(crate) magnitude: DVec3,
    /// The error bound per axis of the target: of the map, and of where the points are placed.
    pub(crate) error: DVec3,
}

impl Frame {
    /// The largest absolute coordinates after the map.
    pub(super) fn reach(&self) -> DVec3 {
        abs(self.linear) * self.magnitude + self.translation.abs()
    }
}

/// A frame for the boxes of two bodies; a body without a map is in its own space there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frames {
    pub(crate) a: Option<Frame>,
    pub(crate) b: Option<Frame>,
}

/// Calls `visit` with the frames that decide whether boxes of two placed bodies may meet, until it returns false: both bodies'
/// own axes (SAT-lite). A frame is made only when it is visited.
///
/// `a` and `b` are the bodies' whole model-space bounds. World space is added where neither body can be inverted sharply:
/// where each is much flatter or thinner in the world than in its own space.
#[inline]
pub(crate) fn visit_frames(
    world_from_a: &WorldFromModel,
    a: &Aabb,
    world_from_b: &WorldFromModel,
    b: &Aabb,
    mut visit: impl FnMut(&Frames) -> bool,
) {
    let [a, b] = [a.magnitude().as_dvec3(), b.magnitude().as_dvec3()];
    let pair = PlacedPair::new(world_from_a, a, world_from_b, b);
    let mut any_sharp = false;
    if let Some(frames) = pair.in_a() {
        any_sharp |= is_sharp(&frames.b, a);
        if !visit(&frames) {
            return;
        }
    }
    if let Some(frames) = pair.in_b() {
        any_sharp |= is_sharp(&frames.a, b);
        if !visit(&frames) {
            return;
        }
    }
    if !any_sharp {
        visit(&pair.in_turned_world());
    }
}

/// Whether the error of a map to a body's own space is small beside that body.
#[inline]
fn is_sharp(frame: &Option<Frame>, magnitude: DVec3) -> bool {
    // Not measured; it decides only how often the third frame is made.
    const SMALL: f64 = 1e-3;
    let limit = SMALL * magnitude.max_element();
    frame.as_ref().is_some_and(|frame| frame.error.max_element() <= limit)
}

/// Two placed bodies.
pub(super) struct PlacedPair<'a> {
    world_from_a: &'a WorldFromModel,
    world_from_b: &'a WorldFromModel,
    /// The largest absolute model-space coordinates of each body's points.
    a: DVec3,
    b: DVec3,
    /// How far both bodies' points together may be from where they are placed, per world axis.
    error: DVec3,
}

impl<'a> PlacedPair<'a> {
    pub(super) fn new(world_from_a: &'a WorldFromModel, a: DVec3, world_from_b: &'a WorldFromModel, b: DVec3) -> Self {
        Self {
            world_from_a,
            world_from_b,
            a,
            b,
            error: world_from_a.placement_error(a) + world_from_b.placement_error(b),
        }
    }

    /// The space of A, if it can be inverted.
    pub(super) fn in_a(&self) -> Option<Frames> {
        let b = relative(self.world_from_a, self.world_from_b, self.b, self.error)?;
        Some(Frames { a: None, b: Some(b) })
    }

    /// The space of B, if it can be inverted.
    pub(super) fn in_b(&self) -> Option<Frames> {
        let a = relative(self.world_from_b, self.world_from_a, self.a, self.error)?;
        Some(Frames { a: Some(a), b: None })
    }

    /// World space moved to A's origin.
    pub(super) fn in_world(&self) -> Frames {
        let origin = self.world_from_a.translation();
        Frames {
            a: Some(to_world(self.world_from_a, origin, self.a, self.error)),
            b: Some(to_world(self.world_from_b, origin, self.b, self.error)),
        }
    }

    /// World space moved to A's origin, and rotated so that a flat or thin A lies along the axes.
    #[cold]
    fn in_turned_world(&self) -> Frames {
        let axes = long_axes(self.world_from_a.linear(), self.a).transpose();
        let turned = |frame: Frame| Frame {
            linear: axes * frame.linear,
            translation: axes * frame.translation,
            magnitude: frame.magnitude,
            // The products of three coordinates round once for the linear part and once for the translation.
            error: abs(axes) * (frame.error + 8.0 * U64 * frame.reach()),
        };
        let frames = self.in_world();
        Frames {
            a: frames.a.map(turned),
            b: frames.b.map(turned),
        }
    }
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

/// A world-space box around the images by [`WorldFromModel::transform_point`] of all points in `bounds`.
pub(crate) fn world_bounds(world_from_model: &WorldFromModel, bounds: &Aabb) -> Aabb {
    let magnitude = bounds.magnitude().as_dvec3();
    let error = world_from_model.placement_error(magnitude);
    let frame = to_world(world_from_model, DVec3::ZERO, magnitude, error);
    match BoxMap::new(&frame) {
        Some(map) => map.one(bounds),
        None => Aabb::UNBOUNDED,
    }
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

/// `target_from_source` for points within a magnitude; `None` where the target body cannot be inverted safely.
fn relative(
    world_from_target: &WorldFromModel,
    world_from_source: &WorldFromModel,
    magnitude: DVec3,
    world_error: DVec3,
) -> Option<Frame> {
    let Inverse {
        linear: inverse,
        residual,
        largest,
    } = *world_from_target.inverse()?;
    // What the inverse is off, applied to a vector; 1.1 is above `1 / (1 - residual)`.
    let inverse_error = |v: DVec3| DVec3::splat(1.1 * residual * largest.dot(v));
    let offset = world_from_source.translation() - world_from_target.translation();
    let reach = abs(world_from_source.linear()) * magnitude + offset.abs();
    Some(Frame {
        linear: inverse * world_from_source.linear(),
        translation: inverse * offset,
        magnitude,
        error: abs(inverse) * world_error
            + inverse_error(world_error)
            + inverse_error(reach)
            + 16.0 * U64 * (abs(inverse) * reach),
    })
}
