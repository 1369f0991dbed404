//! The scenes of the drawn examples, one file each.

mod character;
mod crowd;
mod culling;
mod dolphins;
mod face;
mod group;
mod own;
mod pass_through;
mod physics;
mod picking;
mod slap;

pub use character::character;
pub use crowd::crowd;
pub use culling::culling;
pub use dolphins::dolphins;
pub use face::face;
pub use own::{Inbox, Judged, Verdict, own};
pub use pass_through::pass_through;
pub use physics::physics;
pub use picking::{Arrow, picking};
pub use slap::slap;
