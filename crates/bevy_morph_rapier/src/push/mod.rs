//! How a surface pushes: with parts near moving bodies, as kinematic Rapier bodies, or as links of a dynamic body.

mod expel;
mod filtered_bodies;
mod forces;
mod link;
mod listeners;
mod material;
mod movers;
mod obstacles;
mod part;
mod prepare;
mod pushing;
mod step;
mod world;

pub(crate) use forces::SteppedWorld;
pub(crate) use link::{Carrier, Link, Links};
pub(crate) use listeners::ContactListeners;
pub(crate) use material::{ContactMaterial, no_push};
pub(crate) use movers::Movers;
pub(crate) use obstacles::Obstacles;
pub(crate) use pushing::Pushing;
pub(crate) use step::Step;
pub(crate) use world::{Contexts, World, world};
