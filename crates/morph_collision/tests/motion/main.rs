//! Continuous collision: features of known verdict (`published`), bodies against every pair of features (`bodies`), and points, balls
//! (`balls`) and shapes (`shapes`) against every triangle.
#![allow(clippy::disallowed_methods)]

mod balls;
mod bodies;
mod extremes;
mod published;
mod shapes;
