//! What a user asks: each query is a walk and what it does at the leaves.

mod body;
mod contact;
mod pairs;
mod shape;

pub use body::Body;
pub use contact::{ContactPoint, ContactQuery, Manifold, PairContact, Separation};
pub use pairs::{PairQuery, PairStats, SeparatingAxes, TrianglePair};
pub use shape::{PlacedShape, Shape, ShapeContact, ShapeError, ShapeQuery, WorldFromShape};
