//! Hooks whose answers depend on a resource of the game.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::banks::Banks;

/// What the hooks depend on.
#[derive(Resource, Clone, Copy, Default)]
pub(super) struct Rule(pub(super) u32);

#[derive(SystemParam)]
pub(super) struct Rules<'w> {
    rule: Res<'w, Rule>,
    banks: Res<'w, Banks>,
}

impl MorphCollisionHooks for Rules<'_> {
    fn filter_pairs(&self, pair: &MorphCandidatePair, _: &mut Commands) -> bool {
        let rows = self.banks.row(pair.collider1) + self.banks.row(pair.collider2);
        !(rows + self.rule.0).is_multiple_of(3)
    }

    fn modify_contacts(&self, contact: &mut MorphContact, _: &mut Commands) -> bool {
        contact.normal *= 0.5;
        !(self.banks.row(contact.collider1) + self.rule.0).is_multiple_of(4)
    }
}
