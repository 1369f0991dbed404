//! Rays for the rivals: their transform to a body's space, and tests against boxes and triangles there.
//!
//! Boxes are tested in `f32` with a slack that covers all rounding, triangles in `f64` by Moller and Trumbore's test. Unlike the
//! core's test it is not exact: a ray through an edge may miss both triangles, or hit either.

use glam::{Affine3A, DAffine3, DMat3, DVec3, Vec3, Vec3A};
use morph_collision::Triangle;

use super::blended::BlendedBody;
use super::boxes::{Box3, Box8, LANES};

/// A ray in world space: `origin + t direction` for `t >= 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CastRay {
    /// The start of the ray.
    pub origin: DVec3,
    /// The direction, of any length but 0.
    pub direction: DVec3,
}

/// The first hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CastHit {
    /// The triangle.
    pub triangle: u32,
    /// The ray's parameter at the hit.
    pub t: f64,
}

impl CastRay {
    /// The ray in a body's space; `None` if its placement cannot be inverted.
    pub(super) fn in_model(&self, world_from_model: &Affine3A) -> Option<Self> {
        let m = world_from_model.matrix3;
        let linear = DMat3::from_cols(m.x_axis.as_dvec3(), m.y_axis.as_dvec3(), m.z_axis.as_dvec3());
        let place = DAffine3::from_mat3_translation(linear, world_from_model.translation.as_dvec3());
        let inverse = place.inverse();
        let ray = Self {
            origin: inverse.transform_point3(self.origin),
            direction: inverse.transform_vector3(self.direction),
        };
        (ray.origin.is_finite() && ray.direction.is_finite() && ray.direction != DVec3::ZERO).then_some(ray)
    }

    /// The parameter where it hits a triangle, if not beyond `limit`.
    #[inline]
    pub(super) fn meets(&self, [a, b, c]: &Triangle, limit: f64) -> Option<f64> {
        let (ab, ac) = (*b - *a, *c - *a);
        let across = self.direction.cross(ac);
        let determinant = ab.dot(across);
        if determinant == 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let from_a = self.origin - *a;
        let u = from_a.dot(across) * inverse;
        let along = from_a.cross(ab);
        let v = self.direction.dot(along) * inverse;
        let t = ac.dot(along) * inverse;
        let is_hit = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=limit).contains(&t);
        is_hit.then_some(t)
    }
}

/// Replaces a hit by a nearer one. Of hits at the same place, the one with the lower triangle index wins.
pub(super) fn keep_nearest(nearest: &mut Option<CastHit>, triangle: u32, t: f64) {
    if nearest.is_none_or(|hit| (t, triangle) < (hit.t, hit.triangle)) {
        *nearest = Some(CastHit { triangle, t });
    }
}

/// Casts without a tree, for a body that is flat in world space.
pub(super) fn cast_at_all(body: &BlendedBody, posed: &[Vec3], ray: &CastRay) -> Option<CastHit> {
    let mut nearest = None;
    for (triangle, &corners) in (0..).zip(&body.mesh.triangles) {
        if let Some(t) = ray.meets(&body.world_triangle(posed, corners), f64::INFINITY) {
            keep_nearest(&mut nearest, triangle, t);
        }
    }
    nearest
}

/// A ray prepared for tests against a body's boxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxRay {
    origin: Vec3A,
    /// One over the direction.
    inverse: Vec3A,
    slack: f32,
}

impl BoxRay {
    /// `ray` is in the body's space, `bounds` is a box around the body.
    pub(super) fn new(ray: &CastRay, bounds: &Box3) -> Self {
        /// More than all rounding of a coordinate, including that of the vertices in world space.
        const ROUNDINGS: f32 = 32.0 * f32::EPSILON;
        let origin = ray.origin.as_vec3a();
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element() + origin.abs().max_element();
        let inverse = ray.direction.to_array().map(|along| {
            let inverse = (1.0 / along) as f32;
            // If the ray is parallel to a box's sides, the ends of its slab are far away on either side, or both on one.
            if inverse.abs() < 1e30 { inverse } else { 1e30 }
        });
        Self {
            origin,
            inverse: Vec3A::from_array(inverse),
            slack: reach * ROUNDINGS + f32::MIN_POSITIVE,
        }
    }

    /// Where the ray enters eight boxes, and the lanes of those that it hits before `limit`.
    #[inline]
    pub(super) fn enter(&self, boxes: &Box8, limit: f32) -> ([f32; LANES], u8) {
        let (mut enter, mut leave) = ([0.0_f32; LANES], [limit; LANES]);
        for axis in 0..3 {
            let (origin, inverse) = (self.origin[axis], self.inverse[axis]);
            for lane in 0..LANES {
                let low = (boxes.min[axis][lane] - self.slack - origin) * inverse;
                let high = (boxes.max[axis][lane] + self.slack - origin) * inverse;
                enter[lane] = enter[lane].max(low.min(high));
                leave[lane] = leave[lane].min(low.max(high));
            }
        }
        let mut mask = 0;
        for lane in 0..LANES {
            enter[lane] *= 1.0 - 4.0 * f32::EPSILON;
            // Empty lanes enter at infinity.
            mask |= u8::from(enter[lane] <= leave[lane] * (1.0 + 4.0 * f32::EPSILON)) << lane;
        }
        (enter, mask)
    }
}

/// The ray in Parry's form.
pub(super) fn parry_ray(ray: &CastRay) -> parry3d::query::Ray {
    let vector = |v: DVec3| -> Vec3 { v.as_vec3() };
    parry3d::query::Ray::new(vector(ray.origin), vector(ray.direction))
}
