//! The error for invalid values passed in by a caller, and the checks that return it.

use std::fmt;

use glam::DVec3;
use thiserror::Error;

/// Products of larger coordinates could overflow in `f64`.
const LARGEST: f64 = 1e50;

/// Why a value was rejected.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum InputError {
    /// A coordinate is NaN, infinite, or too large.
    #[error("{what}: coordinate {axis} is {}, not a finite number of at most {limit:e}", Short(*value))]
    BadCoordinate {
        /// The name of the vector.
        what: String,
        /// 0, 1 or 2 for x, y or z.
        axis: usize,
        /// The offending coordinate.
        value: f64,
        /// The largest magnitude allowed.
        limit: f64,
    },
    /// A direction or normal is zero or not finite.
    #[error("{what} is {value}, a direction must be finite and not zero")]
    NoDirection {
        /// The name of the direction.
        what: String,
        /// Its value.
        value: DVec3,
    },
    /// A list has the wrong length.
    #[error("{given} {what} were given, {expected} are needed")]
    WrongCount {
        /// The name of the list.
        what: String,
        /// Its length.
        given: usize,
        /// The length it should have.
        expected: usize,
    },
    /// Two things that belong together are of different trees.
    #[error("{what} must be of the same tree")]
    DifferentTrees {
        /// What they are.
        what: String,
    },
    /// The mesh is skinned, but must not be.
    #[error("{what} needs a mesh without joints, this one has {joints}")]
    SkinnedMesh {
        /// What needs the mesh.
        what: String,
        /// The number of its joints.
        joints: usize,
    },
    /// A number is NaN or out of range.
    #[error("{what} is {}, it must be {expected}", Short(*value))]
    BadNumber {
        /// The name of the number.
        what: String,
        /// Its value.
        value: f64,
        /// The allowed values.
        expected: &'static str,
    },
}

impl InputError {
    /// Prefixes the name in the error with the part of a list that it is about.
    pub(crate) fn of(mut self, part: &str) -> Self {
        let (Self::BadCoordinate { what, .. }
        | Self::NoDirection { what, .. }
        | Self::BadNumber { what, .. }
        | Self::DifferentTrees { what }
        | Self::SkinnedMesh { what, .. }
        | Self::WrongCount { what, .. }) = &mut self;
        *what = format!("{part}: {what}");
        self
    }
}

/// Prints a number without needless digits: as an `f32` if it is one.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        let single = value as f32;
        if value.abs() < 1e15 && value.fract() == 0.0 {
            write!(f, "{value}")
        } else if f64::from(single) == value {
            write!(f, "{single:?}")
        } else {
            write!(f, "{value:?}")
        }
    }
}

/// Checks that all coordinates are finite and at most 1e50.
pub(crate) fn check_point(what: &str, point: DVec3) -> Result<(), InputError> {
    check_vector(what, point, LARGEST)
}

/// Checks that all coordinates of all points are finite and at most 1e50. The error names the index of the first bad point.
pub(crate) fn check_points(points: &[DVec3]) -> Result<(), InputError> {
    match points.iter().position(|point| check_point("", *point).is_err()) {
        Some(index) => check_point(&format!("point {index}"), points[index]),
        None => Ok(()),
    }
}

/// Checks that all coordinates are finite and at most `limit`.
pub(crate) fn check_vector(what: &str, vector: DVec3, limit: f64) -> Result<(), InputError> {
    let is_bad = |value: &f64| value.is_nan() || value.abs() > limit;
    match vector.to_array().iter().position(is_bad) {
        Some(axis) => Err(InputError::BadCoordinate {
            what: what.to_owned(),
            axis,
            value: vector[axis],
            limit,
        }),
        None => Ok(()),
    }
}

/// Checks that a direction is finite and not zero.
pub(crate) fn check_direction(what: &str, value: DVec3) -> Result<(), InputError> {
    if !value.is_finite() || value == DVec3::ZERO {
        return Err(InputError::NoDirection {
            what: what.to_owned(),
            value,
        });
    }
    Ok(())
}

/// Checks that a length is neither NaN nor negative; it may be infinite.
pub(crate) fn check_length(what: &str, value: f64) -> Result<(), InputError> {
    check_number(what, value, value >= 0.0, "0 or more")
}

/// Returns an error unless `is_good`.
pub(crate) fn check_number(what: &str, value: f64, is_good: bool, expected: &'static str) -> Result<(), InputError> {
    if is_good {
        Ok(())
    } else {
        Err(InputError::BadNumber {
            what: what.to_owned(),
            value,
            expected,
        })
    }
}
