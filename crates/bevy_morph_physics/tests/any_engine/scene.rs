//! Whole scenes in physics.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_physics::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::physics::{bevy_mesh, settle, sheet};

use crate::support::{app, ball, body, diagnostics, place, population, run};

/// A deforming mesh below an entity.
pub(crate) fn part(app: &mut App, parent: Entity, name: &'static str, mesh: &MorphMesh, at: Vec3) -> Entity {
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy_mesh(mesh));
    let weights = MeshMorphWeights::Value {
        weights: vec![0.0; mesh.targets.len()],
    };
    let place = Transform::from_translation(at);
    app.world_mut()
        .spawn((Mesh3d(handle), weights, Name::new(name), place, ChildOf(parent)))
        .id()
}

/// Whether a ball that falls there is stopped.
fn holds(app: &mut App, at: Vec3) -> bool {
    let ball = body(app, ball(0.3), at + Vec3::Y * 0.5);
    run(app, 60);
    let held = (place(app, ball).y - at.y - 0.3).abs() < 1e-2;
    app.world_mut().entity_mut(ball).despawn();
    run(app, 2);
    held
}

fn limits(app: &mut App) -> Vec<f32> {
    let mut colliders = app.world_mut().query::<&MorphPhysicsCollider>();
    let mut limits: Vec<f32> = colliders.iter(app.world()).map(|c| c.max_acceleration).collect();
    limits.sort_by(f32::total_cmp);
    limits
}

#[test]
fn one_component_brings_a_whole_scene_into_physics_and_takes_it_out() {
    let mut app = app();
    let root = app
        .world_mut()
        .spawn((MorphPhysicsScene::default(), Transform::default()))
        .id();
    let [left, right] = [Vec3::X * -10.0, Vec3::X * 10.0];
    part(&mut app, root, "left", &sheet(8), left);
    settle(&mut app);
    // A later part, below its own entity.
    let arm = app
        .world_mut()
        .spawn((Transform::from_translation(right), Visibility::default(), ChildOf(root)))
        .id();
    let late = part(&mut app, arm, "right", &sheet(8), Vec3::ZERO);
    settle(&mut app);
    run(&mut app, 3);
    assert_eq!(diagnostics(&app).surfaces, 2);
    assert!(holds(&mut app, left) && holds(&mut app, right));
    // Only physics looks at them.
    let mode = app.world().get::<MorphCollider>(late).unwrap().mode;
    assert_eq!(mode, MorphCollisionMode::Passive);

    // Editing the scene updates everything that was not changed by hand.
    app.world_mut()
        .get_mut::<MorphPhysicsCollider>(late)
        .unwrap()
        .max_acceleration = 5.0;
    let edited = MorphPhysicsCollider {
        max_acceleration: 50.0,
        ..default()
    };
    app.world_mut().get_mut::<MorphPhysicsScene>(root).unwrap().collider = edited;
    run(&mut app, 2);
    assert_eq!(limits(&mut app), [5.0, 50.0]);

    app.world_mut().entity_mut(root).remove::<MorphPhysicsScene>();
    run(&mut app, 3);
    assert_eq!(diagnostics(&app).surfaces, 0);
    assert_eq!(population(&mut app), (0, 0));
    assert!(!holds(&mut app, left));
    let mut colliders = app.world_mut().query::<&MorphCollider>();
    assert_eq!(
        colliders.iter(app.world()).count(),
        2,
        "they are parts of the scene still"
    );
    // Inserts the scene again.
    app.world_mut().entity_mut(root).insert(MorphPhysicsScene::default());
    run(&mut app, 3);
    assert_eq!(limits(&mut app), [100.0, 100.0]);
    assert!(holds(&mut app, right));
}

#[test]
fn names_choose_the_parts_and_colliders_of_the_games_own_stay() {
    let mut app = app();
    let scene = MorphColliderScene {
        only_named: vec!["ground".into()],
        ..default()
    };
    let root = app
        .world_mut()
        .spawn((scene, MorphPhysicsScene::default(), Transform::default()))
        .id();
    let ground = part(&mut app, root, "ground", &sheet(8), Vec3::ZERO);
    let grass = part(&mut app, root, "grass", &sheet(8), Vec3::X * 20.0);
    let own = MorphPhysicsCollider {
        max_acceleration: 1.0,
        ..default()
    };
    let own_part = part(&mut app, root, "own", &sheet(8), Vec3::X * 40.0);
    app.world_mut().entity_mut(own_part).insert(own);
    settle(&mut app);
    run(&mut app, 3);
    let has = |app: &App, entity| app.world().get::<MorphPhysicsCollider>(entity).copied();
    assert_eq!(has(&app, ground), Some(MorphPhysicsCollider::default()));
    assert_eq!((has(&app, grass), has(&app, own_part)), (None, Some(own)));
    assert!(holds(&mut app, Vec3::ZERO) && !holds(&mut app, Vec3::X * 20.0) && holds(&mut app, Vec3::X * 40.0));

    app.world_mut().entity_mut(ground).insert(Name::new("sand"));
    run(&mut app, 3);
    assert_eq!(has(&app, ground), None);
    app.world_mut()
        .get_mut::<MorphColliderScene>(root)
        .unwrap()
        .only_named
        .push("grass".into());
    run(&mut app, 3);
    assert_eq!(has(&app, grass), Some(MorphPhysicsCollider::default()));
    app.world_mut().entity_mut(root).remove::<MorphPhysicsScene>();
    run(&mut app, 3);
    assert_eq!((has(&app, grass), has(&app, own_part)), (None, Some(own)));
}
