//! A mesh, and some of its triangles, as Parry shapes, which most engines use.

mod inside;
mod layout;
mod mass;
mod pair;
mod patch;
mod posed;
mod range;
mod surface;
mod triangles;

pub use inside::{Probe, not_closed, one_encloses_other};
pub use layout::{MeshLayout, MeshLayouts, NONE, add_to_trees};
pub use mass::MassBudget;
pub use pair::{Range, check};
pub use patch::{LookAhead, Patch};
pub use posed::Posed;
pub use range::{MAX_COORDINATE, box_in_range, in_range};
pub use surface::MorphSurface;
pub use triangles::{Triangles, nowhere, pseudo_normals};
