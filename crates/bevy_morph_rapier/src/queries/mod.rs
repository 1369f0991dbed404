//! Answers Rapier's queries about two shapes, one of which is a surface or part of one.

mod dispatcher;
mod gathered;
mod ground;
mod landing;
mod side;
mod sweep;

pub use dispatcher::MorphQueryDispatcher;
pub(crate) use gathered::is_ground;
pub(crate) use ground::Ground;
pub(crate) use sweep::MARGIN;
