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

/// The box in the entity's space that, when Bevy transforms it with the entity, contains a box in world space. Infinite if no
/// finite one exists.
pub(super) fn around_in(world: &morph_collision::Aabb, place: &GlobalTransform) -> Aabb {
    let affine = place.affine();
    let entity_from_world = Mat3::from(affine.matrix3).as_dmat3().inverse();
    let abs = DMat3::from_cols(
        entity_from_world.x_axis.abs(),
        entity_from_world.y_axis.abs(),
        entity_from_world.z_axis.abs(),
    );
    let (min, max) = (world.min.as_dvec3(), world.max.as_dvec3());
    let translation = affine.translation.as_dvec3();
    let (world_center, world_half) = ((min + max) / 2.0, (max - min) / 2.0);
    let center = entity_from_world * (world_center - translation);
    let half = abs * world_half;
    // Bevy transforms the box back to world space in `f32`. That rounds world coordinates, which may be far larger than local
    // ones.
    let world_reach: DVec3 = world_center.abs() + world_half + translation.abs();
    let half = half + f64::from(SLACK) * (center.abs() + half + abs * world_reach);
    let (center, half): (Vec3A, Vec3A) = (center.as_vec3a(), half.as_vec3a());
    if center.is_finite() && half.is_finite() {
        return Aabb {
            center,
            half_extents: half,
        };
    }
    Aabb {
        center: Vec3A::ZERO,
        half_extents: Vec3A::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::Affine3A;

    use super::*;

    fn world() -> morph_collision::Aabb {
        morph_collision::Aabb {
            min: Vec3::new(-1.0, 2.0, 30.0),
            max: Vec3::new(0.5, 2.0, 31.0),
        }
    }

    #[test]
    fn a_box_is_where_it_was_when_bevy_moves_it_with_its_entity() {
        let turned = Quat::from_euler(EulerRot::XYZ, 0.7, -0.3, 2.0);
        for (scale, translation) in [
            (Vec3::ONE, Vec3::ZERO),
            (Vec3::new(1e-3, 5.0, -2.0), Vec3::new(1e4, -3.0, 0.1)),
            (Vec3::splat(1e3), Vec3::splat(-500.0)),
        ] {
            let affine = Affine3A::from_scale_rotation_translation(scale, turned, translation);
            let place = GlobalTransform::from(affine);
            let aabb = around_in(&world(), &place);
            // As in Bevy's culling.
            let center = affine.transform_point3a(aabb.center);
            for axis in [Vec3A::X, Vec3A::Y, Vec3A::Z] {
                let radius = aabb.relative_radius(&axis, &affine.matrix3);
                let (low, high) = (center.dot(axis) - radius, center.dot(axis) + radius);
                let (min, max) = (world().min.dot(axis.into()), world().max.dot(axis.into()));
                assert!(
                    low <= min && high >= max,
                    "{low} to {high} does not hold {min} to {max}"
                );
                let size = (max - min) + world().size().length();
                assert!(
                    high - low < 4.0 * size,
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
        for (bounds, place) in [(unbounded, identity), (world(), flat), (world(), nowhere)] {
            let aabb = around_in(&bounds, &place);
            assert_eq!((aabb.center, aabb.half_extents), (Vec3A::ZERO, Vec3A::INFINITY));
        }
    }
}
