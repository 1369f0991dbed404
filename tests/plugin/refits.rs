//! How few nodes of the trees are refitted.

use bevy::prelude::*;
use morph_collision_workspace::instances::Instances;

use crate::support::{Edits, app, assets, diagnostics, two_cubes};

fn dolphins(app: &mut App, file: &str, count: usize) -> Instances {
    Instances::spawn(app, &assets().join(file), count, false).expect("the dolphin can be loaded")
}

#[test]
fn bodies_apart_cost_one_volume_each() {
    let mut app = app();
    let instances = dolphins(&mut app, "dolphin_564.glb", 5);
    let mut blended = 0;
    for frame in 0..10 {
        for (place, &root) in instances.roots.iter().enumerate() {
            let apart = Transform::from_xyz(0.1 * frame as f32, 0.0, 5.0 * place as f32);
            app.insert(root, apart);
        }
        app.update();
        let frame = diagnostics(&app);
        assert_eq!(
            (frame.colliders, frame.candidate_pairs, frame.touching_pairs),
            (5, 0, 0)
        );
        assert!(frame.nodes_total > 300);
        let stats = frame.stats;
        assert!(stats.nodes_blended <= 5, "{stats:?}");
        blended += stats.nodes_blended;
        assert_eq!(
            (stats.node_tests, stats.triangle_tests, stats.vertices_blended),
            (0, 0, 0)
        );
    }
    // A body whose weights did not change keeps its root.
    assert!(blended > 40, "{blended} roots were refitted");
}

#[test]
fn bodies_that_barely_touch_refit_a_few_percent() {
    let mut app = app();
    let instances = dolphins(&mut app, "dolphin_9024.glb", 12);
    let (mut blended, mut total, mut touching) = (0, 0, 0);
    for frame in (0..400).step_by(8) {
        instances.advance(app.world_mut(), frame, 400);
        app.update();
        let frame = diagnostics(&app);
        blended += frame.stats.nodes_blended;
        total += frame.nodes_total;
        touching += frame.touching_pairs;
    }
    assert!(touching > 50, "{touching} contacts try little");
    assert!(blended * 100 < total * 6, "{blended} of {total} nodes were refitted");
}

#[test]
fn a_contact_at_rest_is_not_looked_at_again() {
    let (mut app, [_, b]) = two_cubes(0.8);
    app.update();
    let frame = diagnostics(&app);
    assert_eq!((frame.candidate_pairs, frame.touching_pairs), (1, 1));
    assert_eq!(frame.stats, default());
    assert!(frame.triangle_pairs > 0);

    crate::support::move_to(&mut app, b, 0.79);
    app.update();
    assert!(diagnostics(&app).stats.triangle_tests > 0);
}

#[test]
fn a_paused_animation_costs_nothing() {
    let mut app = app();
    let instances = dolphins(&mut app, "dolphin_564.glb", 3);
    // All are in one place, so that all are compared, and play from different times.
    app.update();
    app.update();
    assert!(diagnostics(&app).stats.nodes_blended > 0 && diagnostics(&app).touching_pairs > 0);
    let mut players = app.world_mut().query::<&mut AnimationPlayer>();
    assert_eq!(players.iter(app.world()).count(), instances.roots.len());
    for mut player in players.iter_mut(app.world_mut()) {
        player.pause_all();
    }
    app.update();
    for _ in 0..3 {
        app.update();
        let run = diagnostics(&app);
        assert_eq!(run.stats, default());
        assert_eq!((run.candidate_pairs, run.skipped_unchanged), (3, 3));
    }
}
