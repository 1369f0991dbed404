//! Meshes: as one, in part, and posed.

mod joined;
mod posed;
mod together;
mod unweighted;
