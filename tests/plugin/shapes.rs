//! Rigid primitive shapes against morphing meshes.

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;

use crate::support::{Edits, add_mesh, app, cube, diagnostics, set_weight, settle, spawn, stretching_cube, touches};

fn spawn_shape(app: &mut App, shape: MorphShape, place: Transform) -> Entity {
    app.spawn((shape, place))
}

#[test]
fn a_morph_reaches_a_ball_and_lets_go_of_it() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let cube = spawn(&mut app, &mesh, 0.0);
    let ball = spawn_shape(
        &mut app,
        MorphShape::Ball { radius: 0.5 },
        Transform::from_xyz(1.75, 0.0, 0.0),
    );
    settle(&mut app);
    assert!(!touches(&app, cube, ball));
    set_weight(&mut app, cube, 1.0);
    app.update();
    let contact = app.contact(cube, ball).unwrap();
    // The face is at x = 1.5; the ball starts at 1.25.
    assert!(
        contact.normal.x.abs() > 0.99 && contact.point.yz().length() < 0.6,
        "{contact:?}"
    );
    let of_cube = if contact.collider1 == cube { -1.0 } else { 1.0 };
    assert!(contact.normal.x * of_cube > 0.0, "{contact:?}");
    assert!(!contact.triangles.is_empty(), "{contact:?}");
    for pair in &contact.triangles {
        let (mesh, shape) = if contact.collider1 == cube {
            (pair.triangle_a, pair.triangle_b)
        } else {
            (pair.triangle_b, pair.triangle_a)
        };
        assert!(mesh < 12 && shape == MorphContact::NO_TRIANGLE);
    }
    set_weight(&mut app, cube, 0.5);
    app.update();
    assert!(!touches(&app, cube, ball));
}

#[test]
fn every_shape_stands_where_its_transform_says() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let cube = spawn(&mut app, &mesh, 0.0);
    let shapes = [
        (
            MorphShape::Ball { radius: 0.5 },
            Transform::from_xyz(0.0, 0.95, 0.0),
            Transform::from_xyz(0.0, 1.05, 0.0),
        ),
        (
            MorphShape::Capsule {
                half_length: 1.0,
                radius: 0.25,
            },
            // Once lying and once standing.
            Transform::from_xyz(0.0, 0.7, 0.0).with_rotation(Quat::from_rotation_z(1.57)),
            Transform::from_xyz(0.0, 1.8, 0.0),
        ),
        (
            MorphShape::Cuboid {
                half_extents: Vec3::splat(0.5),
            },
            Transform::from_xyz(1.9, 0.0, 0.0).with_scale(Vec3::new(3.0, 0.1, 0.1)),
            Transform::from_xyz(1.1, 0.0, 0.0),
        ),
        (
            MorphShape::from(Cylinder::new(0.25, 2.0)),
            // Once lying and once standing.
            Transform::from_xyz(0.0, 0.7, 0.0).with_rotation(Quat::from_rotation_z(1.57)),
            Transform::from_xyz(0.8, 0.0, 0.0),
        ),
        (
            MorphShape::from(Cone::new(0.5, 2.0)),
            // Once with the tip in the cube, and once with the base above it.
            Transform::from_xyz(0.0, 1.45, 0.0).with_rotation(Quat::from_rotation_z(std::f32::consts::PI)),
            Transform::from_xyz(0.0, 1.55, 0.0),
        ),
        (
            MorphShape::from(ConicalFrustum {
                radius_top: 1.0,
                radius_bottom: 0.1,
                height: 1.0,
            }),
            Transform::from_xyz(1.0, 0.0, 0.0),
            Transform::from_xyz(1.2, -1.1, 0.0),
        ),
        (
            MorphShape::RoundCuboid {
                half_extents: Vec3::splat(0.25),
                border_radius: 0.25,
            },
            Transform::from_xyz(0.95, 0.0, 0.0),
            Transform::from_xyz(0.95, 0.95, 0.0),
        ),
        (
            MorphShape::from(
                MorphConvexHull::new(&[
                    Vec3::ZERO,
                    Vec3::new(2.0, 0.1, 0.0),
                    Vec3::new(2.0, 0.0, 0.1),
                    Vec3::X * 3.0,
                ])
                .unwrap(),
            ),
            Transform::from_xyz(0.45, 0.0, 0.0),
            Transform::from_xyz(0.55, 0.0, 0.0),
        ),
        (
            MorphShape::from(MorphConvexHull::of_mesh(&Sphere::new(0.5).into()).unwrap()),
            Transform::from_xyz(0.95, 0.0, 0.0),
            Transform::from_xyz(0.9, 0.9, 0.0),
        ),
        (
            MorphShape::HalfSpace { normal: Vec3::Y },
            Transform::from_xyz(100.0, -0.45, -50.0),
            Transform::from_xyz(0.0, -0.55, 0.0),
        ),
    ];
    for (shape, near, far) in shapes {
        let entity = spawn_shape(&mut app, shape.clone(), near);
        settle(&mut app);
        assert!(touches(&app, cube, entity), "{shape:?} at {near:?}");
        app.insert(entity, far);
        app.update();
        assert!(!touches(&app, cube, entity), "{shape:?} at {far:?}");
        app.world_mut().despawn(entity);
    }
}

#[test]
fn contacts_with_shapes_have_points_and_margins() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let cube = spawn(&mut app, &mesh, 0.0);
    let floor = spawn_shape(
        &mut app,
        MorphShape::HalfSpace { normal: Vec3::Y },
        Transform::from_xyz(0.0, -0.4, 0.0),
    );
    app.insert(floor, MorphCollider::new(MorphCollisionMode::Contacts));
    settle(&mut app);
    let contact = app.contact(cube, floor).unwrap();
    assert!((contact.points[0].depth - 0.1).abs() < 1e-6, "{contact:?}");
    let up = if contact.collider1 == cube {
        Vec3::Y
    } else {
        Vec3::NEG_Y
    };
    assert!(contact.normal.distance(up) < 1e-6, "{contact:?}");

    let low = Transform::from_xyz(0.0, -0.7, 0.0);
    app.insert(floor, (low, MorphCollider::default().with_margin(0.25)));
    app.update();
    let contact = app.contact(cube, floor).unwrap();
    assert!(
        (contact.distance - 0.2).abs() < 1e-6 && contact.triangles.is_empty(),
        "{contact:?}"
    );
}

#[test]
fn two_shapes_are_left_to_physics() {
    let mut app = app();
    for _ in 0..2 {
        spawn_shape(&mut app, MorphShape::Ball { radius: 1.0 }, Transform::default());
    }
    app.update();
    let run = diagnostics(&app);
    assert_eq!((run.colliders, run.skipped_rigid, run.touching_pairs), (2, 1, 0));
}

#[test]
fn a_bad_shape_is_logged_with_its_name() {
    crate::log::Errors::collect(|errors| {
        let mut app = app();
        let ball = spawn_shape(&mut app, MorphShape::Ball { radius: -1.0 }, Transform::default());
        app.insert(ball, Name::new("bubble"));
        app.update();
        app.update();
        let logged = errors.take();
        assert!(
            logged.len() == 1 && logged[0].contains("bubble") && logged[0].contains("radius"),
            "{logged:?}"
        );
    });
}

/// A crumb inside a cube at 0 that touches none of its triangles but is inside a ball there, and one that is on the
/// cube's corner but not in the ball.
fn crumbs(app: &mut App) -> [Entity; 2] {
    let crumb = add_mesh(app, &rigid::box_mesh(Vec3::splat(0.05)));
    let inside = spawn(app, &crumb, 0.1);
    let corner = spawn(app, &crumb, 0.0);
    let place = Transform::from_translation(Vec3::splat(0.5));
    app.insert(corner, place);
    settle(app);
    [inside, corner]
}

const BALL: MorphShape = MorphShape::Ball { radius: 0.4 };

fn is_ball(app: &App, both: Entity, [inside, corner]: [Entity; 2]) -> bool {
    let met = [inside, corner].map(|crumb| touches(app, both, crumb));
    assert!(met == [true, false] || met == [false, true], "{met:?}");
    met[0]
}

#[test]
fn a_shape_beside_a_mesh_wins_from_the_first_frame_on() {
    let mut app = app();
    let crumbs = crumbs(&mut app);
    let mesh = add_mesh(&mut app, &cube());
    let both = app.spawn((Mesh3d(mesh.clone()), BALL));
    for frame in 0..5 {
        app.update();
        assert!(is_ball(&app, both, crumbs), "frame {frame}");
        let trees = app.world().resource::<MorphTrees>();
        assert!(trees.get(mesh.id()).is_none() && trees.building() == 0);
    }
    // It also wins if the mesh's tree exists because of another entity.
    spawn(&mut app, &mesh, 100.0);
    settle(&mut app);
    assert!(app.world().resource::<MorphTrees>().get(mesh.id()).is_some());
    assert!(is_ball(&app, both, crumbs));
}

#[test]
fn a_shape_that_comes_or_goes_takes_over_at_once() {
    let mut app = app();
    let crumbs = crumbs(&mut app);
    let mesh = add_mesh(&mut app, &cube());
    let both = spawn(&mut app, &mesh, 0.0);
    settle(&mut app);
    assert!(!is_ball(&app, both, crumbs));
    let seen = |app: &mut App| {
        let cast = move |spatial: MorphSpatialQuery| {
            let filter = MorphQueryFilter::from_excluded_entities(crumbs);
            let hit = spatial.cast_ray(Vec3::new(0.1, 9.0, 0.2), Dir3::NEG_Y, 100.0, &filter);
            hit.expect("either is there").triangle != MorphContact::NO_TRIANGLE
        };
        app.world_mut().run_system_once(cast).unwrap()
    };
    for _ in 0..2 {
        app.insert(both, BALL);
        app.update();
        assert!(is_ball(&app, both, crumbs) && !seen(&mut app));
        app.remove::<MorphShape>(both);
        app.update();
        assert!(!is_ball(&app, both, crumbs) && seen(&mut app));
    }
}
