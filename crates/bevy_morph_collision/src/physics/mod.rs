//! Moving surfaces for any physics engine: the code that `rapier` and `avian` share.
//!
//! - `surface`, `triangles`: a mesh, and some of its triangles, as Parry shapes, which both engines use.
//! - `range`: the sizes with which Parry can compute.
//! - `layout`: properties of a mesh that do not depend on its pose.
//! - `mass`: the mass of what a surface encloses, computed over several steps.
//! - `drawn`, `timeline`, `clock`: what a surface is drawn with, and which moment of that a step uses.
//! - `follow`, `moment`, `ahead`, `placed`: where a surface is, was and will be.
//! - `begin`: what a surface does at the beginning of a step.
//! - `inside`, `expel`: what is inside a closed surface, and how it gets out.
//! - `point`: points of a surface and their velocities.
//! - `sorted_boxes`: finds the moving bodies near a surface.
//! - `near`, `part`, `motion`: triangles near those bodies, as kinematic bodies for one step.
//! - `scene`: all parts of a scene at once.

pub(crate) mod ahead;
pub(crate) mod begin;
pub(crate) mod clock;
pub(crate) mod drawn;
pub(crate) mod expel;
pub(crate) mod follow;
pub(crate) mod inside;
pub(crate) mod layout;
mod mass;
pub(crate) mod moment;
pub(crate) mod motion;
pub(crate) mod near;
pub(crate) mod part;
pub(crate) mod placed;
pub(crate) mod point;
pub(crate) mod range;
pub(crate) mod scene;
pub(crate) mod sorted_boxes;
// Public with Rapier, because a game can ask for the shape of a collider.
#[cfg_attr(not(feature = "rapier"), allow(unreachable_pub))]
pub(crate) mod surface;
pub(crate) mod timeline;
pub(crate) mod triangles;
