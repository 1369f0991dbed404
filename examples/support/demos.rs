//! The drawn examples as demos, for the web site and for tests: the examples themselves, as modules.

#![allow(dead_code, reason = "an example also has a main function")]

#[path = "../character.rs"]
mod character;
#[path = "../crowd.rs"]
mod crowd;
#[path = "../culling.rs"]
mod culling;
#[path = "../dolphins.rs"]
mod dolphins;
#[path = "../dust.rs"]
mod dust;
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

pub use self::character::demo as character;
pub use self::crowd::demo as crowd;
pub use self::culling::demo as culling;
pub use self::dolphins::demo as dolphins;
pub use self::dust::demo as dust;
pub use self::face::demo as face;
pub use self::own::demo as own;
pub use self::pass_through::demo as pass_through;
pub use self::physics::demo as physics;
pub use self::picking::{Arrow, demo as picking};
pub use self::slap::demo as slap;
pub use crate::own::{Inbox, Judged, Verdict};
