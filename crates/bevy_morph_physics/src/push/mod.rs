//! How a surface pushes: parts near bodies that may move, bodies inside it, and fast bodies.

mod collider_parts;
mod crossing;
mod exit;
mod expel;
mod flight;
mod moved;
mod nearby_parts;
mod part;
mod passage;

pub use exit::{Drive, Exit};
pub use expel::{EnclosedCollider, Expelling, SolidSurface};
pub use flight::{FAST, Flight, Ground};
pub use nearby_parts::{NearbyCollider, NearbyParts};
pub use part::{Bodies, PartMotion, StepParams};
pub use passage::{Budget, Passage, middle};
