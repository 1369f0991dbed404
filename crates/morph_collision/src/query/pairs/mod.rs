//! Which triangles intersect: of two bodies ([`PairQuery`]), or of one ([`SelfQuery`]).
//!
//! Leaves are patches of eight triangles (`patch`), placed once per query (`patch_cache`) and compared eight pairs at a time. Exact
//! arithmetic decides the pairs that the filter of `patch` leaves open.

mod memory;
mod patch;
mod patch_cache;
mod query;
mod regions;
mod self_query;

pub use memory::PairMemory;
pub use query::PairQuery;
pub(super) use query::Start;
pub use regions::touching_regions;
pub use self_query::SelfQuery;

#[cfg(test)]
mod tests;
