//! Characters on surfaces.

mod carry;
mod shape;
#[cfg(feature = "tnua")]
mod tnua;

pub use carry::MorphAvianCarry;
pub(crate) use carry::{Footing, carry, find_ground};
#[cfg(feature = "tnua")]
pub use tnua::MorphTnuaPlugin;
