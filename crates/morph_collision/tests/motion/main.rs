//! Continuous collision: features of known verdict (`published`), bodies against every pair of features (`bodies`), and points and balls
//! against every triangle (`balls`).

mod balls;
mod bodies;
mod extremes;
mod published;
