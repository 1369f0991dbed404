//! Points that stay on a surface.

use glam::DVec3;

use super::body::Body;
use crate::exact::Triangle;

/// A point on a mesh's surface that follows it as the shape and the body move.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{DVec3, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// # let world_from_model = WorldFromModel::IDENTITY;
/// let anchor = SurfaceAnchor { triangle: 0, barycentrics: [0.5, 0.5, 0.0] };
/// pose.set_weights(&[2.0])?;
/// assert_eq!(anchor.point(Body::new(&mut pose, &world_from_model)), Some(DVec3::new(0.5, 0.0, 2.0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceAnchor {
    /// The triangle's index in its mesh.
    pub triangle: u32,
    /// The barycentric coordinates in the triangle.
    pub barycentrics: [f64; 3],
}

/// The position of a [`SurfaceAnchor`] and the orientation of the surface there, as three orthogonal unit vectors in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFrame {
    /// The anchor's position.
    pub point: DVec3,
    /// The direction of the edge from the triangle's first corner to its second.
    pub tangent: DVec3,
    /// `normal x tangent`.
    pub bitangent: DVec3,
    /// The triangle's normal, from its winding in world space.
    pub normal: DVec3,
}

impl SurfaceAnchor {
    /// Returns the anchor's position in world space; `None` if the mesh has no such triangle.
    ///
    /// Cost: blends the triangle's corners if they are not cached for the current weights.
    #[must_use]
    pub fn point(&self, body: Body<'_>) -> Option<DVec3> {
        Some(self.point_on(&self.corners(body)?))
    }

    /// Returns the anchor's position and orientation; `None` if the mesh has no such triangle, or if the triangle has no area.
    #[must_use]
    pub fn frame(&self, body: Body<'_>) -> Option<SurfaceFrame> {
        let triangle = self.corners(body)?;
        let [a, b, c] = triangle;
        let tangent = (b - a).try_normalize()?;
        let normal = (b - a).cross(c - a).try_normalize()?;
        // Orthogonalise again, for slivers.
        let normal = (normal - tangent * tangent.dot(normal)).try_normalize()?;
        Some(SurfaceFrame {
            point: self.point_on(&triangle),
            tangent,
            bitangent: normal.cross(tangent),
            normal,
        })
    }

    fn corners(&self, mut body: Body<'_>) -> Option<Triangle> {
        body.triangle(self.triangle)
    }

    /// Computes the point relative to the first corner: the sum of the barycentrics is rounded, which would matter far from the origin.
    fn point_on(&self, &[a, b, c]: &Triangle) -> DVec3 {
        let [_, v, w] = self.barycentrics;
        a + ((b - a) * v + (c - a) * w)
    }
}
