//! Casters: components that cast a ray or a shape in every run.
//!
//! - `ray`: [`MorphRayCaster`] and [`MorphRayHits`]. `shape`: [`MorphShapeCaster`] and [`MorphShapeHits`].
//! - `cast`: the system that casts all of a kind at once. `carrier`: where casters are, and on which body.

mod carrier;
mod cast;
mod ray;
mod shape;

use bevy::ecs::schedule::ScheduleConfigs;
use bevy::ecs::system::ScheduleSystem;
use bevy::prelude::*;

use cast::cast_all;

pub use ray::{MorphRayCaster, MorphRayHits};
pub use shape::{MorphShapeCaster, MorphShapeHits};

/// The systems. Without casters they do not run.
pub(crate) fn casters() -> ScheduleConfigs<ScheduleSystem> {
    let systems = (
        cast_all::<MorphRayCaster>.run_if(any_with_component::<MorphRayCaster>),
        cast_all::<MorphShapeCaster>.run_if(any_with_component::<MorphShapeCaster>),
    );
    // One after the other, because both add to the same diagnostics.
    systems.chain()
}
