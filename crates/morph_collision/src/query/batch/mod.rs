//! Many queries at once, on several threads.
//!
//! - A [`BatchQuery`] answers a list of [`PairTask`]s: pairs of bodies.
//! - [`RayQuery`](crate::RayQuery) and [`ShapeQuery`](crate::ShapeQuery) answer many questions about one body; see
//!   [`RayQuery::closest_batch`](crate::RayQuery::closest_batch). A [`QuestionBatch`] sorts them and brings them to the threads.
//! - [`Workers`] provide the threads: [`ThreadWorkers`], rayon's (feature `rayon`), or your engine's.
//!
//! # How pairs of bodies are spread
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
//!
//! # How questions about one body are spread
//!
//! ```text
//! questions --sort by place--> order --a sample, on the caller's thread--> parts, on workers --> answers by question
//! ```
//!
//! - A worker gets a contiguous part of the order, so it visits its own region of the body. All but one work on copies of the pose.
//! - The sample shows how much work the rest is. If it is too little to wake a thread, everything happens on the caller's.

mod forecast;
mod lock;
mod one_body;
mod plan;
mod query;
mod questions;
mod schedule;
mod wanted;
mod work;
mod workers;

pub(in crate::query) use one_body::{Latest, OneBodyBatch, OneBodyQuery};
pub use plan::PairTask;
pub use query::{BatchAnswers, BatchQuery};
pub use questions::{QuestionBatch, QuestionChunks};
pub use wanted::Wanted;
#[cfg(feature = "rayon")]
pub use workers::RayonWorkers;
pub use workers::{ThreadWorkers, Workers};
