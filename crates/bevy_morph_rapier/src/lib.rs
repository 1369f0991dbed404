//! Physics with [`bevy_rapier3d`] on deforming meshes: rigid bodies rest on morphing and skinned meshes, are pushed and carried by them,
//! and Rapier's queries see the meshes. Rapier's character controllers walk on them.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_morph_collision::prelude::*;
//! use bevy_morph_rapier::prelude::*;
//! use bevy_rapier3d::prelude::*;
//!
//! # let mut app = App::new();
//! app.add_plugins((RapierPhysicsPlugin::<NoUserData>::default(), MorphPlugins, MorphRapierPlugin));
//! # fn spawn(mut commands: Commands, jelly: Handle<Mesh>) {
//! commands.spawn((Mesh3d(jelly), MorphPhysicsCollider::default()));
//! commands.spawn((RigidBody::Dynamic, Collider::ball(0.5), Transform::from_xyz(0.0, 5.0, 0.0)));
//! # }
//! ```
//!
//! - [`MorphPhysicsCollider`] makes a mesh collide, [`MorphPhysicsScene`] the deforming meshes of a scene. Rapier's other collider components
//!   apply as usual: `Friction`, `Restitution`, `Sensor`, `CollisionGroups`, `SolverGroups`, `ContactSkin`, `ActiveEvents`, `ActiveHooks`,
//!   `ColliderDisabled`. Scale and shear of the entity work without `ColliderScale`.
//! - [`MorphCharacterCarry`] says how surfaces carry a `KinematicCharacterController`.
//! - [`MorphRapierVelocity`] reads the velocity of a surface, for other character controllers.
//! - [`MorphRapierLayers`] converts collision groups.
//! - [`MorphQueryDispatcher`] answers Rapier's queries about surfaces. The plugin gives it to every new physics context.
//!
//! The crate [`bevy_morph_physics`] decides what a surface is, where it moves and which of its triangles are near bodies.
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! plugin, layers > step, characters > surface > push > queries, timestep
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]
// Systems declare their needs as parameters.
#![allow(clippy::type_complexity, clippy::too_many_arguments)]

mod characters;
mod layers;
mod plugin;
mod push;
mod queries;
mod step;
mod surface;
mod timestep;

pub use bevy_morph_physics::{
    MorphCharacterGround, MorphPhysicsCollider, MorphPhysicsDiagnostics, MorphPhysicsScene, MorphSurface,
};
pub use characters::MorphCharacterCarry;
pub use layers::MorphRapierLayers;
pub use plugin::{MorphRapierPlugin, MorphRapierSystems, ScheduledMorphRapierPlugin};
pub use queries::MorphQueryDispatcher;
pub use surface::MorphRapierVelocity;

/// What a game with Rapier names.
pub mod prelude {
    pub use crate::{MorphCharacterCarry, MorphRapierLayers, MorphRapierPlugin, MorphRapierVelocity};
    pub use bevy_morph_physics::prelude::*;
}

/// Compiles the README's snippet.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
