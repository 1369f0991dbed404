use thiserror::Error;

/// Why a shape cannot be placed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A number is NaN, infinite, or larger than 1e37.
    #[error("{what} holds {value}, not a number between -1e37 and 1e37")]
    BadNumber {
        /// What it belongs to.
        what: &'static str,
        /// The offending number.
        value: f32,
    },
    /// A size is negative.
    #[error("{what} is {value}, a size cannot be negative")]
    Negative {
        /// What it belongs to.
        what: &'static str,
        /// The offending size.
        value: f32,
    },
    /// A direction is zero.
    #[error("{what} is zero and so no direction")]
    NoDirection {
        /// What it belongs to.
        what: &'static str,
    },
    /// A rotation is not of length 1.
    #[error("the rotation's length is {length}, not 1")]
    NotUnit {
        /// Its length as a quaternion.
        length: f32,
    },
}
