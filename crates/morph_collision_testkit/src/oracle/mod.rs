//! The truth to judge the core against: brute force in exact arithmetic, straight from the definitions.
//!
//! ```text
//! base + targets + weights --vertex--> posed f32 --vertex--> world f64 --triangles, pairs--> intersecting pairs
//! ```
//!
//! Nothing here uses the crate `morph_collision`: the definition of a posed vertex, of two triangles that share a point and
//! of a set of pairs is written out a second time, with no tree, no volume and no predicate in common, so that an
//! agreement of both means something. Exactness comes from integers: every `f64` is a whole number of some power of two. Whole
//! meshes would take too long so; [`intersecting_pairs`] leaves out integers where `f64` arithmetic with a bound on its error is sure.
//!
//! [`Dyadic`] is that number, to measure roundings with. Distances ([`triangle_distance`]) are in `f64`, and have an error.

mod certain;
mod distance;
mod dyadic;
mod pairs;
mod scene;
mod triangles;
mod vertex;

pub use distance::{point_distance, triangle_distance};
pub use dyadic::Dyadic;
pub use pairs::intersecting_pairs;
pub(crate) use pairs::visit_intersecting_pairs;
pub use scene::{BodyPairs, BodyPose, scene_pairs};
pub use triangles::triangles_intersect;
pub use vertex::{posed_vertices, skinned_vertices, world_vertices};
