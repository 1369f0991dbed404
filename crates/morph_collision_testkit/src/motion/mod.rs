//! When two moving features first touch, in exact arithmetic. The continuous tests of the core library are compared with it.
//!
//! ```text
//! ElementaryMotion --integer coordinates--> moving triangles --polynomials--> sign conditions --Root--> first contact
//! ```
//!
//! All points move linearly: a point is at `start + t (end - start)` at time `t`, from 0 to 1, in real arithmetic on the given
//! `f64` coordinates. A contact is a time at which the distance is exactly zero. Faces and edges are closed, and they may be
//! degenerate. Touching at time 0 counts, and then the first time is 0.
//!
//! Nothing here uses the crate `morph_collision`. There is no tolerance and no floating-point arithmetic: coordinates become
//! integers, times are algebraic numbers ([`Root`]), and every decision is the sign of a polynomial with integer coefficients at
//! such a number. An answer takes microseconds to milliseconds, more if exponents differ a lot.
//!
//! - [`first_contact`] answers an [`ElementaryMotion`]: a vertex and a face, or two edges.
//! - [`TouchGeometry`] judges where and how features are said to touch, in `f64`.
//! - [`Family`] draws difficult motions.
//! - [`records`] reads recorded motions with known answers.

mod elementary;
mod geometry;
mod polynomial;
mod random;
pub mod records;
mod remainders;
mod root;
mod triangle;
mod truth;

pub use elementary::{ElementaryMotion, MotionKind, PointMotion};
pub use geometry::TouchGeometry;
pub use random::Family;
pub use root::Root;
pub use truth::{edge_edge, first_contact, vertex_face};
