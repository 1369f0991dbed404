//! Where a surface was, is and will be, and how fast its points move.

mod continuity;
mod moment;
mod point;
mod prediction;
mod step;
mod surface;

pub use moment::{Moment, Moments};
pub use point::SurfacePoint;
pub use prediction::Prediction;
pub use surface::MovingSurface;
