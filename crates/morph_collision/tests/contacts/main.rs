//! Contacts of bodies with each other and with primitive shapes, compared with slow, independent implementations ("twins").

mod bodies;
mod hulls;
mod manifold;
mod shape_bodies;
mod shape_triangles;
mod signed_distance;
mod triangles;
