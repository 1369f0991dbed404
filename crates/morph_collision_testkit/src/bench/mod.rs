//! Timing `morph_collision` and its [rivals](crate::rivals) against each other.
//!
//! ```text
//! Experiment (frames) + Contenders (methods) --measure (interleaved rounds)--> Rows (times, counts, pairs)
//! ```
//!
//! # How times are taken
//!
//! - **In turns.** A round lets every contender run all frames, one contender after the other (A B C A B C ...), so that what
//!   disturbs the machine disturbs all alike. Round 0 fills caches and grows memory, and is thrown away. A ratio is the
//!   median over the rounds of the ratio within a round, a time the median over the rounds.
//! - **Of whole frames.** A frame is: every body gets its weights and place, boxes of bodies are swept for overlaps, and
//!   each overlapping pair is asked for its triangles. Loading and building are left out, and what
//!   [`Method::prepare`](crate::rivals::Method::prepare) does; where that did anything the frame is run once before it is timed,
//!   since bodies that never change have long been looked at.
//! - **On one thread**, [pinned](pin) to a core if the caller wants it, by the [`Stopwatch`]: time on a processor, so that
//!   waiting for one does not count. What an idle stopwatch shows is subtracted.
//!
//! # How times are split
//!
//! [`Parts`] come from passes of their own, since reading the clock in the middle of a frame disturbs it. There *blend* is the
//! time of [`Method::blend`](crate::rivals::Method::blend) of all bodies (weights, places, and vertices that follow at once), *refit*
//! that of [`Method::refit`](crate::rivals::Method::refit) of all bodies, *query* the rest: broad phase and pairs.
//! Methods that let volumes or vertices follow when a query looks at them ([`Method::is_lazy`](crate::rivals::Method::is_lazy)) are asked the
//! same frame twice: the second time nothing is left to follow, so that its time is *query*, and what the first took more
//! counts as *refit*. The second
//! time also finds processor caches warm, which makes *refit* of lazy methods an upper estimate. Parts
//! are then scaled, so that they come to the undisturbed total. For `morph` and `morph-eager` *blend* is setting weights, and vertices are blended in
//! *refit*.

mod characters;
mod clock;
mod contender;
mod experiment;
mod machine;
mod measure;
mod of_model;
mod page;
mod played;
mod questions;
mod rays;
mod runner;
mod walkers;

pub use characters::NoExperiment;
pub use clock::Stopwatch;
pub use contender::{Contender, Entrant};
pub use experiment::{Experiment, Frame};
pub use machine::{cpu, pin};
pub use measure::{Disagreement, Parts, Plan, Row, disagreement, measure, median};
pub use page::Page;
pub use questions::{Found, Questions};
