//! Rigid primitive shapes as colliders.

use bevy::prelude::*;
use morph_collision::{Aabb, PlacedShape, Shape, ShapeError, WorldFromShape};

use crate::collider::MorphCollider;

/// A rigid primitive shape that collides with morphing and rigid meshes, in place of a [`Mesh3d`].
///
/// Shapes are solid, and stand where the [`GlobalTransform`] says. A box takes its scale axis by axis, a capsule's length that
/// along y; radii take the largest scale of the axes they are round about. Shear is left out. Two shapes never
/// collide with each other: that is a physics engine's work. Spatial queries look at meshes only.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[require(MorphCollider)]
pub enum MorphShape {
    /// A ball around the origin.
    Ball {
        /// Its radius.
        radius: f32,
    },
    /// All points within a radius of a segment along the y axis.
    Capsule {
        /// Half the length of the segment, the round ends not included.
        half_length: f32,
        /// The radius.
        radius: f32,
    },
    /// A box around the origin.
    Cuboid {
        /// Half its edges.
        half_extents: Vec3,
    },
    /// Everything below the plane through the origin.
    HalfSpace {
        /// The direction that is up; any length but 0.
        normal: Vec3,
    },
}

impl MorphShape {
    /// The shape in world space, and a box around it.
    pub(crate) fn place(&self, transform: &GlobalTransform) -> Result<(PlacedShape, Aabb), ShapeError> {
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let scale = scale.abs();
        let place = WorldFromShape::new(rotation, translation)?;
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| rotation * axis);
        let (shape, half) = match *self {
            Self::Ball { radius } => {
                let radius = radius * scale.max_element();
                (Shape::Ball { radius }, Vec3::splat(radius))
            }
            Self::Capsule { half_length, radius } => {
                let (half_length, radius) = (half_length * scale.y, radius * scale.x.max(scale.z));
                let half = y.abs() * half_length + radius;
                (Shape::Capsule { half_length, radius }, half)
            }
            Self::Cuboid { half_extents } => {
                let half_extents = half_extents * scale;
                let half = x.abs() * half_extents.x + y.abs() * half_extents.y + z.abs() * half_extents.z;
                (Shape::Cuboid { half_extents }, half)
            }
            Self::HalfSpace { normal } => (Shape::HalfSpace { normal }, Vec3::INFINITY),
        };
        let shape = PlacedShape::new(shape, &place)?;
        // What all of this rounds is far less than a millionth.
        let slack = 1e-6 * (half + translation.abs()) + f32::MIN_POSITIVE;
        let bounds = Aabb {
            min: translation - half - slack,
            max: translation + half + slack,
        };
        Ok((shape, bounds))
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::Affine3A;

    use super::*;

    #[test]
    fn boxes_hold_their_shapes() {
        let turned = Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.0);
        let place = Transform::from_xyz(3.0, -2.0, 7.0)
            .with_rotation(turned)
            .with_scale(Vec3::new(2.0, 0.5, 3.0));
        let place = GlobalTransform::from(place);
        let shapes = [
            MorphShape::Ball { radius: 0.5 },
            MorphShape::Capsule {
                half_length: 2.0,
                radius: 0.25,
            },
            MorphShape::Cuboid {
                half_extents: Vec3::new(1.0, 2.0, 0.1),
            },
        ];
        for shape in shapes {
            let (placed, bounds) = shape.place(&place).unwrap();
            let center = bounds.center();
            for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                // Points in the box's faces: some are near the shape, none beyond them are in it.
                let half = 0.5 * bounds.size().dot(axis);
                let beyond = center + axis * (half + 1e-3);
                let mut nearest = f64::INFINITY;
                for i in -40..=40 {
                    for j in -40..=40 {
                        let (u, v) = axis.any_orthonormal_pair();
                        let size = bounds.size().length() / 80.0;
                        let p = beyond + (u * i as f32 + v * j as f32) * size;
                        nearest = nearest.min(placed.signed_distance(p.as_dvec3()));
                    }
                }
                assert!(nearest > 0.0, "{shape:?} reaches through its box by {nearest}");
                assert!(nearest < 0.1, "{shape:?}'s box is {nearest} away");
            }
        }
    }

    #[test]
    fn bad_numbers_are_errors() {
        let shape = MorphShape::Ball { radius: -1.0 };
        assert!(shape.place(&GlobalTransform::IDENTITY).is_err());
        let nan = GlobalTransform::from(Affine3A::from_translation(Vec3::NAN));
        assert!(MorphShape::Ball { radius: 1.0 }.place(&nan).is_err());
    }
}
