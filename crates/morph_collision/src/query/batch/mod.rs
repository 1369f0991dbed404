//! Many pairs of bodies at once, on as many threads as the caller has.
//!
//! ```text
//! tasks --plan--> units (a pair, or a part of a large pair) --schedule, on workers--> found --gather--> answers by task
//! ```
//!
//! Units with a common body never run at once, and parts of a cut pair work on copies. So no lock is contended while a unit runs, and no
//! answer depends on the number of threads.

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
