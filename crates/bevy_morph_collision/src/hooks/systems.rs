//! Calls hooks.

use std::any::TypeId;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::{StaticSystemParam, SystemParamItem};
use bevy::platform::time::Instant;
use bevy::prelude::*;
use tracing::debug_span;

use super::interface::MorphCollisionHooks;
use crate::broad_phase::{Candidates, HookAnswer, HookedPairs};
use crate::components::MorphActiveCollisionHooks;
use crate::contacts::MorphCollisions;
use crate::narrow_phase::FoundContacts;

/// The hooks of the app, in the order in which they are asked.
#[derive(Resource, Default)]
pub(crate) struct HooksInApp(Vec<TypeId>);

impl HooksInApp {
    /// Adds a type of hooks. Returns its number; `None` if it is there already.
    pub(crate) fn add(&mut self, hooks: TypeId) -> Option<usize> {
        if self.0.contains(&hooks) {
            return None;
        }
        self.0.push(hooks);
        Some(self.0.len() - 1)
    }
}

/// Asks hooks about the candidate pairs, and notes those whose contacts they may change.
///
/// Hooks may read what the plugin knows, so nothing public is written here.
pub(crate) fn filter_pairs<H: MorphCollisionHooks + 'static>(
    hooks: StaticSystemParam<H>,
    active: Query<&MorphActiveCollisionHooks, Allow<Disabled>>,
    candidates: Res<Candidates>,
    mut hooked: ResMut<HookedPairs>,
    mut commands: Commands,
) where
    for<'w, 's> SystemParamItem<'w, 's, H>: MorphCollisionHooks,
{
    if active.is_empty() {
        return;
    }
    let start = Instant::now();
    let _span = debug_span!("morph_collision::filter_pairs").entered();
    let hooks = hooks.into_inner();
    hooked.ask(&candidates, |pair| {
        let all = [pair.collider1, pair.collider2, pair.body1, pair.body2].map(|entity| active.get(entity).ok());
        let any = |asks: fn(&MorphActiveCollisionHooks) -> bool| all.iter().flatten().any(|active| asks(active));
        HookAnswer {
            is_refused: any(|active| active.filter_pairs) && !hooks.filter_pairs(pair, &mut commands),
            is_modified: any(|active| active.modify_contacts),
        }
    });
    hooked.duration += start.elapsed();
}

/// Lets hooks change contacts.
pub(crate) fn modify_contacts<H: MorphCollisionHooks + 'static>(
    hooks: StaticSystemParam<H>,
    hooked: Res<HookedPairs>,
    collisions: Res<MorphCollisions>,
    mut found: ResMut<FoundContacts>,
    mut commands: Commands,
) where
    for<'w, 's> SystemParamItem<'w, 's, H>: MorphCollisionHooks,
{
    if !hooked.any_is_modified() {
        return;
    }
    let start = Instant::now();
    let _span = debug_span!("morph_collision::modify_contacts").entered();
    let hooks = hooks.into_inner();
    found.keep_if(&hooked, &collisions, |contact| {
        hooks.modify_contacts(contact, &mut commands)
    });
    found.duration += start.elapsed();
}
