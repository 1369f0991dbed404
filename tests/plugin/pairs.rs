//! Which pairs are compared: layers, modes, margins, pauses; and the cost of a run in which nothing changes.

use bevy::ecs::entity_disabling::Disabled;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::random::random_blob;

use crate::support::{
    Edits, Messages, add_mesh, app, cube, diagnostics, move_to, settle, spawn, stretching_cube, touches, two_cubes,
};

#[test]
fn layers_decide_who_is_compared() {
    let (mut app, [a, b]) = two_cubes(0.8);
    assert!(touches(&app, a, b));
    app.insert(a, MorphCollisionLayers::new(0b01, 0b10));
    app.insert(b, MorphCollisionLayers::new(0b01, 0b11));
    app.update();
    let run = diagnostics(&app);
    assert!(!touches(&app, a, b));
    assert_eq!(
        (run.overlapping_pairs, run.skipped_layers, run.candidate_pairs),
        (1, 1, 0)
    );
    app.insert(b, MorphCollisionLayers::new(0b10, 0b11));
    app.update();
    assert!(touches(&app, a, b));
}

#[test]
fn two_passive_colliders_are_never_compared_and_one_is_when_the_other_asks() {
    let (mut app, [a, b]) = two_cubes(0.8);
    for cube in [a, b] {
        app.insert(cube, MorphCollider::new(MorphCollisionMode::Passive));
    }
    app.update();
    assert!(!touches(&app, a, b));
    assert_eq!(diagnostics(&app).skipped_passive, 1);
    app.insert(b, MorphCollider::new(MorphCollisionMode::First));
    app.update();
    assert!(touches(&app, a, b));
}

#[test]
fn a_disabled_collider_is_left_out_and_comes_back() {
    let (mut app, [a, b]) = two_cubes(0.8);
    let mut messages = Messages::default();
    messages.read(&app);
    app.insert(a, MorphColliderDisabled);
    app.update();
    assert!(!touches(&app, a, b));
    assert_eq!(messages.read(&app).1.len(), 1);
    app.remove::<MorphColliderDisabled>(a);
    app.update();
    assert_eq!(messages.read(&app).0.len(), 1);
    assert!(touches(&app, a, b));
}

#[test]
fn a_disabled_entity_is_left_out_and_comes_back_where_it_was() {
    let (mut app, [a, b]) = two_cubes(0.8);
    app.insert(a, Disabled);
    app.update();
    assert!(!touches(&app, a, b));
    app.update();
    app.remove::<Disabled>(a);
    app.update();
    assert!(
        touches(&app, a, b),
        "nothing moved meanwhile, and still they are compared"
    );
}

#[test]
fn a_collider_that_gets_another_parent_goes_with_it_in_the_same_frame() {
    let (mut app, [a, b]) = two_cubes(0.8);
    let far = app.spawn(Transform::from_xyz(9.0, 0.0, 0.0));
    app.update();
    app.insert(b, ChildOf(far));
    app.update();
    assert!(!touches(&app, a, b));
    app.remove::<ChildOf>(b);
    app.update();
    assert!(touches(&app, a, b));
}

#[test]
fn within_their_margins_colliders_count_as_touching() {
    let (mut app, [a, b]) = two_cubes(1.25);
    assert!(!touches(&app, a, b));
    let collider = |margin| MorphCollider::default().with_margin(margin);
    app.insert(a, collider(0.2));
    app.update();
    assert!(!touches(&app, a, b), "0.25 apart");
    app.insert(b, collider(0.125));
    app.update();
    let contact = app.contact(a, b).unwrap();
    assert!(
        (contact.distance - 0.25).abs() < 1e-6 && contact.triangles.is_empty(),
        "{contact:?}"
    );
    assert!((contact.point.x - 0.625).abs() < 1e-6, "{contact:?}");
    let away = if contact.collider1 == a { -1.0 } else { 1.0 };
    assert!(contact.normal.distance(Vec3::X * away) < 1e-6, "{contact:?}");

    move_to(&mut app, b, 0.9);
    app.update();
    let contact = app.contact(a, b).unwrap();
    assert!(contact.distance == 0.0 && !contact.triangles.is_empty(), "{contact:?}");
}

#[test]
fn a_bad_margin_is_logged_and_leaves_the_collider_out() {
    crate::log::Errors::collect(|errors| {
        let (mut app, [a, b]) = two_cubes(0.8);
        app.insert(a, MorphCollider::default().with_margin(f32::NAN));
        app.update();
        app.update();
        let logged = errors.take();
        assert!(logged.len() == 1 && logged[0].contains("margin is NaN"), "{logged:?}");
        assert!(!touches(&app, a, b));
    });
}

#[test]
fn contacts_have_points_with_depths_the_deepest_first() {
    let (mut app, [a, b]) = two_cubes(0.9);
    app.insert(a, MorphCollider::new(MorphCollisionMode::Contacts));
    app.update();
    let contact = app.contact(a, b).unwrap();
    assert!((1..=4).contains(&contact.points.len()), "{contact:?}");
    assert!(contact.points.is_sorted_by(|x, y| x.depth >= y.depth), "{contact:?}");
    assert_eq!(contact.point, contact.points[0].point);
    for point in &contact.points {
        assert!((0.399..=0.5).contains(&point.point.x), "{contact:?}");
        assert!(contact.triangles.contains(&point.triangles));
    }
}

#[test]
fn paused_nothing_is_looked_at_and_contacts_stay() {
    let (mut app, [a, b]) = two_cubes(0.8);
    let mut messages = Messages::default();
    messages.read(&app);
    app.settings().paused = true;
    move_to(&mut app, b, 5.0);
    app.update();
    assert!(touches(&app, a, b));
    assert_eq!(messages.read(&app), (vec![], vec![]));
    app.settings().paused = false;
    app.update();
    assert!(!touches(&app, a, b));
    assert_eq!(messages.read(&app).1.len(), 1);
}

#[test]
fn every_deforming_mesh_can_be_made_a_collider() {
    let mut app = app();
    let (morphing, rigid) = (add_mesh(&mut app, &stretching_cube()), add_mesh(&mut app, &cube()));
    let root = app.spawn((Transform::default(), MorphBodyRoot));
    let weights = || MeshMorphWeights::Value { weights: vec![0.0] };
    let mut part = |mesh: &Handle<Mesh>| app.spawn((Mesh3d(mesh.clone()), weights(), ChildOf(root)));
    let parts = [part(&morphing), part(&morphing)];
    app.spawn(Mesh3d(rigid));
    app.update();
    assert_eq!(diagnostics(&app).colliders, 0);

    let collider = MorphCollider::new(MorphCollisionMode::First);
    app.settings().every_deforming_mesh = Some(collider);
    settle(&mut app);
    for part in parts {
        assert_eq!(app.world().get::<MorphCollider>(part), Some(&collider));
        assert_eq!(app.world().get(part), Some(&MorphColliderOf { body: root }));
    }
    let run = diagnostics(&app);
    assert_eq!((run.colliders, run.skipped_same_body, run.touching_pairs), (2, 1, 0));

    let late = app.spawn((Mesh3d(morphing), weights()));
    settle(&mut app);
    assert!(app.world().get::<MorphCollider>(late).is_some());
    assert_eq!(diagnostics(&app).touching_pairs, 2);
}

#[test]
fn a_run_in_which_nothing_changes_compares_nothing() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let cubes = [0.0, 0.5, 1.0, 9.0].map(|x| spawn(&mut app, &mesh, x));
    settle(&mut app);
    app.update();
    let run = diagnostics(&app);
    assert_eq!(
        (run.candidate_pairs, run.skipped_unchanged, run.touching_pairs),
        (3, 3, 3)
    );
    assert_eq!(run.stats, default());

    // The distant one does not matter.
    move_to(&mut app, cubes[3], 8.0);
    app.update();
    let run = diagnostics(&app);
    assert_eq!((run.candidate_pairs, run.skipped_unchanged), (3, 3));
    move_to(&mut app, cubes[2], 1.25);
    app.update();
    let run = diagnostics(&app);
    assert_eq!(
        (run.candidate_pairs, run.skipped_unchanged, run.touching_pairs),
        (2, 1, 2)
    );
    assert!(run.stats.triangle_tests > 0);
}

#[test]
fn colliders_can_have_trees_of_their_own() {
    let (mut app, [a, b]) = two_cubes(0.8);
    let settings = MorphTreeOptions { leaf_size: 2 };
    app.insert(a, settings);
    settle(&mut app);
    assert!(touches(&app, a, b), "trees with different leaves");
    let trees = app.world().resource::<MorphTrees>();
    assert_eq!(trees.iter().count(), 2);
    let mesh = app.world().get::<Mesh3d>(a).unwrap().id();
    let own = trees.with_options(mesh, Some(settings)).unwrap();
    assert!(own.node_count() > trees.get(mesh).unwrap().node_count());

    app.insert(a, MorphTreeOptions { leaf_size: 0 });
    crate::log::Errors::collect(|errors| {
        settle(&mut app);
        let logged = errors.take();
        assert!(logged.len() == 1 && logged[0].contains("leaf_size is 0"), "{logged:?}");
    });
    assert!(!touches(&app, a, b), "there is no such tree");
    app.remove::<MorphTreeOptions>(a);
    settle(&mut app);
    assert!(touches(&app, a, b));
}

#[test]
fn a_scene_may_name_its_parts() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let scene = MorphColliderScene {
        only_deforming: false,
        only_named: vec!["hull".into(), "sail".into()],
        layers: MorphCollisionLayers::new(2, 4),
        ..default()
    };
    let root = app.spawn((scene, Name::new("mast")));
    let mut part = |name: &str, parent| {
        let part = (Name::new(name.to_string()), Mesh3d(mesh.clone()), ChildOf(parent));
        app.spawn(part)
    };
    let hull = part("hull", root);
    let plank = part("plank", hull);
    let mast = part("mast", root);
    app.update();
    let is_collider = |part| app.world().get::<MorphCollider>(part).is_some();
    assert_eq!([hull, plank, mast].map(is_collider), [true, true, false]);
    assert_eq!(
        app.world().get::<MorphCollisionLayers>(plank),
        Some(&MorphCollisionLayers::new(2, 4))
    );
}

#[test]
fn a_lasting_contact_is_found_where_it_was_found_before() {
    // A bumpy body drifts into another, stays in it for a while, and leaves it.
    let run = |mode| {
        let mut app = app();
        let mesh = add_mesh(&mut app, &random_blob(3, 3, 2, 1.0));
        let [a, b] = [0.0, 9.0].map(|x| spawn(&mut app, &mesh, x));
        for entity in [a, b] {
            app.insert(entity, MorphCollider::new(mode));
        }
        settle(&mut app);
        let frame = |frame: u8| {
            move_to(&mut app, b, 1.9 + 0.4 * (f32::from(frame) * 0.06).cos());
            app.update();
            let contact = app.contact(a, b);
            (contact, diagnostics(&app).stats.node_tests)
        };
        (0..100).map(frame).collect::<Vec<_>>()
    };
    let all = run(MorphCollisionMode::All);
    for mode in [MorphCollisionMode::First] {
        let (mut lasting, mut without_a_walk, mut untouched) = (0, 0, 0);
        let mut age = 0;
        for ((found, node_tests), (expected, _)) in run(mode).into_iter().zip(&all) {
            assert_eq!(found.is_some(), expected.is_some());
            let Some((found, expected)) = found.zip(expected.as_ref()) else {
                (age, untouched) = (0, untouched + 1);
                continue;
            };
            assert!(found.triangles.iter().all(|pair| expected.triangles.contains(pair)));
            age += 1;
            if age <= 2 {
                assert!(node_tests > 0, "in run {age} nothing is known yet");
            } else {
                lasting += 1;
                without_a_walk += usize::from(node_tests == 0);
            }
        }
        assert!(lasting > 20 && untouched > 20, "{lasting} lasting, {untouched} apart");
        assert!(
            without_a_walk * 2 > lasting,
            "{without_a_walk} of {lasting} without a walk"
        );
    }
}

#[test]
fn a_collider_that_was_made_disabled_takes_part_once_it_is_enabled() {
    let (mut app, [a, _]) = two_cubes(5.0);
    let mesh = app.world().get::<Mesh3d>(a).unwrap().0.clone();
    let pooled = spawn(&mut app, &mesh, 0.5);
    app.insert(pooled, Disabled);
    for _ in 0..4 {
        app.update();
    }
    assert!(!touches(&app, a, pooled));
    app.remove::<Disabled>(pooled);
    app.update();
    assert!(touches(&app, a, pooled));

    // The mesh is swapped while the entity is disabled.
    let mut small = cube();
    small.positions.iter_mut().for_each(|p| *p *= 0.1);
    let small = add_mesh(&mut app, &small);
    app.insert(pooled, Disabled);
    app.update();
    app.insert(pooled, Mesh3d(small));
    move_to(&mut app, pooled, 0.6);
    for _ in 0..4 {
        app.update();
    }
    app.remove::<Disabled>(pooled);
    settle(&mut app);
    assert!(!touches(&app, a, pooled), "it ends at 0.55");
}

#[test]
fn a_mesh_that_goes_during_a_pause_is_missed_afterwards() {
    let (mut app, [a, b]) = two_cubes(0.8);
    app.settings().paused = true;
    app.update();
    app.remove::<Mesh3d>(b);
    for _ in 0..5 {
        app.update();
    }
    app.settings().paused = false;
    app.update();
    assert!(!touches(&app, a, b));
    assert_eq!(diagnostics(&app).colliders, 1);
}
