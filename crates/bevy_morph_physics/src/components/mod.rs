//! What a game writes and reads, with any engine.

mod character;
mod collider;
mod diagnostics;
mod engine_check;
mod scene;

pub use character::MorphCharacterGround;
pub(crate) use collider::ACCELERATIONS;
pub use collider::MorphPhysicsCollider;
pub use diagnostics::MorphPhysicsDiagnostics;
pub(crate) use engine_check::EngineCheck;
pub use scene::{MorphPhysicsScene, add_to_parts};
