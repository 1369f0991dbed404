//! Changes other than those of weights, joints and places.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::collider;
use super::motion::two;
use crate::support::{Edits, diagnostics, move_to, touches};

type Change = fn(&mut EntityWorldMut<'_>);

#[test]
fn other_changes_count_at_once() {
    let mut checks: Vec<(&str, Change, bool)> = Vec::new();
    checks.push((
        "tolerance",
        |cube| {
            cube.insert(collider(0.0));
        },
        true,
    ));
    checks.push((
        "less tolerance",
        |cube| {
            cube.insert(collider(0.01));
        },
        true,
    ));
    checks.push((
        "margin",
        |cube| {
            cube.insert(collider(0.1).with_margin(0.1));
        },
        true,
    ));
    checks.push((
        "shape",
        |cube| {
            cube.insert(MorphShape::Ball { radius: 0.5 });
        },
        true,
    ));
    let far = |cube: &mut EntityWorldMut<'_>| {
        cube.insert(Transform::from_xyz(9.0, 0.0, 0.0));
    };
    checks.push(("a teleport", far, false));
    for (what, change, is_touching) in checks {
        let (mut app, [a, b]) = two(0.1, 1.02);
        move_to(&mut app, b, 0.95);
        app.update();
        assert!(!touches(&app, a, b) && diagnostics(&app).held_colliders == 1, "{what}");
        change(&mut app.world_mut().entity_mut(b));
        app.update();
        assert_eq!(touches(&app, a, b), is_touching, "{what}");
        assert_eq!(diagnostics(&app).held_colliders, 0, "{what}");
    }
    // Changes that end a contact.
    let mut checks: Vec<(&str, Change)> = Vec::new();
    checks.push(("layers", |cube| {
        cube.insert(MorphCollisionLayers::NONE);
    }));
    checks.push(("disabled", |cube| {
        cube.insert(MorphColliderDisabled);
    }));
    checks.push(("no mesh", |cube| {
        cube.remove::<Mesh3d>();
    }));
    checks.push(("a place that is not finite", |cube| {
        cube.insert(Transform::from_translation(Vec3::NAN));
    }));
    for (what, change) in checks {
        let (mut app, [a, b]) = two(0.1, 0.9);
        move_to(&mut app, b, 0.95);
        app.update();
        assert!(touches(&app, a, b) && diagnostics(&app).held_colliders == 1, "{what}");
        change(&mut app.world_mut().entity_mut(b));
        app.update();
        assert!(!touches(&app, a, b), "{what}");
    }
    // Changes of the mode, and of the limit of listed triangles.
    let (mut app, [a, b]) = two(0.1, 0.9);
    move_to(&mut app, b, 0.95);
    app.update();
    app.settings().max_triangle_pairs = 2;
    app.update();
    let listed = |app: &App| {
        let contact = app.contact(a, b).unwrap();
        (contact.triangles.len(), contact.mode)
    };
    assert_eq!(listed(&app), (2, MorphCollisionMode::All));
    for entity in [a, b] {
        let first = MorphCollider::new(MorphCollisionMode::First).with_tolerance(0.1);
        app.insert(entity, first);
    }
    app.update();
    assert_eq!(listed(&app), (1, MorphCollisionMode::First));
}

#[test]
fn paused_and_running_again_it_is_where_it_was_seen_or_where_it_is() {
    let (mut app, [a, b]) = two(0.1, 0.9);
    let pause = |app: &mut App, paused| app.settings().paused = paused;
    pause(&mut app, true);
    move_to(&mut app, b, 1.2);
    app.update();
    assert!(touches(&app, a, b));
    move_to(&mut app, b, 0.98);
    pause(&mut app, false);
    app.update();
    assert!(touches(&app, a, b) && diagnostics(&app).held_colliders == 1);
    pause(&mut app, true);
    move_to(&mut app, b, 1.2);
    app.update();
    pause(&mut app, false);
    app.update();
    assert!(!touches(&app, a, b) && diagnostics(&app).held_colliders == 0);
}

#[test]
fn an_entity_that_was_disabled_is_compared_again() {
    let (mut app, [a, b]) = two(0.1, 0.9);
    app.insert(b, Disabled);
    app.update();
    assert!(!touches(&app, a, b));
    app.remove::<Disabled>(b);
    move_to(&mut app, b, 0.95);
    app.update();
    assert!(touches(&app, a, b) && diagnostics(&app).held_colliders == 0);
}

#[test]
fn queries_are_about_colliders_as_they_are() {
    use bevy::ecs::system::RunSystemOnce;
    let (mut app, [_, b]) = two(0.1, 2.0);
    for x in [2.05, 2.09, 2.0] {
        move_to(&mut app, b, x);
        app.update();
        let vertices = move |spatial: MorphSpatialQuery| spatial.posed_vertices(b);
        let vertices = app.world_mut().run_system_once(vertices).unwrap().unwrap();
        let least = vertices.iter().map(|p| p.x).fold(f32::INFINITY, f32::min);
        assert!((least - (x - 0.5)).abs() < 1e-6, "{least} at {x}");
    }
}

#[test]
fn a_bad_tolerance_is_logged_and_leaves_the_collider_out() {
    for bad in [f32::NAN, -0.5, f32::INFINITY] {
        crate::log::Errors::collect(|errors| {
            let (mut app, [a, b]) = two(0.1, 0.8);
            app.insert(a, collider(bad));
            app.update();
            app.update();
            let logged = errors.take();
            let message = format!("tolerance is {bad}");
            assert!(logged.len() == 1 && logged[0].contains(&message), "{logged:?}");
            assert!(!touches(&app, a, b));
            app.insert(a, collider(0.1));
            app.update();
            assert!(touches(&app, a, b));
        });
    }
}
