//! Colliders that move little, far, slowly or in steps.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::collider;
use crate::support::{
    Edits, Messages, add_mesh, app, cube, diagnostics, move_to, set_weight, settle, spawn, stretching_cube, touches,
};

/// Two cubes with this tolerance, which may or may not touch.
pub(super) fn two(tolerance: f32, x: f32) -> (App, [Entity; 2]) {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let cubes = [spawn(&mut app, &mesh, 0.0), spawn(&mut app, &mesh, x)];
    for entity in cubes {
        app.insert(entity, collider(tolerance));
    }
    settle(&mut app);
    (app, cubes)
}

#[test]
fn slow_drift_does_not_add_up() {
    let (mut app, [a, b]) = two(0.05, 0.8);
    let mut messages = Messages::default();
    messages.read(&app);
    let (mut compared, mut parted) = (0, None);
    for step in 1..=400 {
        let x = 0.8 + 0.001 * step as f32;
        move_to(&mut app, b, x);
        app.update();
        let diagnostics = diagnostics(&app);
        compared += diagnostics.candidate_pairs - diagnostics.skipped_unchanged;
        let (_, ends) = messages.read(&app);
        assert_eq!(touches(&app, a, b), parted.is_none() && ends.is_empty());
        if !ends.is_empty() {
            assert!(parted.is_none());
            parted = Some(x);
        }
    }
    let parted = parted.unwrap();
    assert!((1.0..1.0 + 0.052).contains(&parted), "{parted}");
    // Once for each time that it has moved as far as its tolerance.
    assert!((3..=8).contains(&compared), "{compared}");
}

#[test]
fn small_movements_cost_no_comparison_and_large_ones_count_at_once() {
    let (mut app, [a, b]) = two(0.1, 1.02);
    assert!(!touches(&app, a, b));
    // Near enough to touch, but by less than the tolerance.
    move_to(&mut app, b, 0.95);
    app.update();
    let kept = diagnostics(&app);
    assert_eq!((kept.held_colliders, kept.stats.triangle_tests), (1, 0));
    assert!(!touches(&app, a, b));
    move_to(&mut app, b, 0.9);
    app.update();
    assert!(touches(&app, a, b) && diagnostics(&app).held_colliders == 0);
    // Back to the place where the motion was ignored, and then away.
    move_to(&mut app, b, 0.95);
    app.update();
    assert!(touches(&app, a, b) && diagnostics(&app).held_colliders == 1);
    move_to(&mut app, b, 9.0);
    app.update();
    assert!(!touches(&app, a, b) && diagnostics(&app).held_colliders == 0);
}

#[test]
fn a_pair_that_is_new_is_about_the_same_moment_as_the_others() {
    let (mut app, [_, b]) = two(0.1, 0.8);
    move_to(&mut app, b, 0.75);
    app.update();
    let mesh = add_mesh(&mut app, &cube());
    // It reaches the cube's current place, but not the place where collisions see the cube.
    let new = spawn(&mut app, &mesh, -0.27);
    let newer = spawn(&mut app, &mesh, 1.77);
    settle(&mut app);
    assert_eq!(diagnostics(&app).held_colliders, 1);
    assert!(!touches(&app, b, new) && touches(&app, b, newer));
}

#[test]
fn morph_weights_are_measured() {
    let mut app = app();
    let [still, stretching] = [cube(), stretching_cube()].map(|mesh| add_mesh(&mut app, &mesh));
    let wall = spawn(&mut app, &still, 1.5);
    let stretching = spawn(&mut app, &stretching, 0.0);
    app.insert(stretching, collider(0.1));
    set_weight(&mut app, stretching, 0.45);
    settle(&mut app);
    assert!(!touches(&app, wall, stretching));
    for (weight, is_touching, is_behind) in [(0.54, false, 1), (0.56, true, 0), (0.47, true, 1), (0.45, false, 0)] {
        set_weight(&mut app, stretching, weight);
        app.update();
        assert_eq!(touches(&app, wall, stretching), is_touching, "at {weight}");
        assert_eq!(diagnostics(&app).held_colliders, is_behind, "at {weight}");
    }
}

#[test]
fn shapes_are_measured() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let wall = spawn(&mut app, &mesh, 0.0);
    for shape in [
        MorphShape::Ball { radius: 0.5 },
        MorphShape::Capsule {
            half_length: 1.0,
            radius: 0.5,
        },
        MorphShape::Cuboid {
            half_extents: Vec3::splat(0.5),
        },
        MorphShape::HalfSpace { normal: Vec3::X },
    ] {
        // The half-space is everything below it.
        let edge = if matches!(shape, MorphShape::HalfSpace { .. }) {
            0.5
        } else {
            0.0
        };
        let at = |x: f32| if edge > 0.0 { -x + edge } else { x };
        let place = Transform::from_xyz(at(1.03), 0.0, 0.0);
        let other = app.spawn((shape.clone(), place, collider(0.1)));
        settle(&mut app);
        assert!(!touches(&app, wall, other), "{shape:?}");
        for (x, is_touching, is_behind) in [(0.95, false, 1), (0.9, true, 0), (0.99, true, 1), (1.03, false, 0)] {
            move_to(&mut app, other, at(x));
            app.update();
            assert_eq!(touches(&app, wall, other), is_touching, "{shape:?} at {x}");
            assert_eq!(diagnostics(&app).held_colliders, is_behind, "{shape:?} at {x}");
        }
        app.world_mut().despawn(other);
    }
}
