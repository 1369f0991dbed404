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
//! - [`MorphPhysicsCollider`] makes a mesh collide, [`MorphPhysicsScene`] the deforming meshes of a scene. Avian's other collider
//!   components apply as usual: `Friction`, `Restitution`, `CollisionMargin`, `Sensor`, `CollisionLayers`, `CollisionEventsEnabled`,
//!   `CollidingEntities`, `ActiveCollisionHooks`, `ColliderDisabled`.
//! - [`MorphAvianCarry`] lets surfaces carry a character that your game moves itself, for example with `MoveAndSlide`.
//! - [`MorphAvianCollisions`] lists contacts with surfaces, as Avian's `Collisions` does with other colliders.
//! - [`MorphAvianVelocity`] reads the velocity of a surface, for other character controllers.
//! - [`MorphAvianLayers`] converts collision layers.
//! - [`MorphAvianPart`] marks the bodies with which surfaces push, which you can see in Avian's `ContactGraph`.
//!
//! # Contacts
//!
//! Avian's `Collisions` lists contacts with parts. [`MorphAvianCollisions`] has the same methods and lists surfaces instead:
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_morph_avian::prelude::*;
//! # #[derive(Component)]
//! # struct Player;
//! fn under_the_feet(player: Single<Entity, With<Player>>, collisions: MorphAvianCollisions) {
//!     for contacts in collisions.collisions_with(*player) {
//!         let impulse = contacts.total_normal_impulse_magnitude();
//!         println!("{} carries {impulse}", contacts.other(*player));
//!     }
//! }
//! # bevy::ecs::system::assert_is_system(under_the_feet);
//! ```
//!
//! # Characters of Tnua
//!
//! With the feature `tnua`, surfaces also carry the floating characters of `bevy-tnua`. Add a `MorphTnuaPlugin` in the schedule of Tnua's
//! plugins:
//!
#![cfg_attr(feature = "tnua", doc = "```")]
#![cfg_attr(not(feature = "tnua"), doc = "```ignore")]
//! # use avian3d::prelude::*;
//! # use bevy::prelude::*;
//! # use bevy_morph_avian::prelude::*;
//! # use bevy_tnua::prelude::*;
//! # #[derive(TnuaScheme)]
//! # #[scheme(basis = TnuaBuiltinWalk)]
//! # enum Controls {}
//! # let mut app = App::new();
//! # app.add_plugins(AssetPlugin::default());
//! app.add_plugins(TnuaControllerPlugin::<Controls>::new(PhysicsSchedule))
//!     // .add_plugins(TnuaAvian3dPlugin::new(PhysicsSchedule))
//!     .add_plugins(MorphTnuaPlugin::new(PhysicsSchedule));
//! ```
//!
//! # How it works
//!
//! The crate [`bevy_morph_physics`] decides what a surface is, where it moves and which of its triangles are near bodies.
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! tnua > plugin, layers > step, characters, collisions > surface > push > isometry, whole_surface
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
#[cfg(feature = "tnua")]
mod tnua;
mod whole_surface;

pub use bevy_morph_physics::{MorphCharacterGround, MorphPhysicsCollider, MorphPhysicsDiagnostics, MorphPhysicsScene};
pub use characters::MorphAvianCarry;
pub use collisions::{MorphAvianCollisions, MorphAvianContacts};
pub use layers::MorphAvianLayers;
pub use plugin::{MorphAvianPlugin, MorphAvianSystems, ScheduledMorphAvianPlugin};
pub use push::MorphAvianPart;
pub use surface::MorphAvianVelocity;
#[cfg(feature = "tnua")]
pub use tnua::MorphTnuaPlugin;

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
