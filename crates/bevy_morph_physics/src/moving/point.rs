//! Points of a surface: their positions and velocities.

use bevy::math::{DVec3, Vec3};
use morph_collision::{Body, ClosestPoint, Pose, ShapeQuery, WorldFromModel};

use super::surface::MovingSurface;
use crate::math::{between, into_query};

/// A point of a mesh.
#[derive(Clone, Copy)]
pub struct SurfacePoint {
    /// As numbered in the mesh.
    pub triangle: u32,
    /// The weights of the triangle's corners.
    pub barycentrics: DVec3,
}

impl From<ClosestPoint> for SurfacePoint {
    fn from(closest: ClosestPoint) -> Self {
        Self {
            triangle: closest.triangle,
            barycentrics: DVec3::from_array(closest.barycentrics),
        }
    }
}

impl SurfacePoint {
    /// Its position, and the normal of its triangle by its winding, if there is one.
    pub fn locate(&self, pose: &mut Pose, world_from_model: &WorldFromModel) -> Option<(DVec3, Option<DVec3>)> {
        let corners = pose.triangle(self.triangle)?;
        let [a, b, c] = corners.map(|corner| world_from_model.transform_point(corner));
        let [i, j, k] = self.barycentrics.to_array();
        Some((a * i + b * j + c * k, (b - a).cross(c - a).try_normalize()))
    }
}

impl MovingSurface {
    /// The velocity of a point during the coming step or the last one, in world units per second. Zero while a jump is not
    /// confirmed as a motion, as for bodies. `None` if the triangle does not exist.
    pub fn velocity_at(&mut self, point: SurfacePoint) -> Option<DVec3> {
        let corners = self.bvh().model().triangle(point.triangle)?;
        if !self.is_in_motion() || self.last_step() <= 0.0 {
            return Some(DVec3::ZERO);
        }
        let [mut now, mut before, mut velocities] = [const { Vec::new() }; 3];
        self.vertices(&corners, &mut now);
        self.moments.start.vertices(&corners, &mut before);
        between(&before, &now, self.motion_time(), &mut velocities);
        if !self.is_motion(&corners, &before, &velocities) {
            return Some(DVec3::ZERO);
        }
        let shares = point.barycentrics.to_array();
        Some(
            velocities
                .iter()
                .zip(shares)
                .map(|(velocity, share)| share * velocity)
                .sum(),
        )
    }

    /// The velocity of a point, given by a triangle of the mesh and barycentric coordinates.
    pub fn velocity_in(&mut self, triangle: u32, barycentrics: Vec3) -> Option<Vec3> {
        let point = SurfacePoint {
            triangle,
            barycentrics: barycentrics.as_dvec3(),
        };
        Some(self.velocity_at(point)?.as_vec3())
    }

    /// The velocity of the point that is closest to a point in world space.
    pub fn velocity_near(&mut self, point: Vec3, query: &mut ShapeQuery) -> Option<Vec3> {
        let point = self.closest(point, query)?;
        Some(self.velocity_at(point)?.as_vec3())
    }

    /// The point of the surface that is closest to a point in world space.
    pub fn closest(&mut self, point: Vec3, query: &mut ShapeQuery) -> Option<SurfacePoint> {
        let mut posed = self.surface.lock();
        let pose = posed.pose.get();
        let point = into_query(point.as_dvec3(), pose, &self.moments.end);
        let body = Body::new(pose, &self.moments.end);
        let closest = query.closest_point(body, point, f64::INFINITY).ok()??;
        Some(closest.into())
    }
}
