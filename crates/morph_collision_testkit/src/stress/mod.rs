//! Generated, difficult input of the kinds that break collision code, and the results of the trees
//! on it.
//!
//! ```text
//! Family --case--> meshes, Situation --judge--> Counts, errors, panics, slowdown -> FamilyReport
//!        --door--> bad input         --refused, by name?--> the last good state still answers right
//! ```

mod case;
mod door;
mod family;
mod geometry;
mod panics;
mod parts;
mod run;
mod skin_door;
mod skinned;
mod work_rate;

#[cfg(test)]
mod tests;

pub use case::Case;
pub use door::{DOORS, knock};
pub use family::Family;
pub use panics::Silence;
pub use run::{FamilyReport, stress};
