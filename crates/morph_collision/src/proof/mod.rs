//! Proofs about all weights at once: which triangles of a mesh can never touch each other.
//!
//! Queries answer for one pose. A [`SelfProof`] answers for a [`WeightBox`], an interval for each target's weight. Every pair of triangles that
//! share no vertex ends as one of these:
//!
//! - *free*: they do not touch for any weights in the box;
//! - *touching*: there is a [`Witness`], weights for which [`SelfQuery`](crate::SelfQuery) finds the pair;
//! - *undecided*: the [`Effort`] was not enough. Such a pair may be free or not.
//!
//! [`SelfProof::certificates`] makes a proof useful at run time: queries leave out what is proved free ([`SelfCertificates`]).
//!
//! # How
//!
//! Along a direction `n`, the gap between two sets of vertices is linear in the weights, apart from the choice of the vertices:
//!
//! ```text
//! gap(w) >= base gap + sum_k w_k g_k,    g_k >= min over B of n . d_k  -  max over A of n . d_k    if w_k >= 0
//! ```
//!
//! The minimum over a box of weights is found target by target. If it is above the rounding of posed vertices, nothing of `A` touches anything
//! of `B`. It is computed for two nodes of the tree from boxes around their displacements (`nodes.rs`), and exactly for two triangles
//! (`pair.rs`). If no direction proves two triangles free, the box is split along the weight that loosens the bound most (`branch.rs`).
//! `docs/numerics.md` derives the rounding.

mod branch;
mod hull;
mod nodes;
mod outcome;
mod pair;
mod rounding;
mod run;
mod self_proof;
mod walk;

pub use outcome::{Effort, ProofOutcome, Witness};
pub use self_proof::SelfProof;

pub use crate::model::WeightBox;
pub use crate::tree::SelfCertificates;
