//! How a surface pushes: with parts near colliders that may move.

mod material;
mod movers;
mod part;
mod pushing;

pub(crate) use material::ContactMaterial;
pub(crate) use movers::{Mover, Movers};
pub use part::MorphAvianPart;
pub(crate) use part::{PartBodies, Parts};
pub(crate) use pushing::{Pushing, Sleep, Surroundings};
