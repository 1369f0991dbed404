//! What a game writes and reads, with any engine.

mod character;
mod collider;
mod diagnostics;
mod scene;

pub use character::MorphCharacterGround;
pub(crate) use collider::EngineCheck;
pub use collider::MorphPhysicsCollider;
pub use diagnostics::MorphPhysicsDiagnostics;
pub use scene::{MorphPhysicsScene, add_to_parts};
