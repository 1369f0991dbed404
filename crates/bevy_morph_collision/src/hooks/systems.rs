//! Calls hooks.

use bevy::ecs::system::{StaticSystemParam, SystemParamItem};
use bevy::prelude::*;

use super::interface::MorphCollisionHooks;
use crate::broad_phase::{Candidates, HookAnswer};
use crate::components::MorphActiveCollisionHooks;
use crate::narrow_phase::FoundContacts;
use crate::state::MorphCollisionDiagnostics;

/// Says that the app has hooks.
#[derive(Resource, Default)]
pub(crate) struct HooksInApp;

/// Asks hooks about the candidate pairs, and notes those whose contacts they may change.
pub(crate) fn filter_pairs<H: MorphCollisionHooks + 'static>(
    hooks: StaticSystemParam<H>,
    active: Query<&MorphActiveCollisionHooks>,
    mut candidates: ResMut<Candidates>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
    mut commands: Commands,
) where
    for<'w, 's> SystemParamItem<'w, 's, H>: MorphCollisionHooks,
{
    if active.is_empty() {
        return;
    }
    let hooks = hooks.into_inner();
    let asks = |entity: Entity| active.get(entity).copied().unwrap_or_default();
    let refused = candidates.ask_hook(|pair| {
        let all = [pair.collider1, pair.collider2, pair.body1, pair.body2].map(asks);
        HookAnswer {
            is_refused: all.iter().any(|asks| asks.filter_pairs) && !hooks.filter_pairs(pair, &mut commands),
            is_modified: all.iter().any(|asks| asks.modify_contacts),
        }
    });
    diagnostics.skipped_hooks += refused;
    diagnostics.candidate_pairs -= refused;
}

/// Lets hooks change contacts.
pub(crate) fn modify_contacts<H: MorphCollisionHooks + 'static>(
    hooks: StaticSystemParam<H>,
    candidates: Res<Candidates>,
    mut found: ResMut<FoundContacts>,
    mut commands: Commands,
) where
    for<'w, 's> SystemParamItem<'w, 's, H>: MorphCollisionHooks,
{
    let hooks = hooks.into_inner();
    found.keep_if(|contact| !candidates.hooked.modify(contact.pair()) || hooks.modify_contacts(contact, &mut commands));
}
