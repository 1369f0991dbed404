//! Which moment of the drawn animation a step uses, and what a surface was drawn with at that moment.

mod clock;
mod history;
mod recorded_frames;
mod recorded_value;
mod timeline;
mod timing;
mod weights;

pub use clock::{Lag, Span, StepTime, Watch};
pub use history::{DrawnHistory, Live, SurfaceComponents, SurfaceComponentsItem};
pub use recorded_value::RecordedValue;
pub use timeline::Timeline;
pub use timing::{InFixedLoop, Timing, track_fixed_loop};
pub use weights::WeightSource;
