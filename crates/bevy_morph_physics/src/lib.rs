//! Surfaces of morphing and skinned meshes that move in time, for any physics engine.
//!
//! A game uses this crate through the one for its engine, `bevy_morph_rapier` or `bevy_morph_avian`. [`MorphPhysicsCollider`] makes
//! a mesh take part in physics, and [`MorphPhysicsScene`] all deforming meshes of a scene, whichever engine it is. In an app with
//! several engines, they take effect in each of them.
//!
//! An engine's crate implements [`Engine`](engine::Engine), which says what it has to do.
//!
//! # What happens in a step
//!
//! 1. Frames are recorded in a [`DrawnHistory`](time::DrawnHistory): the weights, joints and transforms with which a surface is drawn. A step's
//!    [`StepTime`](time::StepTime) says which of them it uses, and how much of a change is motion.
//! 2. The engine's crate predicts where a surface will be at the end of the step ([`Prediction`](moving::Prediction)), and
//!    [`MovingSurface::advance`](moving::MovingSurface::advance) moves it there. It remembers the moments before, so that each of its points has a velocity.
//!    While nothing is near, it only finds a box: shapes are [posed](posing::LazyPose) when somebody looks at them.
//! 3. [`NearbyParts`](push::NearbyParts) finds the triangles near bodies that may move. For one step, they become kinematic bodies that move
//!    like the surface. With a few triangles, an engine has contacts that are as good as those of any body.
//! 4. [`Expelling`](push::Expelling) finds bodies inside of solid surfaces, which have to leave.
//! 5. After the step, [`Passage`](push::Passage) moves bodies back that were so fast that they passed through.
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! engine > push > moving > time, shape > posing > math > components
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]
// Systems declare their needs as parameters.
#![allow(clippy::type_complexity, clippy::too_many_arguments)]
// States of surfaces are not values to print.
#![allow(missing_debug_implementations)]

pub mod components;
pub mod engine;
pub mod math;
pub mod moving;
pub mod posing;
pub mod push;
pub mod shape;
pub mod time;

pub use components::{MorphCharacterGround, MorphPhysicsCollider, MorphPhysicsDiagnostics, MorphPhysicsScene};
pub use engine::MorphSurfaceVelocity;
pub use shape::MorphSurface;

/// What a game names with any engine. The crates of engines include it in theirs.
pub mod prelude {
    pub use crate::{MorphCharacterGround, MorphPhysicsCollider, MorphPhysicsDiagnostics, MorphPhysicsScene};
}

/// Compiles the README's snippet.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
