//! Contacts of bodies with each other and with primitive shapes, compared with slow, independent implementations ("twins").
#![allow(clippy::disallowed_methods)]

mod bodies;
mod hulls;
mod manifold;
mod shape_bodies;
mod shape_triangles;
mod signed_distance;
mod triangles;
