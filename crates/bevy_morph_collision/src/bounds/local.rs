//! Converts boxes of poses to Bevy's boxes, which are in the space of their entity.

use bevy::camera::primitives::Aabb;
use bevy::math::{DMat3, DVec3, Vec3A};
use bevy::prelude::*;

/// Relative to the largest coordinate; far more than the rounding error of Bevy's centre and half size.
const SLACK: f32 = 1e-6;

/// A box in the space of its entity, in Bevy's form.
pub(super) fn around(bounds: &morph_collision::Aabb) -> Aabb {
    let slack = SLACK * bounds.min.abs().max(bounds.max.abs());
    Aabb::from_min_max(bounds.min - slack, bounds.max + slack)
}

/// A box that is never culled.
pub(super) const UNBOUNDED: Aabb = Aabb {
    center: Vec3A::ZERO,
    half_extents: Vec3A::INFINITY,
};

/// A box in the space of an entity, in Bevy's form. It contains the box also where Bevy transforms it with the entity, in `f32`. Infinite
/// if no finite one does.
pub(super) fn around_in(local: &morph_collision::Aabb, place: &GlobalTransform) -> Aabb {
    let affine = place.affine();
    let world_from_entity = Mat3::from(affine.matrix3).as_dmat3();
    let (min, max) = (local.min.as_dvec3(), local.max.as_dvec3());
    let (center, half) = ((min + max) / 2.0, (max - min) / 2.0);
    let reach = center.abs() + half;
    // Rounded in the world, where coordinates may be far larger than in the entity's space.
    let world_reach: DVec3 = absolute(world_from_entity) * reach + affine.translation.as_dvec3().abs();
    let half = half + f64::from(SLACK) * (reach + absolute(world_from_entity.inverse()) * world_reach);
    let (center, half): (Vec3A, Vec3A) = (center.as_vec3a(), half.as_vec3a());
    if center.is_finite() && half.is_finite() {
        return Aabb {
            center,
            half_extents: half,
        };
    }
    UNBOUNDED
}

fn absolute(matrix: DMat3) -> DMat3 {
    DMat3::from_cols(matrix.x_axis.abs(), matrix.y_axis.abs(), matrix.z_axis.abs())
}

#[cfg(test)]
mod tests {
    use bevy::math::Affine3A;

    use super::*;

    fn local() -> morph_collision::Aabb {
        morph_collision::Aabb {
            min: Vec3::new(-1.0, 2.0, 30.0),
            max: Vec3::new(0.5, 2.0, 31.0),
        }
    }

    /// The ends of the exact image of the box along an axis of the world.
    fn image(affine: &Affine3A, axis: Vec3A) -> [f64; 2] {
        let axis = Vec3::from(axis).as_dvec3();
        let middle = (local().min.as_dvec3() + local().max.as_dvec3()) / 2.0;
        let half = local().max.as_dvec3() - middle;
        let columns =
            [affine.x_axis, affine.y_axis, affine.z_axis].map(|column| Vec3::from(column).as_dvec3().dot(axis));
        let center = (0..3).map(|i| columns[i] * middle[i]).sum::<f64>() + affine.translation.as_dvec3().dot(axis);
        let radius = (0..3).map(|i| columns[i].abs() * half[i]).sum::<f64>();
        [center - radius, center + radius]
    }

    #[test]
    fn a_box_holds_its_exact_image_when_bevy_moves_it_with_its_entity() {
        let turned = Quat::from_euler(EulerRot::XYZ, 0.7, -0.3, 2.0);
        for (scale, translation) in [
            (Vec3::ONE, Vec3::ZERO),
            (Vec3::new(1e-3, 5.0, -2.0), Vec3::new(1e4, -3.0, 0.1)),
            (Vec3::splat(1e3), Vec3::splat(-500.0)),
        ] {
            let affine = Affine3A::from_scale_rotation_translation(scale, turned, translation);
            let aabb = around_in(&local(), &GlobalTransform::from(affine));
            // As in Bevy's culling.
            let center = affine.transform_point3a(aabb.center);
            for axis in [Vec3A::X, Vec3A::Y, Vec3A::Z] {
                let radius = aabb.relative_radius(&axis, &affine.matrix3);
                let (low, high) = (center.dot(axis) - radius, center.dot(axis) + radius);
                let [min, max] = image(&affine, axis);
                assert!(
                    f64::from(low) <= min && f64::from(high) >= max,
                    "{low} to {high} does not hold {min} to {max}"
                );
                // Rounding counts relative to the largest coordinate.
                let largest = local().max.max_element() * scale.abs().max_element() + translation.length();
                let slack = 1e-5 * f64::from(largest);
                assert!(
                    f64::from(high - low) < max - min + slack,
                    "{low} to {high} is far more than {min} to {max}"
                );
            }
        }
    }

    #[test]
    fn without_a_finite_box_nothing_is_culled() {
        let unbounded = morph_collision::Aabb {
            min: Vec3::NEG_INFINITY,
            max: Vec3::INFINITY,
        };
        let identity = GlobalTransform::IDENTITY;
        let flat = GlobalTransform::from_scale(Vec3::new(1.0, 0.0, 1.0));
        let nowhere = GlobalTransform::from_translation(Vec3::NAN);
        for (bounds, place) in [(unbounded, identity), (local(), flat), (local(), nowhere)] {
            assert_eq!(around_in(&bounds, &place), UNBOUNDED);
        }
    }
}
