//! Character controllers on surfaces.

mod carried;
mod carry;
mod character;
mod footing;

pub use carry::MorphCharacterCarry;
pub(crate) use carry::carry;
pub(crate) use footing::{Footing, after_controllers, before_controllers};
