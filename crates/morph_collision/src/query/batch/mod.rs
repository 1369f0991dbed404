//! Queries for many pairs of bodies at once, on several threads.
//!
//! A [`BatchQuery`] answers a list of [`PairTask`]s. [`Workers`] provide the threads: [`ThreadWorkers`], rayon's (feature `rayon`), or your
//! engine's.
//!
//! # How it works
//!
//! ```text
//! tasks --plan--> units (a pair, or a part of a large pair) --schedule, on workers--> found --gather--> answers by task
//! ```
//!
//! - Whole pairs that share a body never run at the same time.
//! - Parts of a cut pair work on copies of the poses. A worker keeps its copies, and the boxes and patches that its query has cached for
//!   them, from part to part.
//!
//! - If waking up other workers takes longer than they are expected to save, the calling thread does everything (`forecast`).
//!
//! So a worker that has a unit waits at most for a lock around copying weights, and no answer depends on the number of threads.

mod forecast;
mod lock;
mod plan;
mod query;
mod schedule;
mod work;
mod workers;

pub use plan::{PairTask, Wanted};
pub use query::{BatchAnswers, BatchQuery};
#[cfg(feature = "rayon")]
pub use workers::RayonWorkers;
pub use workers::{ThreadWorkers, Workers};
