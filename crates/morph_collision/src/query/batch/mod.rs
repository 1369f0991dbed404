//! Many pairs of bodies at once, on as many threads as the caller has.
//!
//! ```text
//! tasks --plan--> units (a pair; or a part of one large pair) --schedule, on workers--> found --gather--> answers by task
//! ```
//!
//! Two units that need the same body's cache never run at the same time, and parts of one pair have caches of their own; so
//! nothing waits for a lock while it works, and no answer depends on how many threads there are.

mod plan;
mod query;
mod schedule;
mod work;
mod workers;

pub use plan::{PairTask, Wanted};
pub use query::{BatchAnswers, BatchQuery};
#[cfg(feature = "rayon")]
pub use workers::RayonWorkers;
pub use workers::{OneThread, ThreadWorkers, Workers};
