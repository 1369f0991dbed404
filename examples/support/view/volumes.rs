//! The bounding volumes that are drawn, and the key that goes down and up their levels.

use bevy::gizmos::config::GizmoConfigStore;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::clock;

/// The deepest selectable level.
pub(super) const DEEPEST: usize = 12;

pub(super) fn plugin(app: &mut App) {
    app.add_systems(Update, step_by_key.run_if(not(clock::is_typing)));
}

/// Draws the bounding volumes at depth `level` below the root; `None` draws none.
pub fn show_volumes(app: &mut App, level: Option<usize>) {
    set(&mut app.world_mut().resource_mut::<GizmoConfigStore>(), level);
}

/// The level that is drawn.
pub(super) fn level(store: &GizmoConfigStore) -> Option<usize> {
    store.config::<MorphGizmos>().1.depth
}

pub(super) fn set(store: &mut GizmoConfigStore, level: Option<usize>) {
    store.config_mut::<MorphGizmos>().1.depth = level;
}

fn step_by_key(keys: Res<ButtonInput<KeyCode>>, mut store: ResMut<GizmoConfigStore>) {
    if !keys.just_pressed(KeyCode::KeyV) {
        return;
    }
    // In a slow frame, both may have been released already.
    let shift = [KeyCode::ShiftLeft, KeyCode::ShiftRight];
    let higher = keys.any_pressed(shift) || keys.any_just_pressed(shift);
    let next = match (level(&store), higher) {
        (None, false) => Some(0),
        (None | Some(0), true) => None,
        (Some(level), false) => Some((level + 1).min(DEEPEST)),
        (Some(level), true) => Some(level - 1),
    };
    set(&mut store, next);
}
