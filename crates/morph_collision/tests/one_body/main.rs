//! Queries about one posed body, and distances between two, checked against an independent brute-force implementation.
#![allow(clippy::disallowed_methods)]

mod anchors;
mod batches;
mod bodies;
mod casts;
mod containment;
mod distance;
mod laziness;
mod points;
mod rays;
mod reference;
mod regions;
mod shape;
mod within;
