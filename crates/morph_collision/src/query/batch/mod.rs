//! Many pairs of bodies at once, on as many threads as the caller has.
//!
//! ```text
//! tasks --plan--> units (a pair, or a part of a large pair) --schedule, on workers--> found --gather--> answers by task
//! ```
//!
//! Whole pairs with a common body never run at once, and parts of a cut pair work on copies: a worker keeps its copies, and what its query
//! has seen of them, from part to part. So at most a lock around copying weights is waited for, and no answer depends on the number of
//! threads.

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
