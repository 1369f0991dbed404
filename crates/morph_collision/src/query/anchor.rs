use glam::{DMat3, DVec3};

use super::body::{Body, world_triangle};
use super::point::ClosestPoint;
use super::ray::RayHit;
use crate::exact::Triangle;

/// A place on a mesh's surface that stays with it as the shape and the body move.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{DVec3, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// # let place = WorldFromModel::IDENTITY;
/// let anchor = SurfaceAnchor { triangle: 0, barycentrics: [0.5, 0.5, 0.0] };
/// pose.set_weights(&[2.0])?;
/// assert_eq!(anchor.point(Body::new(&mut pose, &place)), Some(DVec3::new(0.5, 0.0, 2.0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceAnchor {
    /// The triangle's number in its mesh.
    pub triangle: u32,
    /// The weights of the triangle's corners.
    pub barycentrics: [f64; 3],
}

/// Where a [`SurfaceAnchor`] is, and which way the surface faces there: three orthogonal unit vectors in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFrame {
    /// The anchor's place.
    pub point: DVec3,
    /// Along the edge from the triangle's first corner to its second.
    pub tangent: DVec3,
    /// `normal x tangent`.
    pub bitangent: DVec3,
    /// The triangle's normal by its winding in world space.
    pub normal: DVec3,
}

impl SurfaceAnchor {
    /// Where the anchor is in world space; `None` if the mesh has no such triangle.
    ///
    /// Cost: the triangle's corners are blended, unless they already were for these weights.
    #[must_use]
    pub fn point(&self, body: Body<'_>) -> Option<DVec3> {
        Some(self.point_on(&self.corners(body)?))
    }

    /// As [`SurfaceAnchor::point`] with the directions of the surface; `None` also where the triangle has no area.
    #[must_use]
    pub fn frame(&self, body: Body<'_>) -> Option<SurfaceFrame> {
        let triangle = self.corners(body)?;
        let [a, b, c] = triangle;
        let tangent = (b - a).try_normalize()?;
        let normal = (b - a).cross(c - a).try_normalize()?;
        // Orthogonal up to one rounding, whatever the triangle's shape.
        let normal = (normal - tangent * tangent.dot(normal)).try_normalize()?;
        Some(SurfaceFrame {
            point: self.point_on(&triangle),
            tangent,
            bitangent: normal.cross(tangent),
            normal,
        })
    }

    fn corners(&self, body: Body<'_>) -> Option<Triangle> {
        let exists = (self.triangle as usize) < body.pose.bvh().model().triangle_count();
        exists.then(|| world_triangle(&mut body.pose.posed(), body.world_from_model, self.triangle))
    }

    /// Relative to the first corner, so that barycentrics that sum to 1 up to rounding do not magnify a far place.
    fn point_on(&self, &[a, b, c]: &Triangle) -> DVec3 {
        let [_, v, w] = self.barycentrics;
        a + ((b - a) * v + (c - a) * w)
    }
}

impl SurfaceFrame {
    /// The rotation from the frame's axes (tangent, bitangent, normal) to world space.
    #[must_use]
    pub fn world_from_frame(&self) -> DMat3 {
        DMat3::from_cols(self.tangent, self.bitangent, self.normal)
    }
}

impl From<&RayHit> for SurfaceAnchor {
    fn from(hit: &RayHit) -> Self {
        Self {
            triangle: hit.triangle,
            barycentrics: hit.barycentrics,
        }
    }
}

impl From<&ClosestPoint> for SurfaceAnchor {
    fn from(closest: &ClosestPoint) -> Self {
        Self {
            triangle: closest.triangle,
            barycentrics: closest.barycentrics,
        }
    }
}
