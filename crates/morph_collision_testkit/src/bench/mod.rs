//! Timing `morph_collision` and its [rivals](crate::rivals) against each other.
//!
//! ```text
//! Experiment (frames) + Contenders (methods) --measure (interleaved rounds)--> Rows (times, counts, pairs)
//! ```
//!
//! # How times are taken
//!
//! - **In turns.** In a round every contender runs all frames, one contender after the other (A B C, then C B A, ...), so that
//!   disturbances affect all alike. Round 0 fills caches and allocates memory, and is discarded. A ratio is the median over the
//!   rounds of the ratio within a round. A time is the median over the rounds.
//! - **Over whole frames.** In a frame, every body gets its weights and placement, the boxes of bodies are swept for overlaps,
//!   and each overlapping pair is queried for its triangles. Times exclude loading, building and what is
//!   [prepared](Questions::prepare).
//! - **On one thread**, [pinned](crate::machine::pin) to a core if the caller wants it. The [`Stopwatch`] measures processor time, so that
//!   waiting for a processor does not count. The reading of an idle stopwatch is subtracted.
//!
//! # How times are split
//!
//! [`Parts`] come from separate passes, because reading the clock in the middle of a frame disturbs it. There:
//!
//! - *blend* is the time of [`Method::blend`](crate::rivals::Method::blend) for all bodies: weights, placements, and vertices if
//!   they are updated at once;
//! - *refit* is the time of [`Method::refit`](crate::rivals::Method::refit) for all bodies;
//! - *query* is the rest: broad phase and pairs.
//!
//! Lazy methods update volumes or vertices when a query looks at them ([`Method::is_lazy`](crate::rivals::Method::is_lazy)). They
//! run the same frame twice. The second time nothing is left to update, so its time is *query*, and the extra time of the first
//! counts as *refit*. The second time also finds processor caches warm, which makes *refit* of lazy methods an upper estimate.
//!
//! Parts are then scaled so that they sum to the undisturbed total. For `morph`, `hybrid` and `bottom-up`, *blend* is setting weights,
//! and vertices are blended in *refit*.

mod characters;
mod clock;
mod contender;
mod experiment;
mod flip_books;
mod heads;
mod many;
mod measure;
mod of_model;
mod played;
mod questions;
mod rays;
mod runner;
mod talk;
mod walkers;

pub use characters::NoExperiment;
pub use clock::Stopwatch;
pub use contender::{Contender, Entrant};
pub use experiment::{Experiment, Frame};
pub use many::{Asked, Many, ManyQuestions, NotAsked};
pub use measure::{Disagreement, Parts, Plan, Row, disagreement, measure, median};
pub use questions::{Answer, Questions};
