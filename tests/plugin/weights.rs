//! Morph weights, and how bad ones are handled.

use bevy::ecs::system::RunSystemOnce;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::mesh::MorphMesh;

use crate::log::Errors;
use crate::support::{
    Edits, add_mesh, app, bevy_mesh, cube, move_to, set_weight, settle, spawn, stretching_cube, touches,
};

/// A stretching cube at 0, and a rigid one that it reaches with weight 1 but not at rest.
fn cubes_apart() -> (App, [Entity; 2]) {
    let mut app = app();
    let (morphing, rigid) = (add_mesh(&mut app, &stretching_cube()), add_mesh(&mut app, &cube()));
    let cubes = [spawn(&mut app, &morphing, 0.0), spawn(&mut app, &rigid, 1.75)];
    app.insert(cubes[0], Name::new("stretchy"));
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
    app.remove::<MeshMorphWeights>(a);
    app.update();
    assert!(!touches(&app, a, b), "without weights a mesh is at rest");
}

#[test]
fn weights_by_reference_are_followed() {
    let (mut app, [a, b]) = cubes_apart();
    let weights = MorphWeights::new(vec![0.0], None).expect("one weight is not too many");
    let source = app.spawn(weights);
    app.insert(a, MeshMorphWeights::Reference(source));
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
            app.insert(a, weights);
            // A wrong number of weights may be corrected soon.
            for _ in 0..30 {
                app.update();
            }
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

/// The stretching cube with a second target, which stretches it to the other side.
fn stretching_both_ways() -> MorphMesh {
    let mut mesh = stretching_cube();
    let stretch = |p: &Vec3| if p.x < 0.0 { Vec3::NEG_X } else { Vec3::ZERO };
    mesh.targets.push(mesh.positions.iter().map(stretch).collect());
    mesh.target_names.push("back".into());
    mesh
}

/// The lowest and highest x of a collider's vertices.
fn reach(app: &mut App, entity: Entity) -> (f32, f32) {
    let posed = move |spatial: MorphSpatialQuery| spatial.posed_vertices(entity);
    let posed = app.world_mut().run_system_once(posed).unwrap().unwrap();
    let x = |p: &Vec3| p.x;
    (
        posed.iter().map(x).fold(f32::INFINITY, f32::min),
        posed.iter().map(x).fold(f32::NEG_INFINITY, f32::max),
    )
}

#[test]
fn targets_and_weights_may_change_one_after_the_other() {
    Errors::collect(|errors| {
        for case in 0..16 {
            let (in_place, mesh_first, gap) = (case % 2 == 0, case / 2 % 2 == 0, [0, 1, 3, 6][case / 4]);
            let (mut app, [a, _]) = cubes_apart();
            set_weight(&mut app, a, 1.0);
            app.update();
            let change_mesh = |app: &mut App| {
                let id = app.world().get::<Mesh3d>(a).unwrap().id();
                if in_place {
                    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
                    meshes.insert(id, bevy_mesh(&stretching_both_ways())).unwrap();
                } else {
                    let mesh = add_mesh(app, &stretching_both_ways());
                    app.insert(a, Mesh3d(mesh));
                }
            };
            let change_weights = |app: &mut App| {
                let weights = MeshMorphWeights::Value {
                    weights: vec![0.5, 2.0],
                };
                app.insert(a, weights);
            };
            if mesh_first {
                change_mesh(&mut app);
            } else {
                change_weights(&mut app);
            }
            for _ in 0..gap {
                app.update();
            }
            if mesh_first {
                change_weights(&mut app);
            } else {
                change_mesh(&mut app);
            }
            settle(&mut app);
            for _ in 0..30 {
                app.update();
            }
            let what = format!("in place: {in_place}, mesh first: {mesh_first}, {gap} frames between");
            assert_eq!(errors.take(), [""; 0], "{what}");
            let (min, max) = reach(&mut app, a);
            assert!(
                (min + 2.5).abs() < 1e-3 && (max - 1.0).abs() < 1e-3,
                "{what}: {min} to {max}"
            );
        }
    });
}

#[test]
fn a_wrong_number_of_weights_that_stays_is_logged_once() {
    Errors::collect(|errors| {
        let (mut app, [a, _]) = cubes_apart();
        for change in [0, 1] {
            if change == 0 {
                let weights = MeshMorphWeights::Value { weights: vec![0.0; 2] };
                app.insert(a, weights);
            } else {
                set_weight(&mut app, a, 0.0);
                app.update();
                let mesh = add_mesh(&mut app, &stretching_both_ways());
                app.insert(a, Mesh3d(mesh));
                settle(&mut app);
            }
            for _ in 0..60 {
                app.update();
            }
            let logged = errors.take();
            assert_eq!(logged.len(), 1, "{logged:?}");
            assert!(
                logged[0].contains("stretchy") && logged[0].contains("weights were given"),
                "{logged:?}"
            );
        }
    });
}

#[test]
fn weights_on_a_mesh_without_targets_mean_nothing() {
    Errors::collect(|errors| {
        let (mut app, [a, b]) = cubes_apart();
        set_weight(&mut app, b, 1.0);
        for _ in 0..30 {
            app.update();
        }
        assert_eq!(errors.take(), [""; 0]);
        assert!(!touches(&app, a, b));
        move_to(&mut app, b, 0.9);
        app.update();
        assert!(touches(&app, a, b), "it still collides");
    });
}

#[test]
fn primitives_under_one_node_share_its_weights() {
    let (mut app, [a, b]) = cubes_apart();
    let weights = MorphWeights::new(vec![0.0], None).expect("one weight is not too many");
    let node = app.spawn((weights, Transform::default()));
    let mesh = add_mesh(&mut app, &stretching_cube());
    let other = spawn(&mut app, &mesh, 0.0);
    for primitive in [a, other] {
        let shared = (
            MeshMorphWeights::Reference(node),
            ChildOf(node),
            MorphColliderOf { body: node },
        );
        app.insert(primitive, shared);
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
