//! Adds hooks to an app.

use std::any::TypeId;
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

/// Adds [hooks](MorphCollisionHooks) to an app: before or after the plugin for collisions, in any number. They are asked in the order in
/// which they were added; those that were added after the plugin for collisions come first.
///
/// Colliders ask them if they have [`MorphActiveCollisionHooks`](crate::components::MorphActiveCollisionHooks). While no entity has it, this
/// costs nothing. Then each candidate pair costs some look-ups for each plugin of this kind, and each pair that asks two calls at most.
#[derive(Debug)]
pub struct MorphCollisionHooksPlugin<H>(PhantomData<fn() -> H>);

impl<H> Default for MorphCollisionHooksPlugin<H> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

/// The order of several hooks.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum HookSystems {
    Filter(usize),
    Modify(usize),
}

impl<H: MorphCollisionHooks + 'static> Plugin for MorphCollisionHooksPlugin<H>
where
    for<'w, 's> SystemParamItem<'w, 's, H>: MorphCollisionHooks,
{
    fn build(&self, app: &mut App) {
        // Otherwise the schedule is not chosen yet.
        if app.world().contains_resource::<MorphCollisions>() {
            add::<H>(app);
        }
    }

    fn finish(&self, app: &mut App) {
        if app.world().contains_resource::<MorphCollisions>() {
            add::<H>(app);
        } else {
            error!(
                "`MorphCollisionHooksPlugin` has no effect: add `MorphPlugins` or `MorphCollisionPlugin` to the app"
            );
        }
    }
}

/// Adds hooks once.
fn add<H: MorphCollisionHooks + 'static>(app: &mut App)
where
    for<'w, 's> SystemParamItem<'w, 's, H>: MorphCollisionHooks,
{
    let Some(number) = app
        .world_mut()
        .get_resource_or_init::<HooksInApp>()
        .add(TypeId::of::<H>())
    else {
        return;
    };
    let schedule = MorphCollisionSchedule::of(app);
    let next = number + 1;
    app.configure_sets(
        schedule,
        (
            HookSystems::Filter(number)
                .in_set(MorphCollisionSystems::BroadPhase)
                .after(find_candidates)
                .before(HookSystems::Filter(next)),
            HookSystems::Modify(number)
                .in_set(MorphCollisionSystems::NarrowPhase)
                .after(find_contacts)
                .before(HookSystems::Modify(next))
                .before(store_contacts),
        ),
    )
    .add_systems(
        schedule,
        (
            filter_pairs::<H>.in_set(HookSystems::Filter(number)),
            modify_contacts::<H>.in_set(HookSystems::Modify(number)),
        ),
    );
}
