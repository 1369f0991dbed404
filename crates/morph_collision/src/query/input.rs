//! Rays and convex regions in world space, validated once.

use crate::bounds::Aabb;
use crate::exact::{Line, Plane, power_of_two_below};
use crate::input_error::InputError;
use crate::input_error::{check_direction, check_length, check_number, check_point};
use glam::DVec3;

/// A ray in world space: the points `origin + t * direction` for all real `t` from 0 to `max_t`, without rounding.
///
/// The direction may have any nonzero length; `t` is in units of that length.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub(super) line: Line,
    /// The given direction is this times the direction of `line`. A power of two.
    pub(super) scale: f64,
}

impl Ray {
    /// Creates a ray; `max_t` may be infinite.
    ///
    /// # Errors
    /// [`InputError`] if the origin is not finite or beyond 1e50, if the direction is zero or not finite, or if `max_t` is negative or
    /// NaN.
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
}

/// A closed convex region of world space: an intersection of half-spaces. It may be unbounded or empty.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexRegion {
    pub(super) planes: Vec<Plane>,
}

impl ConvexRegion {
    /// Creates the region of points `x` with `normal . x + offset >= 0` for every `(normal, offset)`. An empty list gives all of space.
    ///
    /// Normals point inward and may have any nonzero length. A camera's frustum has six half-spaces.
    ///
    /// # Errors
    /// [`InputError`] if a normal is zero or not finite, or if an offset is not finite or larger than about 1e50 times the largest
    /// coordinate of its normal.
    pub fn from_half_spaces(half_spaces: &[(DVec3, f64)]) -> Result<Self, InputError> {
        let plane = |(i, &(normal, offset)): (usize, &(DVec3, f64))| {
            let of_this = |error: InputError| error.of(&format!("half-space {i}"));
            check_direction("normal", normal).map_err(of_this)?;
            let scale = power_of_two_below(normal.abs().max_element());
            let (normal, scaled) = (normal / scale, offset / scale);
            let expected = "at most about 1e50 times the largest coordinate of the normal";
            check_number("offset", offset, scaled.abs() <= 1e50, expected).map_err(of_this)?;
            Ok(Plane { normal, offset: scaled })
        };
        let planes = half_spaces.iter().enumerate().map(plane).collect::<Result<_, _>>()?;
        Ok(Self { planes })
    }

    /// Creates a region that is exactly a box. It is empty if an upper end is below the lower one.
    ///
    /// # Errors
    /// [`InputError`] if a coordinate is not finite.
    pub fn from_aabb(aabb: &Aabb) -> Result<Self, InputError> {
        let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
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
        let region = |half_space| message(ConvexRegion::from_half_spaces(&[half_space]).err());
        assert!(region((DVec3::ZERO, 0.0)).contains("half-space 0: normal"));
        assert!(region((DVec3::X, f64::INFINITY)).contains("half-space 0: offset is inf"));
        assert!(message(ConvexRegion::from_aabb(&Aabb::EMPTY).err()).contains("min"));
        assert!(Ray::new(DVec3::ZERO, DVec3::splat(5e-324), f64::INFINITY).is_ok());
    }
}
