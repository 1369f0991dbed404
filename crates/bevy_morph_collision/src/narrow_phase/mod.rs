//! Finds intersecting triangles and contacts.
//!
//! - `find`: queries all pairs of meshes at once. `participant`: the colliders. `comparison`: two of them, and what is known about them.
//! - `memories`: starts pairs where they touched in the last run.
//! - `contact_queries`: turns the results into contacts. `builders`: also on several threads.
//! - `motion`: compares continuous pairs that did not touch on their way, from where they were (`starts`).

mod builders;
mod comparison;
mod contact_queries;
mod find;
mod memories;
mod motion;
mod participant;
mod starts;

pub(crate) use find::find_contacts;
