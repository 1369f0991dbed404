//! Characters on surfaces.

mod carry;
mod shape;

pub use carry::MorphAvianCarry;
pub(crate) use carry::{Footing, carry, find_ground};
