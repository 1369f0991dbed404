//! What connects surfaces to a physics engine.
//!
//! An engine's crate implements [`Engine`], and its plugin calls [`build`] and [`finish`]. In [`Engine::build`] it adds the systems that
//! every engine has ([`add_systems`]) and its own around the engine's step:
//!
//! - Before the step, for each [`PhysicsSurface`]: find the engine's collider and body, predict where they will be, call
//!   [`PhysicsSurface::advance`] and [`PhysicsSurface::set_sides`], give the engine the shape, and call
//!   [`NearbyParts`](crate::push::NearbyParts) for colliders that may move. Parts are bodies that only exist for the step.
//! - After the step: [`Passage::move_back`](crate::push::Passage::move_back).
//! - If no step comes: [`Sources::rest`].
//! - In each frame, if physics runs in a fixed schedule: [`Sources::record`].

mod attach;
mod frames;
mod interface;
mod plugin;
mod schedule;
mod sources;
mod surface;
mod teleport;
mod velocity;

pub use attach::{attach_surfaces, detach_surface};
pub use frames::record_transforms;
pub use interface::{Engine, EngineNames};
pub use plugin::{add_systems, build, finish};
pub use schedule::{runs_fixed, schedules_with};
pub use sources::Sources;
pub use surface::{Exclusion, PhysicsSurface, Sides};
pub use velocity::MorphSurfaceVelocity;
