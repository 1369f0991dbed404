//! Adds hooks to an app.

use std::marker::PhantomData;

use bevy::ecs::system::SystemParamItem;
use bevy::prelude::*;
use tracing::error;

use super::schedule::MorphCollisionSchedule;
use crate::app::MorphCollisionSystems;
use crate::broad_phase::find_candidates;
use crate::contacts::MorphCollisions;
use crate::hooks::{HooksInApp, MorphCollisionHooks, filter_pairs, modify_contacts};
use crate::narrow_phase::{find_contacts, store_contacts};

/// Adds [hooks](MorphCollisionHooks) to an app: before or after the plugin for collisions, in any number.
///
/// Colliders ask them if they have [`MorphActiveCollisionHooks`](crate::components::MorphActiveCollisionHooks). Cost per run: two calls at most
/// for each of their pairs.
#[derive(Debug)]
pub struct MorphCollisionHooksPlugin<H>(PhantomData<fn() -> H>);

impl<H> Default for MorphCollisionHooksPlugin<H> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<H: MorphCollisionHooks + 'static> Plugin for MorphCollisionHooksPlugin<H>
where
    for<'w, 's> SystemParamItem<'w, 's, H>: MorphCollisionHooks,
{
    fn build(&self, _: &mut App) {}

    // All plugins are there, so the schedule is chosen.
    fn finish(&self, app: &mut App) {
        if !app.world().contains_resource::<MorphCollisions>() {
            error!(
                "`MorphCollisionHooksPlugin` has no effect: add `MorphPlugins` or `MorphCollisionPlugin` to the app"
            );
            return;
        }
        let schedule = MorphCollisionSchedule::of(app);
        app.init_resource::<HooksInApp>().add_systems(
            schedule,
            (
                filter_pairs::<H>
                    .in_set(MorphCollisionSystems::BroadPhase)
                    .after(find_candidates),
                modify_contacts::<H>
                    .in_set(MorphCollisionSystems::NarrowPhase)
                    .after(find_contacts)
                    .before(store_contacts),
            ),
        );
    }
}
