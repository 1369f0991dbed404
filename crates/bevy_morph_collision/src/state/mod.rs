//! What the plugin keeps for each collider and for each run.
//!
//! - `collider_state`: the component with everything about one collider.
//!   - `locked_pose`: its pose. `placement`: where and how it takes part. `previous`: the same one run earlier.
//!   - `held`: the earlier state that collisions see if the collider has a tolerance.
//!   - `memory`: what of all this a rollback has to bring back.
//!   - `bad_weights`, `readiness`: what has been reported about it.
//! - `freshness`: what has changed since the last run, and who has noticed. `news`: which colliders a run has to look at. `run_times`: when runs were. `diagnostics`, `stage_times`, `pair_costs`: what the last run did, for how long, and for which pairs.

mod bad_weights;
mod collider_state;
mod diagnostics;
mod freshness;
mod held;
mod locked_pose;
mod memory;
mod news;
mod pair_costs;
mod placement;
mod previous;
mod readiness;
mod run_times;
mod stage_times;

use bevy::prelude::*;

use crate::app::require_state;
use crate::components::MorphCollider;

pub(crate) use bad_weights::BadWeights;
pub(crate) use collider_state::ColliderState;
pub use diagnostics::MorphCollisionDiagnostics;
pub(crate) use diagnostics::{Preparation, begin_run};

pub(crate) use freshness::Runs;
pub(crate) use locked_pose::LockedPose;
pub(crate) use memory::ColliderMemory;
pub(crate) use news::{ColliderNews, Moved};
pub use pair_costs::{MorphPairCost, MorphPairCosts};
pub(crate) use pair_costs::{PairWork, tests};
pub(crate) use placement::{Form, Placement, Skip};

pub(crate) use readiness::Readiness;
pub(crate) use run_times::RunTimes;
pub use stage_times::MorphStageTimes;

/// Adds the state of runs, and a state to every collider.
pub(crate) fn add(app: &mut App) {
    app.init_resource::<MorphCollisionDiagnostics>()
        .init_resource::<ColliderNews>()
        .init_resource::<MorphPairCosts>()
        .init_resource::<Preparation>()
        .init_resource::<RunTimes>()
        .init_resource::<Runs>()
        .register_type::<MorphCollisionDiagnostics>()
        .register_type::<MorphPairCosts>()
        .add_observer(collider_state::forget_collider);
    require_state::<MorphCollider, ColliderState>(app);
}
