//! Rigid primitive shapes as colliders.

use std::ops::RangeInclusive;

use bevy::math::Mat3A;
use bevy::prelude::*;
use morph_collision::{Aabb, InputError, PlacedShape, Shape};

use super::collider::MorphCollider;
use super::unit::MorphUnit;

/// The sizes that [`PlacedShape::new`] accepts.
const SIZES: RangeInclusive<f32> = 0.0..=1e37;

/// A rigid primitive shape that collides with morphing and rigid meshes. The default is a ball of radius 0.5.
///
/// Convert from Bevy's primitives with `From`:
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn spawn(mut commands: Commands) {
///     commands.spawn((MorphShape::from(Capsule3d::new(0.3, 1.2)), Transform::from_xyz(0.0, 1.0, 0.0)));
/// }
/// # App::new().add_systems(Startup, spawn);
/// ```
///
/// On an entity that also has a [`Mesh3d`], the shape wins: the mesh does not collide, and no tree is built for it. You can add
/// or remove the shape at any time. After you remove it, the mesh collides as soon as its tree is ready.
///
/// Spatial queries find shapes. Picking, [`MorphSurfaceAnchor`](crate::surface::MorphSurfaceAnchor) and `MorphPhysicsCollider` need a mesh
/// that collides, so they ignore an entity with a shape. To pick its mesh, use Bevy's `MeshPickingPlugin`.
///
/// Shapes are solid. The [`GlobalTransform`] places them:
///
/// - A box is scaled along each axis. A capsule's length is scaled along y. A radius takes the largest scale of the axes around
///   which it is round.
/// - Shear is ignored: a sheared shape keeps its right angles.
///
/// Two shapes never collide with each other; leave that to a physics engine.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphCollider)]
pub enum MorphShape {
    /// A ball around the origin.
    Ball {
        /// The radius.
        #[reflect(@SIZES, @MorphUnit::Length)]
        radius: f32,
    },
    /// All points within a radius of a segment along the y axis.
    Capsule {
        /// Half the length of the segment, without the round ends.
        #[reflect(@SIZES, @MorphUnit::Length)]
        half_length: f32,
        /// The radius.
        #[reflect(@SIZES, @MorphUnit::Length)]
        radius: f32,
    },
    /// A box around the origin.
    Cuboid {
        /// Half the edge lengths.
        #[reflect(@SIZES, @MorphUnit::Length)]
        half_extents: Vec3,
    },
    /// Everything below the plane through the origin.
    HalfSpace {
        /// The up direction; any length except 0.
        normal: Vec3,
    },
}

impl Default for MorphShape {
    fn default() -> Self {
        Self::Ball { radius: 0.5 }
    }
}

impl From<Sphere> for MorphShape {
    fn from(Sphere { radius }: Sphere) -> Self {
        Self::Ball { radius }
    }
}

impl From<Capsule3d> for MorphShape {
    fn from(Capsule3d { radius, half_length }: Capsule3d) -> Self {
        Self::Capsule { half_length, radius }
    }
}

impl From<Cuboid> for MorphShape {
    fn from(Cuboid { half_size }: Cuboid) -> Self {
        Self::Cuboid {
            half_extents: half_size,
        }
    }
}

impl MorphShape {
    /// The shape in world space, and a box around it.
    pub(crate) fn place(&self, transform: &GlobalTransform) -> Result<(PlacedShape, Aabb), InputError> {
        let (scale, rotation) = scale_and_rotation(transform.affine().matrix3);
        let translation = transform.translation();
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
        let shape = PlacedShape::new(shape, rotation, translation)?;
        // The rounding errors of all this are far below a millionth.
        let slack = 1e-6 * (half + translation.abs()) + f32::MIN_POSITIVE;
        let bounds = Aabb {
            min: translation - half - slack,
            max: translation + half + slack,
        };
        Ok((shape, bounds))
    }
}

/// The lengths of the axes, and a nearby rotation: it maps x exactly to the first axis, and y to the part of the second axis that
/// is perpendicular to the first. Mirroring the third axis does not matter because the shapes are symmetric.
fn scale_and_rotation(linear: Mat3A) -> (Vec3, Quat) {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis].map(Vec3::from);
    let scale = Vec3::new(x.length(), y.length(), z.length());
    let x = x
        .try_normalize()
        .unwrap_or_else(|| y.cross(z).try_normalize().unwrap_or(Vec3::X));
    let across = |v: Vec3| (v - x * x.dot(v)).try_normalize();
    let y = across(y)
        .or_else(|| across(z.cross(x)))
        .unwrap_or_else(|| x.any_orthonormal_vector());
    (scale, Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y))).normalize())
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
                assert!((rotation * Vec3::X).distance(x) < 1e-5, "{linear:?}");
            }
            let place = GlobalTransform::from(Affine3A::from_mat3_translation(linear.into(), Vec3::ONE));
            assert!(MorphShape::Ball { radius: 1.0 }.place(&place).is_ok());
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
