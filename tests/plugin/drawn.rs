//! Debug drawing.

use bevy::gizmos::GizmoPlugin;
use bevy::gizmos::config::GizmoConfigStore;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::{headless, ready};

use crate::support::{add_mesh, assets, cube, diagnostics, settle, spawn};

/// Changes what is drawn and runs a frame.
fn draw(app: &mut App, change: impl FnOnce(&mut MorphGizmos)) {
    let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
    change(store.config_mut::<MorphGizmos>().1);
    app.update();
}

#[test]
fn drawing_changes_no_answer_and_costs_nothing_where_nothing_is_drawn() {
    let mut app = headless(&assets());
    app.add_plugins((GizmoPlugin, MorphGizmosPlugin));
    ready(&mut app);
    let mesh = add_mesh(&mut app, &cube());
    let [a, b] = [0.0, 0.8].map(|x| spawn(&mut app, &mesh, x));
    settle(&mut app);
    let contact = |app: &App| app.world().resource::<MorphCollisions>().get(a, b).cloned();
    let before = contact(&app);
    assert!(before.is_some());
    for depth in [Some(0), Some(1), Some(9), None] {
        draw(&mut app, |gizmos| gizmos.depth = depth);
        assert_eq!(contact(&app), before);
        assert_eq!(diagnostics(&app).stats, default());
    }
    draw(&mut app, |gizmos| (gizmos.triangles, gizmos.contacts) = (None, None));
    assert_eq!(contact(&app), before);
}
