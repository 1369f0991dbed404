//! Debug drawing of skinned meshes.

use bevy::gizmos::GizmoPlugin;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;

use super::{add, boned, put, skeleton, spawn_joints, spawn_skinned};
use crate::drawn::{Drawn, draw, drawn};
use crate::log::start;
use crate::support::{add_mesh, assets, cube, set_weight, settle, spawn, stretching_cube};

/// A stretching cube below one joint, and its joint; nothing is drawn yet.
fn app_with_a_cube() -> (App, Entity, Entity) {
    let mut app = headless(&assets());
    app.add_plugins((GizmoPlugin, MorphGizmosPlugin));
    // One triangle per leaf.
    app.insert_resource(MorphCollisionSettings {
        tree_options: MorphTreeOptions { leaf_size: 1 },
        ..default()
    });
    start(&mut app);
    let mesh = add(&mut app, boned(&stretching_cube(), |_| 0));
    let [joint] = spawn_joints(&mut app, [Vec3::ZERO]);
    let skin = skeleton(&mut app, &[joint]);
    let skinned = spawn_skinned(&mut app, &mesh, skin);
    draw(&mut app, |gizmos| {
        (gizmos.depth, gizmos.triangles, gizmos.contacts) = (None, None, None);
    });
    settle(&mut app);
    (app, skinned, joint)
}

/// Rotated about all axes, and enlarged.
fn turned() -> Transform {
    Transform::from_xyz(3.0, -1.0, 0.5)
        .with_rotation(Quat::from_euler(EulerRot::XYZ, 0.6, -1.1, 0.3))
        .with_scale(Vec3::splat(2.0))
}

#[test]
fn boxes_of_nodes_are_drawn_where_joints_put_them() {
    let (mut app, skinned, joint) = app_with_a_cube();
    for (weight, place) in [
        (0.0, Transform::default()),
        (0.75, turned()),
        (0.75, Transform::from_xyz(0.0, 7.0, 0.0)),
    ] {
        set_weight(&mut app, skinned, weight);
        put(&mut app, joint, place);
        draw(&mut app, |gizmos| gizmos.depth = Some(9));
        // Around each triangle where the joint puts it, along the world's axes.
        let shape = stretching_cube();
        let posed: Vec<Vec3> = shape
            .posed(&[weight])
            .into_iter()
            .map(|p| place.transform_point(p))
            .collect();
        let corners = shape
            .triangles
            .iter()
            .map(|corners| corners.map(|corner| posed[corner as usize]));
        let expected: Vec<[Vec3; 2]> = corners.map(|[a, b, c]| [a.min(b).min(c), a.max(b).max(c)]).collect();
        let Drawn { strips, .. } = drawn(&app);
        assert_eq!(strips.len(), expected.len());
        let boxes: Vec<[Vec3; 2]> = strips
            .iter()
            .map(|strip| {
                let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
                strip.iter().fold(start, |[min, max], &p| [min.min(p), max.max(p)])
            })
            .collect();
        for [min, max] in &expected {
            let is_it = |drawn: &&[Vec3; 2]| drawn[0].distance(*min) < 1e-4 && drawn[1].distance(*max) < 1e-4;
            let same = expected.iter().filter(|other| *other == &[*min, *max]).count();
            assert_eq!(
                boxes.iter().filter(is_it).count(),
                same,
                "{min} to {max} in {boxes:?} at {place:?}"
            );
        }
    }
}

#[test]
fn touching_triangles_are_outlined_where_joints_put_them() {
    let (mut app, skinned, joint) = app_with_a_cube();
    let rigid = add_mesh(&mut app, &cube());
    let rigid = spawn(&mut app, &rigid, 2.5);
    set_weight(&mut app, skinned, 0.25);
    put(&mut app, joint, turned());
    settle(&mut app);
    draw(&mut app, |gizmos| gizmos.triangles = Some(Color::WHITE));
    let contact = app.world().resource::<MorphCollisions>().get(skinned, rigid);
    let contact = contact.expect("they touch").clone();
    assert!(contact.triangles.len() > 4, "{contact:?}");
    let shape = stretching_cube();
    let posed: Vec<Vec3> = shape
        .posed(&[0.25])
        .into_iter()
        .map(|p| turned().transform_point(p))
        .collect();
    let mut expected = Vec::new();
    for pair in &contact.triangles {
        for (collider, triangle) in [
            (contact.collider1, pair.triangle_a),
            (contact.collider2, pair.triangle_b),
        ] {
            let corners = shape.triangles[triangle as usize].map(|corner| corner as usize);
            expected.push(corners.map(|corner| match collider == skinned {
                true => posed[corner],
                false => shape.positions[corner] + Vec3::X * 2.5,
            }));
        }
    }
    let Drawn { strips, .. } = drawn(&app);
    assert_eq!(strips.len(), expected.len());
    for (strip, [a, b, c]) in strips.iter().zip(expected) {
        let is_it = strip.len() == 4
            && strip
                .iter()
                .zip([a, b, c, a])
                .all(|(drawn, corner)| drawn.distance(corner) < 1e-5);
        assert!(is_it, "{strip:?} is not {:?}", [a, b, c]);
    }
}
