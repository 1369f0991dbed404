//! Rigid primitive shapes as colliders.

use std::ops::RangeInclusive;

use bevy::prelude::*;

use super::collider::MorphCollider;
use super::convex_hull::MorphConvexHull;
use super::unit::MorphUnit;

/// The sizes that [`PlacedShape::new`](morph_collision::PlacedShape::new) accepts.
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
/// - A box and a convex hull are scaled along each axis, and a hull is mirrored if the transform mirrors. The length of a capsule, a cylinder or
///   a cone is scaled along y. A radius takes the largest scale of the axes around which it is round.
/// - Shear is ignored: a sheared shape keeps its right angles. Only the plane of a half-space follows it.
///
/// For a compound, give a body several colliders:
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn spawn_dumbbell(mut commands: Commands) {
///     let body = commands.spawn(Transform::default()).id();
///     for x in [-1.0, 1.0] {
///         let ball = (MorphShape::Ball { radius: 0.4 }, Transform::from_xyz(x, 0.0, 0.0));
///         commands.spawn((ball, ChildOf(body), MorphColliderOf { body }));
///     }
/// }
/// # App::new().add_systems(Startup, spawn_dumbbell);
/// ```
///
/// Two shapes never collide with each other; leave that to a physics engine.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
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
    /// All points within a radius of a box around the origin.
    RoundCuboid {
        /// Half the edge lengths of the inner box, without the round border.
        #[reflect(@SIZES, @MorphUnit::Length)]
        half_extents: Vec3,
        /// The radius of the border, which adds to the size.
        #[reflect(@SIZES, @MorphUnit::Length)]
        border_radius: f32,
    },
    /// A cylinder along the y axis, around the origin.
    Cylinder {
        /// Half the height.
        #[reflect(@SIZES, @MorphUnit::Length)]
        half_height: f32,
        /// The radius.
        #[reflect(@SIZES, @MorphUnit::Length)]
        radius: f32,
    },
    /// A cone along the y axis, with its tip above. The origin is halfway up.
    Cone {
        /// Half the height.
        #[reflect(@SIZES, @MorphUnit::Length)]
        half_height: f32,
        /// The radius of the base.
        #[reflect(@SIZES, @MorphUnit::Length)]
        radius: f32,
    },
    /// A cone along the y axis whose tip has been cut off. The origin is halfway up.
    ConicalFrustum {
        /// Half the height.
        #[reflect(@SIZES, @MorphUnit::Length)]
        half_height: f32,
        /// The radius of the lower disc.
        #[reflect(@SIZES, @MorphUnit::Length)]
        bottom_radius: f32,
        /// The radius of the upper disc. It may be the larger one.
        #[reflect(@SIZES, @MorphUnit::Length)]
        top_radius: f32,
    },
    /// The convex hull of points, for example of a mesh.
    ConvexHull(MorphConvexHull),
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

impl From<Cylinder> for MorphShape {
    fn from(Cylinder { radius, half_height }: Cylinder) -> Self {
        Self::Cylinder { half_height, radius }
    }
}

impl From<Cone> for MorphShape {
    fn from(Cone { radius, height }: Cone) -> Self {
        Self::Cone {
            half_height: 0.5 * height,
            radius,
        }
    }
}

impl From<ConicalFrustum> for MorphShape {
    fn from(frustum: ConicalFrustum) -> Self {
        Self::ConicalFrustum {
            half_height: 0.5 * frustum.height,
            bottom_radius: frustum.radius_bottom,
            top_radius: frustum.radius_top,
        }
    }
}

impl From<InfinitePlane3d> for MorphShape {
    fn from(InfinitePlane3d { normal }: InfinitePlane3d) -> Self {
        Self::HalfSpace { normal: *normal }
    }
}

impl From<MorphConvexHull> for MorphShape {
    fn from(hull: MorphConvexHull) -> Self {
        Self::ConvexHull(hull)
    }
}
