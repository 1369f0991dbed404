//! The oracle: brute force in exact arithmetic, straight from the definitions. The core library is tested against it.
//!
//! ```text
//! base + targets + weights --vertex--> posed f32 --vertex--> world f64 --triangles, pairs--> intersecting pairs
//! ```
//!
//! Nothing here uses the crate `morph_collision`. The definitions of a posed vertex, of two triangles that share a point and of a
//! set of pairs are implemented a second time, with no tree, no volume and no predicate in common, so that agreement is
//! meaningful.
//!
//! It is exact because it uses integers: every `f64` is a whole multiple of some power of two. For whole meshes that would take
//! too long, so [`intersecting_pairs`] uses integers only if error-bounded `f64` arithmetic is not certain.
//!
//! [`Dyadic`] is such an exact number, for measuring rounding errors. [`ray_parameter`] is exact but for one rounding. Distances ([`triangle_distance`]) are in `f64` and have an
//! error.

mod certain;
mod distance;
mod dyadic;
mod pairs;
mod ray;
mod scene;
mod triangles;
mod vertex;

pub use distance::{point_distance, triangle_distance};
pub use dyadic::Dyadic;
pub(crate) use dyadic::mantissa_and_exponent;
pub use pairs::intersecting_pairs;
pub(crate) use pairs::visit_intersecting_pairs;
pub use ray::ray_parameter;
pub use scene::{BodyPairs, BodyPose, scene_pairs};
pub use triangles::{plane_side, triangles_intersect};
pub use vertex::{posed_vertices, skinned_vertices, world_vertices};
