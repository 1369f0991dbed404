//! Hits, picks and anchors on a skinned surface.

use bevy::ecs::message::MessageCursor;
use bevy::ecs::system::RunSystemOnce;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::picking::backend::PointerHits;
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::pointer::PointerId;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;

use super::{add, limb, put, skeleton, spawn_joints, spawn_limb, spawn_skinned};
use crate::log::start;
use crate::support::{Edits, add_mesh, app, assets, cube, settle, spawn};

fn cast(app: &mut App, origin: Vec3, direction: Dir3) -> Option<MorphRayHit> {
    let system = move |spatial: MorphSpatialQuery| {
        spatial.cast_ray(origin, direction, f32::INFINITY, &MorphQueryFilter::default())
    };
    app.world_mut().run_system_once(system).unwrap()
}

#[test]
fn a_hit_names_the_joint_that_moves_it_most() {
    let mut app = app();
    let (limb, joints) = spawn_limb(&mut app, 9.0);
    settle(&mut app);
    // The middle of the stretched side is at 4.5.
    for (x, joint) in [(0.0, 0), (4.25, 0), (4.75, 1), (9.25, 1)] {
        let hit = cast(&mut app, Vec3::new(x, 8.0, 0.1), Dir3::NEG_Y).unwrap();
        assert_eq!((hit.entity, hit.joint), (limb, Some(joints[joint])), "at {x}");
        assert!((hit.point - Vec3::new(x, 0.5, 0.1)).length() < 1e-5, "{hit:?}");
        let all = app
            .world_mut()
            .run_system_once(move |spatial: MorphSpatialQuery| {
                let filter = MorphQueryFilter::default();
                let all = spatial.ray_hits(Vec3::new(x, 8.0, 0.1), Dir3::NEG_Y, 100.0, &filter);
                let closest = spatial.project_point(Vec3::new(x, 0.6, 0.1), 1.0, &filter);
                (all, closest.unwrap())
            })
            .unwrap();
        assert_eq!(all.0.len(), 2);
        assert!(all.0.iter().all(|hit| hit.joint == Some(joints[joint])), "{all:?}");
        assert_eq!(all.1.joint, Some(joints[joint]));
    }
    // Of two joints with the same weight, the first one counts.
    let middle = cast(&mut app, Vec3::new(4.5, 8.0, 0.25), Dir3::NEG_Y).unwrap();
    assert_eq!(middle.joint, Some(joints[0]), "{middle:?}");
}

#[test]
fn other_meshes_have_no_joint() {
    let mut app = app();
    let rigid = add_mesh(&mut app, &cube());
    spawn(&mut app, &rigid, 0.0);
    let boned = add(&mut app, limb());
    spawn(&mut app, &boned, 5.0);
    let (loose, joints) = spawn_limb(&mut app, 0.0);
    let skin = skeleton(&mut app, &joints);
    app.insert(loose, (Mesh3d(rigid), skin, Transform::from_xyz(10.0, 0.0, 0.0)));
    settle(&mut app);
    for x in [0.1, 5.1, 10.1] {
        let hit = cast(&mut app, Vec3::new(x, 8.0, 0.2), Dir3::NEG_Y).unwrap();
        assert_eq!(hit.joint, None, "{hit:?}");
    }
}

#[test]
fn a_pointer_picks_the_skinned_surface_and_names_the_joint() {
    let mut app = headless(&assets());
    app.init_resource::<RayMap>()
        .add_message::<PointerHits>()
        .add_plugins(MorphPickingPlugin);
    start(&mut app);
    let (limb, joints) = spawn_limb(&mut app, 9.0);
    let camera = app.spawn(Camera::default());
    settle(&mut app);
    let mut cursor = MessageCursor::<PointerHits>::default();
    let mut pick = |app: &mut App, x: f32, y: f32| {
        cursor.clear(app.world().resource());
        let ray = Ray3d::new(Vec3::new(x, 8.0, 0.1), Dir3::NEG_Y);
        let id = RayId::new(camera, PointerId::Mouse);
        app.world_mut().resource_mut::<RayMap>().map.insert(id, ray);
        app.update();
        let hits: Vec<PointerHits> = cursor.read(app.world().resource()).cloned().collect();
        let [hits] = hits.as_slice() else {
            assert!(hits.is_empty(), "{hits:?}");
            return None;
        };
        let [(entity, hit)] = hits.picks.as_slice() else {
            panic!("one thing is hit: {hits:?}");
        };
        assert_eq!(*entity, limb);
        assert!((hit.depth - (8.0 - y)).abs() < 1e-5, "{hit:?}");
        assert!(hit.position.unwrap().distance(Vec3::new(x, y, 0.1)) < 1e-5, "{hit:?}");
        hit.extra_as::<MorphPick>().expect("it tells more").joint
    };
    // The middle of the stretched side is at 4.5.
    for (x, joint) in [(0.0, 0), (4.25, 0), (4.75, 1), (9.25, 1)] {
        assert_eq!(pick(&mut app, x, 0.5), Some(joints[joint]), "at {x}");
    }
    // The side slopes from 0.5 at -0.5 to -3.5 at 9.5. There is nothing at the entity's own place.
    put(&mut app, joints[1], Transform::from_xyz(9.0, -4.0, 0.0));
    app.update();
    assert_eq!(pick(&mut app, 9.25, -3.4), Some(joints[1]));
    assert_eq!(pick(&mut app, 100.0, 0.5), None);
}

#[test]
fn anchors_go_with_the_joints_in_the_same_frame() {
    let mut app = app();
    let (limb, joints) = spawn_limb(&mut app, 1.0);
    settle(&mut app);
    let hit = cast(&mut app, Vec3::new(8.0, 0.1, 0.2), Dir3::NEG_X).unwrap();
    assert_eq!(hit.joint, Some(joints[1]));
    let hat = app.spawn(MorphSurfaceAnchor::at(&hit).with_offset(0.25));
    let place = |app: &App, entity: Entity| app.world().get::<GlobalTransform>(entity).unwrap().translation();
    for x in [1.0, 4.0, -2.0] {
        put(&mut app, joints[1], Transform::from_xyz(x, 3.0, 0.0));
        // Its own place does not matter.
        put(&mut app, limb, Transform::from_translation(Vec3::NAN));
        app.update();
        assert!(
            place(&app, hat).distance(Vec3::new(x + 0.75, 3.1, 0.2)) < 1e-5,
            "{}",
            place(&app, hat)
        );
    }
    // If the joints become unusable, it stays.
    put(&mut app, joints[1], Transform::from_translation(Vec3::NAN));
    app.update();
    assert!(
        place(&app, hat).distance(Vec3::new(-1.25, 3.1, 0.2)) < 1e-5,
        "{}",
        place(&app, hat)
    );
}

#[test]
fn an_anchor_on_a_limb_whose_joints_hang_on_another_anchor() {
    let mut app = app();
    let (arm, [_, hand]) = spawn_limb(&mut app, 1.0);
    settle(&mut app);
    let hit = cast(&mut app, Vec3::new(8.0, 0.1, 0.2), Dir3::NEG_X).unwrap();
    assert_eq!(hit.entity, arm);
    let mut anchor = MorphSurfaceAnchor::at(&hit);
    anchor.align = false;
    let grip = app.spawn(anchor);
    // The held mesh has its own joints below the grip.
    let mesh = add(&mut app, limb());
    let held = spawn_joints(&mut app, [Vec3::X, Vec3::X * 2.0]);
    for joint in held {
        app.insert(joint, ChildOf(grip));
    }
    let skin = skeleton(&mut app, &held);
    let stick = spawn_skinned(&mut app, &mesh, skin);
    app.insert(stick, ChildOf(grip));
    settle(&mut app);
    let tip = cast(&mut app, Vec3::new(20.0, 0.1, 0.2), Dir3::NEG_X).unwrap();
    assert_eq!(tip.entity, stick);
    let flag = app.spawn((MorphSurfaceAnchor::at(&tip), ChildOf(stick)));
    app.update();
    let place = |app: &App, entity: Entity| app.world().get::<GlobalTransform>(entity).unwrap().translation();
    let before = place(&app, flag);
    put(&mut app, hand, Transform::from_xyz(3.0, 1.0, 0.0));
    app.update();
    let moved = place(&app, flag) - before;
    assert!(moved.distance(Vec3::new(2.0, 1.0, 0.0)) < 1e-4, "{moved}");
}

#[test]
fn regions_contacts_and_closest_points_are_about_the_skinned_surface() {
    let mut app = app();
    let (limb, _) = spawn_limb(&mut app, 9.0);
    let wall = add_mesh(&mut app, &cube());
    let wall = spawn(&mut app, &wall, 9.25);
    settle(&mut app);
    let far = MorphShape::Cuboid {
        half_extents: Vec3::splat(101.0),
    };
    let asked = move |spatial: MorphSpatialQuery| {
        let filter = MorphQueryFilter::from_excluded_entities([wall]);
        (
            spatial.shape_intersections(
                &MorphShape::Ball { radius: 0.2 },
                Vec3::new(9.0, 0.0, 0.6),
                Quat::IDENTITY,
                &filter,
            ),
            spatial.shape_intersections(&far, Vec3::splat(200.0), Quat::IDENTITY, &filter),
            spatial.contacts(limb, wall).map(|contacts| contacts.pair_count),
            spatial.closest_points(limb, wall, 1.0).map(|closest| closest.distance),
            spatial.bounds(limb),
            spatial.posed_triangle(limb, 0),
        )
    };
    let (ball, far, contacts, closest, bounds, triangle) = app.world_mut().run_system_once(asked).unwrap();
    assert_eq!((ball, far), (vec![limb], vec![]));
    assert!(contacts.unwrap() > 0 && closest == Some(0.0));
    let bounds = bounds.unwrap();
    assert!(bounds.min.distance(Vec3::splat(-0.5)) < 1e-4, "{bounds:?}");
    assert!(bounds.max.distance(Vec3::new(9.5, 0.5, 0.5)) < 1e-4, "{bounds:?}");
    assert!(triangle.unwrap().iter().all(|corner| corner.abs().max_element() < 10.0));
    assert!(app.world().get::<SkinnedMesh>(limb).is_some());
}
