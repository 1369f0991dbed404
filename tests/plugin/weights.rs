//! Morph weights, and what becomes of bad ones.

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::log::{Errors, run_here};
use crate::support::{add_mesh, app, cube, set_weight, settle, spawn, stretching_cube, touches};

/// A stretching cube at 0, and a rigid one that it reaches with weight 1 but not at rest.
fn cubes_apart() -> (App, [Entity; 2]) {
    let mut app = app();
    let (morphing, rigid) = (add_mesh(&mut app, &stretching_cube()), add_mesh(&mut app, &cube()));
    let cubes = [spawn(&mut app, &morphing, 0.0), spawn(&mut app, &rigid, 1.75)];
    app.world_mut().entity_mut(cubes[0]).insert(Name::new("stretchy"));
    settle(&mut app);
    (app, cubes)
}

#[test]
fn a_morph_alone_makes_two_colliders_touch_and_part() {
    let (mut app, [a, b]) = cubes_apart();
    assert!(!touches(&app, a, b));
    for (weight, expected) in [(1.0, true), (0.5, false), (0.75, true), (-1.0, false), (3.0, true)] {
        set_weight(&mut app, a, weight);
        app.update();
        assert_eq!(touches(&app, a, b), expected, "weight {weight}");
    }
    app.world_mut().entity_mut(a).remove::<MeshMorphWeights>();
    app.update();
    assert!(!touches(&app, a, b), "without weights a mesh is at rest");
}

#[test]
fn weights_by_reference_are_followed() {
    let (mut app, [a, b]) = cubes_apart();
    let weights = MorphWeights::new(vec![0.0], None).expect("one weight is not too many");
    let source = app.world_mut().spawn(weights).id();
    app.world_mut()
        .entity_mut(a)
        .insert(MeshMorphWeights::Reference(source));
    app.update();
    assert!(!touches(&app, a, b));
    for (weight, expected) in [(1.0, true), (0.0, false)] {
        if let Some(mut weights) = app.world_mut().get_mut::<MorphWeights>(source) {
            weights.weights_mut()[0] = weight;
        }
        app.update();
        assert_eq!(touches(&app, a, b), expected);
    }
}

#[test]
fn bad_weights_are_logged_once_and_the_last_good_ones_stay() {
    Errors::collect(|errors| {
        let (mut app, [a, b]) = cubes_apart();
        run_here(&mut app);
        set_weight(&mut app, a, 1.0);
        app.update();
        let nobody = app.world_mut().spawn_empty().id();
        let bad = [
            (MeshMorphWeights::Value { weights: vec![0.0; 2] }, "2 weights"),
            (MeshMorphWeights::Value { weights: vec![] }, "0 weights"),
            (
                MeshMorphWeights::Value {
                    weights: vec![f32::NAN],
                },
                "NaN",
            ),
            (MeshMorphWeights::Reference(nobody), "no MorphWeights"),
        ];
        for (weights, reason) in bad {
            app.world_mut().entity_mut(a).insert(weights);
            app.update();
            app.update();
            let logged = errors.take();
            assert_eq!(logged.len(), 1, "{logged:?}");
            assert!(
                logged[0].contains(reason) && logged[0].contains("stretchy"),
                "{logged:?}"
            );
            assert!(touches(&app, a, b), "weight 1 is still in force");
            set_weight(&mut app, a, 1.0);
            app.update();
        }
        assert_eq!(errors.take(), [""; 0]);
    });
}

#[test]
fn weights_on_a_mesh_without_targets_mean_nothing() {
    Errors::collect(|errors| {
        let (mut app, [_, b]) = cubes_apart();
        run_here(&mut app);
        set_weight(&mut app, b, 1.0);
        app.update();
        assert_eq!(errors.take(), [""; 0]);
    });
}

#[test]
fn primitives_under_one_node_share_its_weights() {
    let (mut app, [a, b]) = cubes_apart();
    let weights = MorphWeights::new(vec![0.0], None).expect("one weight is not too many");
    let node = app.world_mut().spawn((weights, Transform::default())).id();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let other = spawn(&mut app, &mesh, 0.0);
    for primitive in [a, other] {
        let shared = (MeshMorphWeights::Reference(node), ChildOf(node), MorphBody(node));
        app.world_mut().entity_mut(primitive).insert(shared);
    }
    settle(&mut app);
    assert!(!touches(&app, a, b) && !touches(&app, other, b));
    if let Some(mut weights) = app.world_mut().get_mut::<MorphWeights>(node) {
        weights.weights_mut()[0] = 1.0;
    }
    app.update();
    assert!(touches(&app, a, b) && touches(&app, other, b));
    assert!(!touches(&app, a, other), "they are one body");
}
