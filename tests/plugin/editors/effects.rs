//! Changes take effect in the next run.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use serde_json::json;

use super::remote::Remote;
use crate::log::Errors;
use crate::support::{Edits, diagnostics, move_to, settle, touches, two_cubes};

#[test]
fn changed_settings_of_a_collider_take_effect() {
    let (mut app, [a, b]) = two_cubes(1.2);
    assert!(!touches(&app, a, b));
    app.set::<MorphCollider>(a, ".margin", 0.5);
    app.update();
    assert!(touches(&app, a, b));
    app.set::<MorphCollider>(a, ".margin", 0.0);
    move_to(&mut app, b, 0.9);
    app.set::<MorphCollider>(b, ".mode", "Contacts");
    app.update();
    assert!(app.contact(a, b).is_some_and(|contact| !contact.points.is_empty()));
    app.set::<MorphCollisionLayers>(b, ".memberships", 0);
    app.update();
    assert!(!touches(&app, a, b));
    app.set::<MorphCollisionLayers>(b, ".memberships", 1);
    app.set::<MorphCollider>(b, ".tolerance", 0.5);
    app.update();
    assert!(touches(&app, a, b));
    move_to(&mut app, b, 1.2);
    app.update();
    assert!(touches(&app, a, b) && diagnostics(&app).held_colliders == 1);
    app.set::<MorphCollider>(b, ".tolerance", 0.0);
    app.update();
    assert!(!touches(&app, a, b));
}

#[test]
fn changed_shapes_and_casters_take_effect() {
    let (mut app, [a, b]) = two_cubes(5.0);
    let ball = app.spawn((MorphShape::Ball { radius: 0.5 }, Transform::from_xyz(0.0, 1.5, 0.0)));
    let eye = app.spawn((MorphRayCaster::default(), Transform::from_xyz(2.5, 0.0, 0.0)));
    settle(&mut app);
    let seen = |app: &App| {
        let hits = app.world().get::<MorphRayHits>(eye).expect("it is required");
        hits.first().map(|hit| hit.entity)
    };
    assert!(!touches(&app, a, ball) && seen(&app).is_none());
    app.set::<MorphShape>(ball, ".radius", 1.1);
    app.set::<MorphRayCaster>(eye, ".direction", json!([1.0, 0.0, 0.0]));
    app.update();
    assert!(touches(&app, a, ball));
    assert_eq!(seen(&app), Some(b));
    let capsule = json!({ "Capsule": { "half_length": 0.25, "radius": 0.25 } });
    app.set::<MorphShape>(ball, "", capsule);
    app.set::<MorphRayCaster>(eye, ".filter.excluded_entities", json!([b]));
    app.update();
    assert!(!touches(&app, a, ball) && seen(&app).is_none());
}

#[test]
fn changed_settings_of_the_app_take_effect() {
    let (mut app, [a, b]) = two_cubes(0.5);
    app.set_resource::<MorphCollisionSettings>(".max_triangle_pairs", 2);
    app.update();
    assert!(
        app.contact(a, b)
            .is_some_and(|contact| contact.triangles.len() == 2 && contact.is_truncated)
    );
    app.set_resource::<MorphCollisionSettings>(".paused", true);
    move_to(&mut app, b, 5.0);
    app.update();
    assert!(touches(&app, a, b));
    app.set_resource::<MorphCollisionSettings>(".paused", false);
    app.update();
    assert!(!touches(&app, a, b));
    let nodes = diagnostics(&app).nodes_total;
    app.set_resource::<MorphCollisionSettings>(".tree_options.leaf_size", 1);
    settle(&mut app);
    assert!(diagnostics(&app).nodes_total > nodes, "the trees are built again");
}

#[test]
fn bad_settings_are_logged_once_and_harm_nothing_else() {
    Errors::collect(|errors| {
        let (mut app, [a, b]) = two_cubes(0.5);
        for (field, bad) in [(".margin", -1.0), (".tolerance", -0.5)] {
            app.set::<MorphCollider>(b, field, bad);
            app.update();
            app.update();
            let logged = errors.take();
            assert_eq!(logged.len(), 1, "{logged:?}");
            assert!(logged[0].contains(&field[1..]) && !touches(&app, a, b), "{logged:?}");
            app.set::<MorphCollider>(b, field, 0.0);
            app.update();
            assert!(touches(&app, a, b));
        }
        // The trees of the last good options stay in use.
        app.set_resource::<MorphCollisionSettings>(".tree_options.leaf_size", 0);
        settle(&mut app);
        assert_eq!(errors.take().len(), 1);
        assert!(touches(&app, a, b));
        // A value of another type is refused.
        let path = MorphCollider::type_path();
        assert!(app.mutate(a, path, ".margin", &json!("wide")).is_err());
        assert!(app.mutate(a, path, ".mode", &json!("Some")).is_err());
    });
}
