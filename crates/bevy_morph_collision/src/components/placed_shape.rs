//! Where a transform puts a primitive shape.

use bevy::math::{DMat3, DQuat, DVec3, Mat3A};
use bevy::prelude::*;
use morph_collision::{Aabb, InputError, PlacedShape, Shape};

use super::shape::MorphShape;

impl MorphShape {
    /// The shape in world space, and a box around it.
    pub(crate) fn place(&self, transform: &GlobalTransform) -> Result<(PlacedShape, Aabb), InputError> {
        let linear = transform.affine().matrix3;
        let (scale, rotation) = scale_and_rotation(linear);
        let translation = transform.translation();
        let [x, y, z] = DMat3::from_quat(rotation)
            .to_cols_array_2d()
            .map(|axis| DVec3::from_array(axis).as_vec3());
        let of_box = |half: Vec3| x.abs() * half.x + y.abs() * half.y + z.abs() * half.z;
        // A disc around y reaches along a world axis as far as that axis is not along y.
        let beside = Vec3::new(y.yz().length(), y.zx().length(), y.xy().length());
        let of_discs = |half_height: f32, [bottom, top]: [f32; 2]| {
            let (up, bottom, top) = (y * half_height, beside * bottom, beside * top);
            [(-up - bottom).min(up - top), (bottom - up).max(up + top)]
        };
        let same = |half: Vec3| [-half, half];
        let around = scale.x.max(scale.z);
        let (shape, [low, high]) = match *self {
            Self::Ball { radius } => {
                let radius = radius * scale.max_element();
                (Shape::Ball { radius }, same(Vec3::splat(radius)))
            }
            Self::Capsule { half_length, radius } => {
                let (half_length, radius) = (half_length * scale.y, radius * around);
                let half = y.abs() * half_length + radius;
                (Shape::Capsule { half_length, radius }, same(half))
            }
            Self::Cuboid { half_extents } => {
                let half_extents = half_extents * scale;
                (Shape::Cuboid { half_extents }, same(of_box(half_extents)))
            }
            Self::RoundCuboid {
                half_extents,
                border_radius,
            } => {
                let (half_extents, border_radius) = (half_extents * scale, border_radius * scale.max_element());
                let half = of_box(half_extents) + border_radius;
                let shape = Shape::RoundCuboid {
                    half_extents,
                    border_radius,
                };
                (shape, same(half))
            }
            Self::Cylinder { half_height, radius } => {
                let (half_height, radius) = (half_height * scale.y, radius * around);
                (
                    Shape::Cylinder { half_height, radius },
                    of_discs(half_height, [radius; 2]),
                )
            }
            Self::Cone { half_height, radius } => {
                let (half_height, radius) = (half_height * scale.y, radius * around);
                (
                    Shape::Cone { half_height, radius },
                    of_discs(half_height, [radius, 0.0]),
                )
            }
            Self::ConicalFrustum {
                half_height,
                bottom_radius,
                top_radius,
            } => {
                let [bottom_radius, top_radius] = [bottom_radius, top_radius].map(|radius| radius * around);
                let half_height = half_height * scale.y;
                let discs = of_discs(half_height, [bottom_radius, top_radius]);
                let shape = Shape::ConicalFrustum {
                    half_height,
                    bottom_radius,
                    top_radius,
                };
                (shape, discs)
            }
            Self::ConvexHull(ref hull) => {
                let hull = hull.scaled(scale * mirrored_z(linear))?;
                let corners = hull.points().iter().map(|&corner| (rotation * corner).as_vec3());
                let (low, high) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), corner| {
                    (low.min(corner), high.max(corner))
                });
                (Shape::ConvexHull(hull), [low, high])
            }
            Self::HalfSpace { normal } => {
                let normal = placed_normal(normal, linear).unwrap_or((rotation * normal.as_dvec3()).as_vec3());
                let shape = PlacedShape::new(Shape::HalfSpace { normal }, Quat::IDENTITY, translation)?;
                let bounds = Aabb {
                    min: Vec3::NEG_INFINITY,
                    max: Vec3::INFINITY,
                };
                return Ok((shape, bounds));
            }
        };
        let shape = PlacedShape::new(shape, rotation.as_quat(), translation)?;
        // The rounding errors of all this are far below a millionth.
        let slack = 1e-6 * (low.abs().max(high.abs()).max_element() + translation.abs()) + f32::MIN_POSITIVE;
        let bounds = Aabb {
            min: translation + low - slack,
            max: translation + high + slack,
        };
        Ok((shape, bounds))
    }
}

/// The lengths of the axes, and a nearby rotation: it maps x exactly to the first axis, and y to the part of the second axis that
/// is perpendicular to the first. Whether the third axis is mirrored matters only to shapes that are not symmetric.
fn scale_and_rotation(linear: Mat3A) -> (Vec3, DQuat) {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis].map(Vec3::from);
    let scale = Vec3::new(x.length(), y.length(), z.length());
    let x = x
        .try_normalize()
        .unwrap_or_else(|| y.cross(z).try_normalize().unwrap_or(Vec3::X));
    let across = |v: Vec3| (v - x * x.dot(v)).try_normalize();
    let y = across(y)
        .or_else(|| across(z.cross(x)))
        .unwrap_or_else(|| x.any_orthonormal_vector());
    // With `f64`, because the vector instructions of machines add the squares of a `Quat` in different orders.
    let rotation = DQuat::from_mat3(&DMat3::from_cols(x.as_dvec3(), y.as_dvec3(), x.cross(y).as_dvec3()));
    (scale, rotation.normalize())
}

/// -1 along z if a transform mirrors.
fn mirrored_z(linear: Mat3A) -> Vec3 {
    let mirrors = linear.as_dmat3().determinant() < 0.0;
    Vec3::new(1.0, 1.0, if mirrors { -1.0 } else { 1.0 })
}

/// The unit normal of a plane that a transform has moved. `None` if the transform flattens it to a line.
fn placed_normal(normal: Vec3, linear: Mat3A) -> Option<Vec3> {
    let (m, n) = (linear.as_dmat3(), normal.as_dvec3());
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    let side = x.dot(y.cross(z)).signum();
    let moved = (y.cross(z) * n.x + z.cross(x) * n.y + x.cross(y) * n.z) * side;
    moved.try_normalize().map(DVec3::as_vec3)
}

#[cfg(test)]
mod tests {
    use bevy::math::Affine3A;

    use super::*;
    use crate::components::MorphConvexHull;

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
            MorphShape::RoundCuboid {
                half_extents: Vec3::new(1.0, 2.0, 0.1),
                border_radius: 0.3,
            },
            MorphShape::from(Cylinder::new(0.4, 3.0)),
            MorphShape::from(MorphConvexHull::new(&[Vec3::X, Vec3::ONE, Vec3::NEG_Y, Vec3::Z * 2.0]).unwrap()),
            MorphShape::from(ConicalFrustum {
                radius_top: 0.4,
                radius_bottom: 0.3,
                height: 2.0,
            }),
        ];
        for shape in shapes {
            let (placed, bounds) = shape.place(&place).unwrap();
            let center = bounds.center();
            for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                // Points just outside the box's faces: some are near the shape, but none is inside it.
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
    fn sheared_flattened_and_mirrored_places_have_a_rotation() {
        let turned = Mat3A::from_quat(Quat::from_euler(EulerRot::XYZ, 0.5, 1.0, -0.7));
        let scaled = |x: f32, y: f32, z: f32| Mat3A::from_diagonal(Vec3::new(x, y, z));
        for linear in [
            scaled(1.0, 3.0, 1.0) * turned,
            scaled(1.0, 1.3, 1.0) * turned * scaled(-1.0, 1.0, 2.0),
            scaled(0.0, 1.0, 1.0) * turned,
            turned * scaled(0.0, 1.0, 1.0),
            turned * scaled(1.0, 0.0, 0.0),
            Mat3A::ZERO,
        ] {
            let (scale, rotation) = scale_and_rotation(linear);
            assert!(
                (rotation.length() - 1.0).abs() < 1e-5 && scale.is_finite(),
                "{linear:?}"
            );
            if scale.x > 0.0 {
                let x = Vec3::from(linear.x_axis).normalize();
                assert!((rotation * DVec3::X).as_vec3().distance(x) < 1e-5, "{linear:?}");
            }
            let place = GlobalTransform::from(Affine3A::from_mat3_translation(linear.into(), Vec3::ONE));
            assert!(MorphShape::Ball { radius: 1.0 }.place(&place).is_ok());
        }
    }

    #[test]
    fn planes_and_hulls_follow_their_transforms() {
        let hull = MorphConvexHull::new(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]).unwrap();
        let slope = MorphShape::HalfSpace {
            normal: Vec3::new(1.0, 1.0, 0.5),
        };
        for scale in [
            Vec3::ONE,
            Vec3::new(2.0, 0.5, 3.0),
            Vec3::new(1.0, 1.0, -1.0),
            Vec3::new(-2.0, 0.5, 1.0),
            Vec3::new(1.0, -1.0, 1.0),
            Vec3::splat(-1.0),
        ] {
            let turned = Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.0);
            let place = Transform::from_xyz(3.0, -2.0, 7.0)
                .with_rotation(turned)
                .with_scale(scale);
            let world = |p: Vec3| place.transform_point(p).as_dvec3();
            let plane = slope.place(&place.into()).unwrap().0;
            // In its plane, above and below it.
            assert!(
                plane.signed_distance(world(Vec3::new(1.0, -1.0, 0.0))).abs() < 1e-5,
                "{scale}"
            );
            assert!(plane.signed_distance(world(Vec3::new(0.0, 0.0, 1.0))) > 0.1, "{scale}");
            assert!(
                plane.signed_distance(world(Vec3::new(-1.0, 0.5, 0.0))) < -0.1,
                "{scale}"
            );
            let hull = MorphShape::from(hull.clone()).place(&place.into()).unwrap().0;
            assert!(hull.signed_distance(world(Vec3::new(0.9, 0.02, 0.02))) < 0.0, "{scale}");
            assert!(
                hull.signed_distance(world(Vec3::new(-0.9, 0.02, 0.02))) > 0.1,
                "{scale}"
            );
            assert!(
                hull.signed_distance(world(Vec3::new(0.02, -0.9, 0.02))) > 0.1,
                "{scale}"
            );
            assert!(
                hull.signed_distance(world(Vec3::new(0.02, 0.02, -0.9))) > 0.1,
                "{scale}"
            );
        }
        let flattened = Transform::from_scale(Vec3::new(1.0, 1.0, 0.0));
        assert!(MorphShape::from(hull).place(&flattened.into()).is_err());
        assert!(slope.place(&flattened.into()).is_ok());
        assert!(slope.place(&Transform::from_scale(Vec3::ZERO).into()).is_ok());
    }

    #[test]
    fn bad_numbers_are_errors() {
        let shape = MorphShape::Ball { radius: -1.0 };
        assert!(shape.place(&GlobalTransform::IDENTITY).is_err());
        let nan = GlobalTransform::from(Affine3A::from_translation(Vec3::NAN));
        assert!(MorphShape::Ball { radius: 1.0 }.place(&nan).is_err());
    }
}
