//! The kinds of shapes.

use std::sync::Arc;

use glam::Vec3;

use super::ConvexHull;

/// A convex shape in its own space. All shapes are closed: they include their surfaces.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A solid ball around the origin.
    Ball {
        /// The radius; 0 gives a point.
        radius: f32,
    },
    /// All points within a radius of a segment along the y axis.
    Capsule {
        /// Half the length of the segment, without the round ends.
        half_length: f32,
        /// The radius; 0 gives a segment.
        radius: f32,
    },
    /// A solid box around the origin.
    Cuboid {
        /// Half the edge lengths; a 0 gives a flat box.
        half_extents: Vec3,
    },
    /// All points within a radius of a box around the origin.
    RoundCuboid {
        /// Half the edge lengths of the inner box, without the round border.
        half_extents: Vec3,
        /// The radius of the border, which adds to the size.
        border_radius: f32,
    },
    /// A solid cylinder along the y axis, around the origin.
    Cylinder {
        /// Half the height; 0 gives a disc.
        half_height: f32,
        /// The radius; 0 gives a segment.
        radius: f32,
    },
    /// A solid cone along the y axis, with its tip above. The origin is halfway up.
    Cone {
        /// Half the height; 0 gives a disc.
        half_height: f32,
        /// The radius of the base; 0 gives a segment.
        radius: f32,
    },
    /// A solid cone along the y axis whose tip has been cut off. The origin is halfway up.
    ConicalFrustum {
        /// Half the height; 0 gives a disc.
        half_height: f32,
        /// The radius of the lower disc.
        bottom_radius: f32,
        /// The radius of the upper disc. It may be the larger one.
        top_radius: f32,
    },
    /// The convex hull of points.
    ConvexHull(Arc<ConvexHull>),
    /// A plane through the origin and everything below it.
    HalfSpace {
        /// The direction out of the half-space. It may have any nonzero length.
        normal: Vec3,
    },
}
