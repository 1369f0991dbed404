//! The schedule in which collision detection runs.

use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use tracing::error;

use crate::contacts::MorphCollisions;

/// The schedule in which collision detection runs: [`PostUpdate`] unless
/// [`MorphPlugins::in_schedule`](crate::plugins::MorphPlugins::in_schedule) or
/// [`MorphCollisionPlugin::in_schedule`](crate::plugins::MorphCollisionPlugin::in_schedule) choose another.
///
/// In any schedule other than [`PostUpdate`], the plugin first propagates transforms there, so that entities moved in
/// [`FixedUpdate`] are at their new place. Morph weights are those of the last frame's animation. [Surface
/// anchors](crate::surface::MorphSurfaceAnchor) still update in [`PostUpdate`]. For what
/// [`MorphCollisions::started`](crate::contacts::MorphCollisions::started) and
/// [`MorphCollisions::ended`](crate::contacts::MorphCollisions::ended) return then, see
/// [`MorphCollisions`](crate::contacts::MorphCollisions#what-started-and-ended).
#[derive(Resource, Clone, Copy, Debug)]
pub struct MorphCollisionSchedule(InternedScheduleLabel);

impl MorphCollisionSchedule {
    pub(crate) fn new(schedule: impl ScheduleLabel) -> Self {
        Self(schedule.intern())
    }

    /// The schedule that was chosen for an app.
    pub(crate) fn of(app: &App) -> InternedScheduleLabel {
        let chosen = app.world().get_resource::<Self>();
        chosen.map_or(PostUpdate.intern(), |chosen| chosen.0)
    }
}

/// Makes the choice for [`MorphCollisionPlugin`](crate::plugins::MorphCollisionPlugin), which comes after it.
impl Plugin for MorphCollisionSchedule {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<MorphCollisions>() {
            error!("`MorphCollisionSchedule` has no effect, because `MorphCollisionPlugin` was added before it");
        }
        app.insert_resource(*self);
    }
}
