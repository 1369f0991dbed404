//! Physics with [`avian3d`] on deforming meshes: rigid bodies rest on morphing and skinned meshes, are pushed and carried by them, and
//! Avian's queries see the meshes.
//!
//! ```no_run
//! use avian3d::prelude::*;
//! use bevy::prelude::*;
//! use bevy_morph_avian::prelude::*;
//! use bevy_morph_collision::prelude::*;
//!
//! # let mut app = App::new();
//! app.add_plugins((PhysicsPlugins::default(), MorphPlugins, MorphAvianPlugin));
//! # fn spawn(mut commands: Commands, jelly: Handle<Mesh>) {
//! commands.spawn((Mesh3d(jelly), MorphPhysicsCollider::default()));
//! commands.spawn((RigidBody::Dynamic, Collider::sphere(0.5), Transform::from_xyz(0.0, 5.0, 0.0)));
//! # }
//! ```
//!
//! - [`MorphPhysicsCollider`] makes a mesh collide, [`MorphPhysicsScene`] the deforming meshes of a scene. Avian's other collider components
//!   apply as usual: `Friction`, `Restitution`, `CollisionMargin`, `Sensor`, `CollisionLayers`, `CollisionEventsEnabled`,
//!   `CollidingEntities`, `ActiveCollisionHooks`, `ColliderDisabled`.
//! - [`MorphAvianCarry`] lets surfaces carry a character that your game moves itself, for example with `MoveAndSlide`.
//! - [`MorphAvianVelocity`] reads the velocity of a surface, for other character controllers.
//! - [`MorphAvianLayers`] converts collision layers.
//! - [`MorphAvianPart`] marks the bodies with which surfaces push, which you can see in Avian's `ContactGraph`.
//!
//! The crate [`bevy_morph_physics`] decides what a surface is, where it moves and which of its triangles are near bodies.
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! plugin, layers > step, characters, collisions > surface > push > isometry, whole_surface
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]
// Systems declare their needs as parameters.
#![allow(clippy::type_complexity, clippy::too_many_arguments)]

mod characters;
mod collisions;
mod isometry;
mod layers;
mod plugin;
mod push;
mod step;
mod surface;
mod whole_surface;

pub use bevy_morph_physics::{MorphCharacterGround, MorphPhysicsCollider, MorphPhysicsDiagnostics, MorphPhysicsScene};
pub use characters::MorphAvianCarry;
#[cfg(feature = "tnua")]
pub use characters::MorphTnuaPlugin;
pub use collisions::{MorphAvianCollisions, MorphAvianContacts};
pub use layers::MorphAvianLayers;
pub use plugin::{MorphAvianPlugin, MorphAvianSystems, ScheduledMorphAvianPlugin};
pub use push::MorphAvianPart;
pub use surface::MorphAvianVelocity;

/// What a game with Avian names.
pub mod prelude {
    #[cfg(feature = "tnua")]
    pub use crate::MorphTnuaPlugin;
    pub use crate::{
        MorphAvianCarry, MorphAvianCollisions, MorphAvianLayers, MorphAvianPart, MorphAvianPlugin, MorphAvianVelocity,
    };
    pub use bevy_morph_physics::prelude::*;
}

/// Compiles the README's snippet.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
