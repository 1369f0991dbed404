//! The drawn examples as shows, for the web site and for tests: the examples themselves, as modules.

#![allow(dead_code, reason = "an example also has a main function")]

#[path = "../character.rs"]
mod character;
#[path = "../crowd.rs"]
mod crowd;
#[path = "../culling.rs"]
mod culling;
#[path = "../dolphins.rs"]
mod dolphins;
#[path = "../face.rs"]
mod face;
#[path = "../own.rs"]
mod own;
#[path = "../pass_through.rs"]
mod pass_through;
#[path = "../physics.rs"]
mod physics;
#[path = "../picking.rs"]
mod picking;
#[path = "../slap.rs"]
mod slap;

pub use self::character::show as character;
pub use self::crowd::show as crowd;
pub use self::culling::show as culling;
pub use self::dolphins::show as dolphins;
pub use self::face::show as face;
pub use self::own::show as own;
pub use self::pass_through::show as pass_through;
pub use self::physics::show as physics;
pub use self::picking::{Arrow, show as picking};
pub use self::slap::show as slap;
pub use crate::own::{Inbox, Judged, Verdict};
