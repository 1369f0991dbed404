//! Surfaces that move, whatever the physics engine: what `rapier` and `avian` have in common.
//!
//! - `surface`, `triangles`: a mesh, and some of its triangles, as shapes of Parry's, which both engines compute with.
//! - `range`: the sizes at which Parry can.
//! - `layout`: what is known of a mesh whatever its pose.
//! - `drawn`, `timeline`, `clock`: what it is drawn with, and which moment of that a step sees.
//! - `follow`, `placed`: where a surface is and was.
//! - `inside`, `expel`: what is inside a closed one, and how it gets out.
//! - `point`: points of it, and how fast they are.
//! - `sorted_boxes`: which moving bodies are where a surface is.
//! - `near`, `part`, `motion`: what of it is near them, as kinematic bodies for one step.
//! - `scene`: all parts of a scene at once.

pub(crate) mod clock;
pub(crate) mod drawn;
pub(crate) mod expel;
pub(crate) mod follow;
pub(crate) mod inside;
pub(crate) mod layout;
pub(crate) mod motion;
pub(crate) mod near;
pub(crate) mod part;
pub(crate) mod placed;
pub(crate) mod point;
pub(crate) mod range;
pub(crate) mod scene;
pub(crate) mod sorted_boxes;
// Its name is public with Rapier, which a game can ask for the shape of a collider.
#[cfg_attr(not(feature = "rapier"), allow(unreachable_pub))]
pub(crate) mod surface;
pub(crate) mod timeline;
pub(crate) mod triangles;
