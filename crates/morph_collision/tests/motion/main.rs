//! Continuous collision: features of known verdict (`published`), and bodies against every pair of features (`bodies`).

mod bodies;
mod published;
