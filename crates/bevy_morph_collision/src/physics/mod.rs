//! Moving surfaces for any physics engine: the code that `rapier` and `avian` share.
//!
//! - `surface`, `triangles`: a mesh, and some of its triangles, as Parry shapes, which both engines use.
//! - `range`: the sizes with which Parry can compute.
//! - `layout`: properties of a mesh that do not depend on its pose.
//! - `mass`: the mass of what a surface encloses, computed over several steps.
//! - `drawn`, `timeline`, `clock`: what a surface is drawn with, which moment of that a step uses, and what is motion
//!   (`docs/rapier.md`, "Frames and steps").
//! - `sources`, `frames`: reads that from components, during steps and at the end of a frame.
//! - `follow`, `moment`, `ahead`, `placed`: where a surface is, was and will be.
//! - `teleport`: surfaces that the game puts somewhere else.
//! - `begin`: what a surface does at the beginning of a step.
//! - `inside`, `expel`: what is inside a closed surface, and how it gets out.
//! - `point`: points of a surface and their velocities.
//! - `sorted_boxes`: finds the moving bodies near a surface.
//! - `near`, `part`, `motion`: triangles near those bodies, as kinematic bodies for one step.
//! - `engine`, `schedule`: whether an engine is there, and where it steps.
//! - `passage`: keeps fast bodies from passing through.
//! - `scene`: all parts of a scene at once.

pub(crate) mod ahead;
pub(crate) mod begin;
pub(crate) mod clock;
pub(crate) mod drawn;
pub(crate) mod engine;
pub(crate) mod expel;
pub(crate) mod follow;
pub(crate) mod frames;
pub(crate) mod inside;
pub(crate) mod layout;
mod mass;
pub(crate) mod moment;
pub(crate) mod motion;
pub(crate) mod near;
pub(crate) mod part;
pub(crate) mod passage;
pub(crate) mod placed;
pub(crate) mod point;
pub(crate) mod range;
pub(crate) mod scene;
pub(crate) mod schedule;
pub(crate) mod sorted_boxes;
pub(crate) mod sources;
// Public with Rapier, because a game can ask for the shape of a collider.
#[cfg_attr(not(feature = "rapier"), allow(unreachable_pub))]
pub(crate) mod surface;
pub(crate) mod teleport;
pub(crate) mod timeline;
pub(crate) mod triangles;
