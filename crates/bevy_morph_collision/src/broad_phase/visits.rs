//! Which colliders have to be placed anew.

use bevy::ecs::system::{SystemChangeTick, SystemParam};
use bevy::prelude::*;

use crate::app::{Column, Rows, any_added, blocks, has, ran_long_ago};
use crate::components::{MorphCollider, MorphColliderDisabled, MorphColliderOf, MorphCollisionLayers, MorphShape};
use crate::state::ColliderState;

/// What the place of a collider depends on, besides its pose.
type Columns = (
    Entity,
    Ref<'static, MorphCollider>,
    Ref<'static, GlobalTransform>,
    Option<Ref<'static, MorphCollisionLayers>>,
    Option<Ref<'static, MorphColliderOf>>,
    Option<Ref<'static, MorphShape>>,
    Option<Ref<'static, MorphColliderDisabled>>,
);

/// Finds the colliders that have to be placed anew.
#[derive(SystemParam)]
pub(crate) struct Visits<'w, 's> {
    columns: Query<'w, 's, Columns, With<ColliderState>>,
    rows: Local<'s, Rows>,
    changed: Local<'s, Vec<Entity>>,
    ticks: SystemChangeTick,
}

/// The colliders that have to be placed anew.
#[derive(Clone, Copy)]
pub(super) enum Visited<'a> {
    All {
        /// Whether they are the same colliders as in the last run, with the same components.
        are_same: bool,
    },
    /// These, each once.
    Some(&'a [Entity]),
}

impl Visits<'_, '_> {
    /// Finds those that may have changed since the last run, and those in `reposed`.
    pub(super) fn find(&mut self, reposed: &[Entity]) -> Visited<'_> {
        let (rows, changed) = (&mut *self.rows, &mut *self.changed);
        changed.clear();
        let tables = || self.columns.contiguous_iter().ok().into_iter().flatten();
        let lists = tables().map(|(entities, _, _, layers, body, shape, disabled)| {
            let has = has([layers.is_some(), body.is_some(), shape.is_some(), disabled.is_some()]);
            (entities, has)
        });
        // A collider that was removed and added again has a new state.
        let any_anew = tables().any(|(_, collider, ..)| any_added(Some(&collider)));
        let are_same = self.columns.contiguous_iter().is_ok() && rows.replace(lists) && !any_anew;
        if !are_same || ran_long_ago(&self.ticks) {
            return Visited::All { are_same };
        }
        // Where most of them have changed, it takes less to look at all of them than to look them up.
        let most = rows.len() / 2;
        if reposed.len() > most {
            return Visited::All { are_same };
        }
        for (entities, collider, place, layers, body, shape, disabled) in tables() {
            let columns = [
                Some(Column::changed(&place)),
                Some(Column::changed(&collider)),
                layers.as_ref().map(Column::changed),
                body.as_ref().map(Column::changed),
                shape.as_ref().map(Column::changed),
                disabled.as_ref().map(Column::changed),
            ];
            let columns = || columns.iter().flatten();
            for block in blocks(entities.len()) {
                if columns().any(|column| column.any_new_in(block.clone())) {
                    let is_new = |&row: &usize| columns().any(|column| column.is_new(row));
                    changed.extend(block.filter(is_new).map(|row| entities[row]));
                }
            }
            if changed.len() > most {
                return Visited::All { are_same };
            }
        }
        if !reposed.is_empty() {
            changed.extend_from_slice(reposed);
            changed.sort_unstable();
            changed.dedup();
        }
        Visited::Some(changed)
    }
}
