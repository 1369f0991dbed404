//! Queries over one posed body, and distances between two, judged by brute force written a second time.

mod anchors;
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
