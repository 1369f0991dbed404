//! The sizes and positions with which Parry can compute.

use parry3d::bounding_volume::Aabb;
use parry3d::math::{Pose, Real, Vector};
use parry3d::shape::{HalfSpace, Shape};

use super::patch::Patch;
use super::surface::MorphSurface;

/// The largest coordinate that is passed to Parry, in world units; for velocities, in units per second.
///
/// Parry multiplies up to four lengths. In `f32` that overflows at lengths of 4.3e9. In measurements, answers are right up to
/// 2^30 = 1.1e9, and wrong, infinite or NaN from 2^32 on. From 6e18 on, squares overflow and EPA panics (`docs/rapier.md`).
/// Differences between corners of two shapes are up to 4 sqrt(3) = 7 times as large as a coordinate, so with 1e8 they stay below
/// 1.1e9.
pub const MAX_COORDINATE: Real = 1e8;

/// Whether every component is within [`MAX_COORDINATE`]; NaN is not.
pub fn in_range(vector: Vector) -> bool {
    vector.abs().cmple(Vector::splat(MAX_COORDINATE)).all()
}

/// The same for both corners of a box.
pub fn box_in_range(bounds: &Aabb) -> bool {
    in_range(bounds.mins) && in_range(bounds.maxs)
}

/// How the dispatcher treats a pair of shapes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Range {
    /// Neither shape is a surface: Parry answers as without the dispatcher.
    Foreign,
    /// Parry can answer.
    Inside,
    /// Parry cannot compute: the shapes are too large, too far apart, or not at a finite position.
    Outside,
}

/// Checks a pair of shapes. Costs computing their boxes.
pub fn check(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> Range {
    let is_ours = |shape: &dyn Shape| shape.as_shape::<MorphSurface>().is_some() || shape.as_shape::<Patch>().is_some();
    if !is_ours(g1) && !is_ours(g2) {
        return Range::Foreign;
    }
    // A half-space is infinite, but Parry only uses its normal.
    let fits = |shape: &dyn Shape, bounds: fn(&dyn Shape, &Pose) -> Aabb, pose: &Pose| {
        shape.as_shape::<HalfSpace>().is_some() || box_in_range(&bounds(shape, pose))
    };
    let local = |shape: &dyn Shape, _: &Pose| shape.compute_local_aabb();
    let placed = |shape: &dyn Shape, pose: &Pose| shape.compute_aabb(pose);
    let inside = in_range(pos12.translation)
        && pos12.rotation.is_finite()
        && fits(g1, local, pos12)
        && fits(g2, local, pos12)
        && fits(g2, placed, pos12);
    if inside { Range::Inside } else { Range::Outside }
}

#[cfg(test)]
mod tests {
    use parry3d::math::Rotation;
    use parry3d::shape::Ball;

    use super::*;

    #[test]
    fn what_is_no_number_is_out_of_range() {
        for bad in [Real::NAN, Real::INFINITY, -Real::INFINITY, 1e30, -1.1e8] {
            assert!(!in_range(Vector::new(0.0, bad, 0.0)), "{bad}");
        }
        assert!(in_range(Vector::splat(1e8)) && in_range(Vector::splat(-1e-30)));
    }

    #[test]
    fn pairs_of_other_shapes_are_left_to_parry() {
        let far = Pose::from_parts(Vector::splat(1e30), Rotation::IDENTITY);
        assert!(check(&far, &Ball::new(1e30), &Ball::new(1.0)) == Range::Foreign);
    }
}
