//! Frames in which boxes of two bodies are compared: the space of either body, or world space when neither body can be
//! inverted.
//!
//! All maps are made in `f64` with a bound on their own error; [`BoxMap`] rounds them to `f32` and adds a slack for
//! everything `f32` does to a box on its way. `docs/numerics.md` derives both.

use glam::{DMat3, DVec3, Vec3};

use super::inverse::{Inverse, abs};
use super::rounding::U64;
use super::{Aabb, BoxMap, WorldFromModel};

/// Roundings of a row on its way through a map: three products and sums, the entries' own, the offset's, and the final
/// comparison's; each at most half a unit in the last place of the largest magnitude reached.
pub(super) const MAP_ROUNDINGS: f64 = 16.0;
/// Magnitudes beyond this leave room for no sum; such a map is not used.
pub(super) const LARGEST: f64 = 1e37;
/// Covers products, and entries times magnitudes, that underflow: far below any `f32` that is not subnormal.
const UNDERFLOW: f64 = 1e-42;

/// An affine map from one body's space, for points within a magnitude.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) linear: DMat3,
    pub(crate) translation: DVec3,
    /// The largest absolute coordinates of what will be mapped.
    pub(crate) magnitude: DVec3,
    /// How far the map may be off, and how far the points, per axis of the target.
    pub(crate) error: DVec3,
}

impl Frame {
    /// The largest absolute coordinates after the map.
    pub(super) fn reach(&self) -> DVec3 {
        abs(self.linear) * self.magnitude + self.translation.abs()
    }

    pub(super) fn underflow(&self) -> f64 {
        UNDERFLOW * (1.0 + self.magnitude.element_sum())
    }
}

/// A frame to compare boxes of two bodies in; a side without a map is in its own space there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frames {
    pub(crate) a: Option<Frame>,
    pub(crate) b: Option<Frame>,
}

/// The frames that decide whether boxes of two placed bodies may meet: SAT-lite, both bodies' own axes. Each is made when it is
/// asked for; `visit` says whether to go on.
///
/// `a` and `b` are the bodies' whole model-space bounds. World space serves where neither body can be inverted sharply: where
/// each is much flatter or thinner in the world than in its own space.
#[inline]
pub(crate) fn visit_frames(
    world_from_a: &WorldFromModel,
    a: &Aabb,
    world_from_b: &WorldFromModel,
    b: &Aabb,
    mut visit: impl FnMut(&Frames) -> bool,
) {
    let [a, b] = [a.magnitude().as_dvec3(), b.magnitude().as_dvec3()];
    let error = placement_error(world_from_a, a) + placement_error(world_from_b, b);
    let mut is_sharp = false;
    if let Some(frames) = in_a(world_from_a, world_from_b, b, error) {
        is_sharp |= sharp(&frames.b, a);
        if !visit(&frames) {
            return;
        }
    }
    if let Some(frames) = in_b(world_from_a, a, world_from_b, error) {
        is_sharp |= sharp(&frames.a, b);
        if !visit(&frames) {
            return;
        }
    }
    if !is_sharp {
        visit(&turned_world_frames(world_from_a, a, world_from_b, b));
    }
}

/// Whether a map to a body's own space is off by little beside that body.
#[inline]
fn sharp(frame: &Option<Frame>, magnitude: DVec3) -> bool {
    const LITTLE: f64 = 1e-3;
    let limit = LITTLE * magnitude.max_element();
    frame.as_ref().is_some_and(|frame| frame.error.max_element() <= limit)
}

/// The frames that are the space of A, and that of B, where these can be inverted; for points within magnitudes.
pub(super) fn own_frames(
    world_from_a: &WorldFromModel,
    a: DVec3,
    world_from_b: &WorldFromModel,
    b: DVec3,
) -> [Option<Frames>; 2] {
    let error = placement_error(world_from_a, a) + placement_error(world_from_b, b);
    [
        in_a(world_from_a, world_from_b, b, error),
        in_b(world_from_a, a, world_from_b, error),
    ]
}

fn in_a(world_from_a: &WorldFromModel, world_from_b: &WorldFromModel, b: DVec3, error: DVec3) -> Option<Frames> {
    Some(Frames {
        a: None,
        b: Some(relative(world_from_a, world_from_b, b, error)?),
    })
}

fn in_b(world_from_a: &WorldFromModel, a: DVec3, world_from_b: &WorldFromModel, error: DVec3) -> Option<Frames> {
    Some(Frames {
        a: Some(relative(world_from_b, world_from_a, a, error)?),
        b: None,
    })
}

/// World space moved to A's origin; for points within magnitudes.
pub(super) fn world_frames(world_from_a: &WorldFromModel, a: DVec3, world_from_b: &WorldFromModel, b: DVec3) -> Frames {
    let error = placement_error(world_from_a, a) + placement_error(world_from_b, b);
    let origin = world_from_a.translation();
    Frames {
        a: Some(to_world(world_from_a, origin, a, error)),
        b: Some(to_world(world_from_b, origin, b, error)),
    }
}

/// World space moved to A's origin, and turned so that a flat or thin A lies along the axes.
#[cold]
fn turned_world_frames(world_from_a: &WorldFromModel, a: DVec3, world_from_b: &WorldFromModel, b: DVec3) -> Frames {
    let axes = long_axes(world_from_a.linear(), a).transpose();
    let turned = |frame: Frame| Frame {
        linear: axes * frame.linear,
        translation: axes * frame.translation,
        magnitude: frame.magnitude,
        // Products of three coordinates, taken once for the map and once for the offset.
        error: abs(axes) * (frame.error + 8.0 * U64 * frame.reach()),
    };
    let frames = world_frames(world_from_a, a, world_from_b, b);
    Frames {
        a: frames.a.map(turned),
        b: frames.b.map(turned),
    }
}

/// An orthonormal basis, up to rounding, whose first axis is along the longest side of a box under a map, the second in the
/// plane of the two longest.
fn long_axes(linear: DMat3, half: DVec3) -> DMat3 {
    let mut sides = [linear.x_axis * half.x, linear.y_axis * half.y, linear.z_axis * half.z];
    sides.sort_by(|u, v| v.length_squared().total_cmp(&u.length_squared()));
    let Some(first) = sides[0].try_normalize() else {
        return DMat3::IDENTITY;
    };
    let second = sides[1..].iter().find_map(|side| {
        let across = *side / sides[0].length();
        (across - first * across.dot(first)).try_normalize()
    });
    // What is left over of a parallel side is rounding, and need not be across.
    let second = second
        .map(|second| second - first * second.dot(first))
        .and_then(DVec3::try_normalize);
    let second = second.unwrap_or_else(|| first.any_orthonormal_vector());
    DMat3::from_cols(first, second, first.cross(second))
}

/// Whether two bodies are so small in the world that the slack for rounding is not small beside them: culling would tell nothing
/// apart. Each with its whole model-space bounds, and how far rounding may move a vertex in model space.
pub(crate) fn are_below_resolution(bodies: [(&WorldFromModel, &Aabb, f64); 2]) -> bool {
    /// Bodies this many times larger than the slack are culled well.
    const RESOLVED: f64 = 16.0;
    let slack = |(place, bounds, rounding): (&WorldFromModel, &Aabb, f64)| {
        placement_error(place, bounds.magnitude().as_dvec3()).max_element() + rounding * place.scale()
    };
    let limit = RESOLVED * bodies.iter().map(|body| slack(*body)).sum::<f64>();
    bodies.iter().all(|(place, bounds, _)| {
        let size = bounds.size().as_dvec3();
        let linear = place.linear();
        let sides = [linear.x_axis * size.x, linear.y_axis * size.y, linear.z_axis * size.z];
        sides.iter().all(|side| side.abs().max_element() <= limit)
    })
}

/// A box in world space around everything that [`WorldFromModel::transform_point`] makes of points in `bounds`.
pub(crate) fn world_bounds(world_from_model: &WorldFromModel, bounds: &Aabb) -> Aabb {
    let magnitude = bounds.magnitude().as_dvec3();
    let error = placement_error(world_from_model, magnitude);
    let frame = to_world(world_from_model, DVec3::ZERO, magnitude, error);
    match BoxMap::new(&frame) {
        Some(map) => map.one(bounds),
        None => Aabb {
            min: Vec3::NEG_INFINITY,
            max: Vec3::INFINITY,
        },
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

/// What [`WorldFromModel::transform_point`] may differ from the exact image of any point within a magnitude, per world
/// axis.
fn placement_error(world_from_model: &WorldFromModel, magnitude: DVec3) -> DVec3 {
    4.0 * U64 * world_reach(world_from_model, magnitude)
}

/// The largest absolute world coordinates of points within a magnitude.
pub(super) fn world_reach(world_from_model: &WorldFromModel, magnitude: DVec3) -> DVec3 {
    abs(world_from_model.linear()) * magnitude + world_from_model.translation().abs()
}

/// `target_from_source` for boxes within a magnitude; `None` where the target body cannot be inverted safely.
fn relative(
    world_from_target: &WorldFromModel,
    world_from_source: &WorldFromModel,
    magnitude: DVec3,
    world_error: DVec3,
) -> Option<Frame> {
    let Inverse {
        linear: inverse,
        residual: rho,
        largest,
    } = *world_from_target.inverse()?;
    let error_of = |v: DVec3| DVec3::splat(1.1 * rho * largest.dot(v));
    let offset = world_from_source.translation() - world_from_target.translation();
    let reach = abs(world_from_source.linear()) * magnitude + offset.abs();
    Some(Frame {
        linear: inverse * world_from_source.linear(),
        translation: inverse * offset,
        magnitude,
        error: abs(inverse) * world_error
            + error_of(world_error)
            + error_of(reach)
            + 16.0 * U64 * (abs(inverse) * reach),
    })
}

/// `a_from_b` for points within the bodies' bounds, its error covering their placement too; `None` where A cannot be
/// inverted.
#[cfg(test)]
pub(crate) fn a_from_b(
    world_from_a: &WorldFromModel,
    a: &Aabb,
    world_from_b: &WorldFromModel,
    b: &Aabb,
) -> Option<Frame> {
    let [a, b] = [a, b].map(|bounds| bounds.magnitude().as_dvec3());
    let error = placement_error(world_from_a, a) + placement_error(world_from_b, b);
    relative(world_from_a, world_from_b, b, error)
}
