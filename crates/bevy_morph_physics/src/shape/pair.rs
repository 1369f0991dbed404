//! Whether Parry can compute with a pair of shapes, of which one is a surface.

use parry3d::bounding_volume::Aabb;
use parry3d::math::Pose;
use parry3d::shape::{HalfSpace, Shape};

use super::patch::Patch;
use super::range::{box_in_range, in_range};
use super::surface::MorphSurface;

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
    use parry3d::math::{Rotation, Vector};
    use parry3d::shape::Ball;

    use super::*;

    #[test]
    fn pairs_of_other_shapes_are_left_to_parry() {
        let far = Pose::from_parts(Vector::splat(1e30), Rotation::IDENTITY);
        assert!(check(&far, &Ball::new(1e30), &Ball::new(1.0)) == Range::Foreign);
    }
}
