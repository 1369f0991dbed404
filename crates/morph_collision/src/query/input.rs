//! What one-body queries are asked about, validated once: rays, balls and convex regions of world space.

use crate::InputError;
use crate::bounds::Aabb;
use crate::exact::{Line, Plane, power_of_two_below};
use crate::input_error::{check_direction, check_length, check_number, check_point};
use glam::DVec3;

/// A ray of world space: the points `origin + t direction` for all real `t` from 0 to `max_t`.
///
/// The direction need not have length 1; `t` counts in its lengths. The ray is these points exactly, not a rounded set of them.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub(super) line: Line,
    /// A power of two: the direction over that of `line`.
    pub(super) scale: f64,
}

impl Ray {
    /// A ray; `max_t` may be infinite.
    ///
    /// # Errors
    /// [`InputError`] if the origin is not finite (or beyond 1e50), the direction zero or not finite, `max_t` negative or NaN.
    pub fn new(origin: DVec3, direction: DVec3, max_t: f64) -> Result<Self, InputError> {
        check_point("origin", origin)?;
        check_direction("direction", direction)?;
        check_length("max_t", max_t)?;
        let scale = power_of_two_below(direction.abs().max_element());
        let line = Line {
            origin,
            direction: direction / scale,
            max_t: max_t * scale,
        };
        Ok(Self { line, scale })
    }

    /// Where it starts.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.line.origin
    }

    /// Its direction, as given.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.line.direction * self.scale
    }
}

/// A closed ball of world space: where to look for a closest point, or what to test for overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

impl Ball {
    /// The points within `radius` of a point; the radius may be 0 or infinite.
    ///
    /// # Errors
    /// [`InputError`] if the centre is not finite (or beyond 1e50), or the radius negative or NaN.
    pub fn new(center: DVec3, radius: f64) -> Result<Self, InputError> {
        check_point("center", center)?;
        check_length("radius", radius)?;
        Ok(Self { center, radius })
    }

    /// All of space, seen from a point: to look for the closest point however far it is.
    ///
    /// # Errors
    /// As [`Ball::new`].
    pub fn unbounded(center: DVec3) -> Result<Self, InputError> {
        Self::new(center, f64::INFINITY)
    }
}

/// A closed half-space of world space: the points `x` with `normal . x + offset >= 0`, as a camera's frustum has six.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    plane: Plane,
}

impl HalfSpace {
    /// A half-space; the normal points into it and may have any length but 0.
    ///
    /// # Errors
    /// [`InputError`] if the normal is zero or not finite, or the offset not finite (or beyond 1e50 normals).
    pub fn new(normal: DVec3, offset: f64) -> Result<Self, InputError> {
        check_direction("normal", normal)?;
        let scale = power_of_two_below(normal.abs().max_element());
        let plane = Plane {
            normal: normal / scale,
            offset: offset / scale,
        };
        let is_good = plane.offset.abs() <= 1e50;
        check_number("offset", offset, is_good, "at most 1e50 times the length of the normal")?;
        Ok(Self { plane })
    }
}

/// A closed convex region of world space: an intersection of half-spaces, bounded or not; it may be empty.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexRegion {
    pub(super) planes: Vec<Plane>,
}

impl ConvexRegion {
    /// The points that lie in all of some half-spaces; all of space where there is none.
    #[must_use]
    pub fn from_half_spaces(half_spaces: &[HalfSpace]) -> Self {
        Self {
            planes: half_spaces.iter().map(|half_space| half_space.plane).collect(),
        }
    }

    /// The points of a box, exactly; none if an upper end is below the lower one.
    ///
    /// # Errors
    /// [`InputError`] if a coordinate is not finite.
    pub fn from_box(bounds: &Aabb) -> Result<Self, InputError> {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        check_point("min", min)?;
        check_point("max", max)?;
        let slab = |axis: usize| {
            let normal = DVec3::AXES[axis];
            [(normal, -min[axis]), (-normal, max[axis])].map(|(normal, offset)| Plane { normal, offset })
        };
        Ok(Self {
            planes: (0..3).flat_map(slab).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_input_is_turned_away_and_named() {
        let message = |error: Option<InputError>| error.map(|e| e.to_string()).unwrap_or_default();
        let nan = DVec3::new(0.0, f64::NAN, 0.0);
        let origin = message(Ray::new(nan, DVec3::X, 1.0).err());
        assert!(origin.contains("origin: coordinate 1 is NaN"), "{origin}");
        assert!(message(Ray::new(DVec3::ZERO, DVec3::ZERO, 1.0).err()).contains("direction"));
        assert!(message(Ray::new(DVec3::ZERO, nan, 1.0).err()).contains("direction"));
        assert!(message(Ray::new(DVec3::ZERO, DVec3::X, -1.0).err()).contains("max_t"));
        assert!(message(Ray::new(DVec3::ZERO, DVec3::X, f64::NAN).err()).contains("max_t"));
        assert!(message(Ball::new(DVec3::splat(1e60), 1.0).err()).contains("center"));
        assert!(message(Ball::new(DVec3::ZERO, -0.5).err()).contains("radius"));
        assert!(message(HalfSpace::new(DVec3::ZERO, 0.0).err()).contains("normal"));
        assert!(message(HalfSpace::new(DVec3::X, f64::INFINITY).err()).contains("offset"));
        assert!(message(ConvexRegion::from_box(&Aabb::EMPTY).err()).contains("min"));
        assert!(Ray::new(DVec3::ZERO, DVec3::splat(5e-324), f64::INFINITY).is_ok());
    }
}
