//! The paper's method, implemented plainly from its text: T. Larsson and T. Akenine-Moller, *Efficient collision detection
//! for models deformed by morphing*, The Visual Computer 19 (2003).
//!
//! | in the paper | here |
//! |---|---|
//! | Sect. 3: the 8-ary tree, split at the mid-values of the extents | `split` |
//! | Sect. 3: the dual traversal, descend the larger volume, stop at the first pair; SAT-lite | `walk`, `slab_maps` |
//! | Sect. 3.1, Eq. 1 and 2: reference models, weights, blended vertices | `references`, `weights` |
//! | Sect. 3.1, Fig. 1: one volume per node and reference model | `tree` |
//! | Sect. 3.2, Eq. 3 to 6: blended k-DOPs, the box among them | `slabs`, `directions` |
//! | Sect. 3.3, Eq. 7 to 10: blended spheres | `sphere` |
//! | Sect. 5: time stamps | `body` |
//! | Sect. 5: volumes between references | `tree`, `weights` |
//!
//! The paper blends convexly: no weight is negative, and they sum to 1. Here a mesh is a base with displacements, and weights
//! may be any numbers. Choices that the paper leaves open:
//!
//! - *Weights* that are not convex are split in two. One part is convex and blended by the paper's equations. The rest is
//!   blended by interval arithmetic over the displacements (`weights`). If the paper's assumptions hold there is no rest.
//! - *Rounding*: volumes are computed and compared in `f64`, and widened by an error bound for posed vertices (`weights`).
//! - *Targets* that move no vertex of a node have the base's volume there; it is stored once (`tree`).
//! - *k-DOPs of different bodies* are compared like boxes: along the directions of either (`slab_maps`).
//! - *Spheres* have the middle of their vertices' box as centre (`sphere`).

mod body;
mod directions;
mod options;
mod references;
mod slab_maps;
mod slabs;
mod sphere;
mod split;
mod tree;
mod volume;
mod walk;
mod weights;

#[cfg(test)]
mod tests;

use std::sync::Arc;

pub use options::{PaperOptions, PaperVolume, UnknownVolume};
use slabs::Slabs;
use sphere::Sphere;
use walk::Paper;

use super::Method;
use super::blended::WeldedMesh;

/// Sets up the method over welded meshes, with one body for each entry of `bodies`, which is the index of its mesh.
pub(super) fn set_up(meshes: &[Arc<WeldedMesh>], bodies: &[usize], options: PaperOptions) -> Box<dyn Method> {
    let in_betweens = options.in_betweens;
    match options.volume {
        PaperVolume::Aabb => Box::new(Paper::<Slabs<3>>::new(meshes, bodies, in_betweens)),
        PaperVolume::Kdop14 => Box::new(Paper::<Slabs<7>>::new(meshes, bodies, in_betweens)),
        PaperVolume::Kdop18 => Box::new(Paper::<Slabs<9>>::new(meshes, bodies, in_betweens)),
        PaperVolume::Kdop26 => Box::new(Paper::<Slabs<13>>::new(meshes, bodies, in_betweens)),
        PaperVolume::Sphere => Box::new(Paper::<Sphere>::new(meshes, bodies, in_betweens)),
    }
}
