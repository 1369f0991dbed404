//! Answers, checked against brute force for every way to build a tree, and the work they took.
#![allow(clippy::disallowed_methods)]

mod batch;
mod collapsed;
mod laziness;
mod memory;
mod pairs;
mod scenes;
mod self_pairs;
