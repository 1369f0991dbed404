//! Debug drawing: the lines that reach Bevy's gizmos.

use std::any::TypeId;

use bevy::gizmos::config::GizmoConfigStore;
use bevy::gizmos::{GizmoAsset, GizmoHandles, GizmoPlugin};
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::morph_collision::Pose;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;

use crate::log::start;
use crate::support::{Edits, add_mesh, assets, diagnostics, set_weight, settle, spawn, stretching_cube};

/// The place of the second cube.
const APART: f32 = 0.8;

/// Two stretching cubes that touch, with contacts; nothing is drawn yet.
fn two_drawn_cubes() -> (App, [Entity; 2]) {
    let mut app = headless(&assets());
    app.add_plugins((GizmoPlugin, MorphGizmosPlugin));
    // Small leaves, so that there are nodes below the root's children.
    app.insert_resource(MorphCollisionSettings {
        tree_options: MorphTreeOptions { leaf_size: 1 },
        ..default()
    });
    start(&mut app);
    let mesh = add_mesh(&mut app, &stretching_cube());
    let cubes = [0.0, APART].map(|x| spawn(&mut app, &mesh, x));
    for cube in cubes {
        let contacts = MorphCollider::new(MorphCollisionMode::Contacts);
        app.insert(cube, contacts);
    }
    draw(&mut app, |gizmos| {
        (gizmos.depth, gizmos.triangles, gizmos.contacts) = (None, None, None);
    });
    settle(&mut app);
    (app, cubes)
}

/// Changes what is drawn and runs a frame.
pub(crate) fn draw(app: &mut App, change: impl FnOnce(&mut MorphGizmos)) {
    let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
    change(store.config_mut::<MorphGizmos>().1);
    app.update();
}

/// The gizmos of the last frame: lines, strips of lines, and the distinct colours of both.
#[derive(Default, Debug)]
pub(crate) struct Drawn {
    pub(crate) lines: Vec<[Vec3; 2]>,
    pub(crate) strips: Vec<Vec<Vec3>>,
    pub(crate) colors: Vec<LinearRgba>,
}

pub(crate) fn drawn(app: &App) -> Drawn {
    let handles = app.world().resource::<GizmoHandles>().handles();
    let Some(Some(handle)) = handles.get(&TypeId::of::<MorphGizmos>()) else {
        return Drawn::default();
    };
    let asset = app.world().resource::<Assets<GizmoAsset>>().get(handle);
    let buffer = asset.expect("what is drawn is an asset").buffer().buffer();
    let lines = buffer.list_positions.chunks_exact(2).map(|line| [line[0], line[1]]);
    // Strips end with a NaN point.
    let strips = buffer.strip_positions.split(|point| point.is_nan());
    let strips = strips.filter(|strip| !strip.is_empty());
    let mut colors: Vec<LinearRgba> = Vec::new();
    for color in buffer.list_colors.iter().chain(buffer.strip_colors) {
        if !color.red.is_nan() && !colors.contains(color) {
            colors.push(*color);
        }
    }
    Drawn {
        lines: lines.collect(),
        strips: strips.map(<[Vec3]>::to_vec).collect(),
        colors,
    }
}

fn contact(app: &App, [a, b]: [Entity; 2]) -> MorphContact {
    let contact = app.world().resource::<MorphCollisions>().get(a, b);
    contact.expect("they touch").clone()
}

fn near(a: Vec3, b: Vec3) -> bool {
    a.distance(b) < 1e-5
}

#[test]
fn nothing_is_drawn_that_is_not_asked_for() {
    let (mut app, cubes) = two_drawn_cubes();
    contact(&app, cubes);
    let Drawn { lines, strips, .. } = drawn(&app);
    assert!(lines.is_empty() && strips.is_empty());
    let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
    store.config_mut::<MorphGizmos>().0.enabled = false;
    draw(&mut app, |gizmos| gizmos.depth = Some(3));
    assert!(drawn(&app).strips.is_empty());
}

#[test]
fn touching_triangles_are_outlined_where_they_are() {
    let (mut app, cubes) = two_drawn_cubes();
    let red = Color::srgb(0.9, 0.0, 0.0);
    draw(&mut app, |gizmos| gizmos.triangles = Some(red));
    // Once more at other weights: the outlines follow the morph.
    for weight in [0.0, 0.25] {
        set_weight(&mut app, cubes[0], weight);
        app.update();
        let contact = contact(&app, cubes);
        let shape = stretching_cube();
        let corners = |cube: Entity, triangle: u32| {
            let (weight, x) = if cube == cubes[0] { (weight, 0.0) } else { (0.0, APART) };
            let posed = shape.posed(&[weight]);
            shape.triangles[triangle as usize].map(|corner| posed[corner as usize] + x * Vec3::X)
        };
        let mut expected = Vec::new();
        for pair in &contact.triangles {
            expected.push(corners(contact.collider1, pair.triangle_a));
            expected.push(corners(contact.collider2, pair.triangle_b));
        }
        let Drawn { lines, strips, colors } = drawn(&app);
        assert!(lines.is_empty() && expected.len() > 4);
        assert_eq!(strips.len(), expected.len());
        for (strip, [a, b, c]) in strips.iter().zip(expected) {
            let same = strip
                .iter()
                .zip([a, b, c, a])
                .all(|(&drawn, corner)| near(drawn, corner));
            assert!(strip.len() == 4 && same, "{strip:?} is not {:?}", [a, b, c]);
        }
        assert_eq!(colors, [LinearRgba::from(red)]);
    }
}

#[test]
fn points_of_contact_have_arrows_along_the_normal() {
    let (mut app, cubes) = two_drawn_cubes();
    let yellow = Color::srgb(1.0, 1.0, 0.0);
    draw(&mut app, |gizmos| {
        (gizmos.contacts, gizmos.normal_length) = (Some(yellow), 0.5);
    });
    let contact = contact(&app, cubes);
    let points: Vec<Vec3> = contact.points.iter().map(|point| point.point).collect();
    assert!(points.len() > 1 && points[0] == contact.point && contact.normal != Vec3::ZERO);
    let Drawn { lines, strips, colors } = drawn(&app);
    assert!(strips.is_empty());
    // Bevy's arrow is one line and four lines for its tip.
    assert_eq!(lines.len(), 5 * points.len());
    for (arrow, point) in lines.chunks_exact(5).zip(points) {
        let tip = point + 0.5 * contact.normal;
        assert!(
            near(arrow[0][0], point) && near(arrow[0][1], tip),
            "{arrow:?} at {point}"
        );
        assert!(arrow[1..].iter().all(|line| near(line[0], tip)));
    }
    assert_eq!(colors, [LinearRgba::from(yellow)]);
}

#[test]
fn the_nodes_of_a_depth_are_boxes_in_the_colour_of_their_state() {
    let (mut app, cubes) = two_drawn_cubes();
    let [refitted, resting] = [Color::srgb(1.0, 0.0, 0.0), Color::srgb(0.0, 0.0, 1.0)];
    let mesh = app.world().get::<Mesh3d>(cubes[0]).unwrap().id();
    let tree = app.world().resource::<MorphTrees>().get(mesh).unwrap().clone();
    // Far from the other cube, only the root and the root's children are refitted.
    crate::support::move_to(&mut app, cubes[1], 50.0);
    for (depth, weight) in [(0, 0.0), (0, 1.5), (1, 0.5), (9, 0.75)] {
        set_weight(&mut app, cubes[0], weight);
        draw(&mut app, |gizmos| {
            (gizmos.depth, gizmos.refitted, gizmos.resting) = (Some(depth), refitted, resting);
        });
        let mut expected = Vec::new();
        for (weight, x) in [(weight, 0.0), (0.0, 50.0)] {
            let mut pose = Pose::new(tree.clone());
            pose.set_weights(&[weight]).unwrap();
            pose.visit_nodes(|node| {
                if node.depth == depth || node.is_leaf {
                    expected.push([node.bounds.min, node.bounds.max].map(|p| p + x * Vec3::X));
                }
                node.depth < depth
            });
        }
        let Drawn { lines, strips, colors } = drawn(&app);
        // Bevy's cube is a strip around two sides and three lines between them.
        assert_eq!((strips.len(), lines.len()), (expected.len(), 3 * expected.len()));
        let mut boxes: Vec<[Vec3; 2]> = Vec::new();
        for strip in &strips {
            assert_eq!(strip.len(), 10);
            let of = |pick: fn(Vec3, Vec3) -> Vec3| strip.iter().copied().reduce(pick).unwrap();
            boxes.push([of(Vec3::min), of(Vec3::max)]);
        }
        for [min, max] in expected {
            let found = boxes.iter().any(|drawn| near(drawn[0], min) && near(drawn[1], max));
            assert!(found, "{min}..{max} is not among {boxes:?} at depth {depth}");
        }
        // The broad phase refits roots and their children. Only the drawing refits the nodes below.
        let expected = if depth <= 1 { refitted } else { resting };
        assert!(colors.contains(&expected.into()), "{colors:?} at depth {depth}");
        assert!(depth > 1 || colors.len() == 1, "{colors:?} at depth {depth}");
    }
}

#[test]
fn drawing_changes_no_answer_and_costs_nothing_where_nothing_is_drawn() {
    let (mut app, cubes) = two_drawn_cubes();
    let before = contact(&app, cubes);
    for depth in [Some(0), Some(1), Some(9), None] {
        draw(&mut app, |gizmos| gizmos.depth = depth);
        assert_eq!(contact(&app, cubes), before);
        assert_eq!(diagnostics(&app).stats, default());
        assert_eq!(drawn(&app).strips.is_empty(), depth.is_none());
    }
}

#[test]
fn nothing_is_drawn_where_nobody_would_free_it() {
    let mut app = headless(&assets());
    app.add_plugins(MorphGizmosPlugin);
    start(&mut app);
    let mesh = add_mesh(&mut app, &stretching_cube());
    let cubes = [0.0, APART].map(|x| spawn(&mut app, &mesh, x));
    settle(&mut app);
    app.update();
    assert!(app.contact(cubes[0], cubes[1]).is_some());
    assert_eq!(app.world().resource::<Assets<GizmoAsset>>().len(), 0);
}
