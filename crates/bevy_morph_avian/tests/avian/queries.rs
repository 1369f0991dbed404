//! Avian's own queries see a surface in its current shape, exactly once.

use avian3d::prelude::*;
use bevy::prelude::*;
use morph_collision_models::generated::rigid;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{all_below, app, ask, ball_on_sheet, body, is_asleep, place, population, run, set_weights, spawn};

#[test]
fn a_ray_sees_the_surface_once_where_it_is() {
    let (mut app, surface, ball) = ball_on_sheet();
    for i in 1..=20 {
        let height = 0.01 * i as f32;
        set_weights(&mut app, surface, &[height, 0.0]);
        run(&mut app, 1);
        // Through the ball, under which the parts are, and far away from it.
        let hits = all_below(&mut app, 0.1, 0.05);
        let entities: Vec<_> = hits.iter().map(|hit| hit.0).collect();
        assert_eq!(entities, [ball, surface], "{hits:?}");
        assert!((hits[1].1 - height).abs() < 1e-4, "{hits:?}");
        let hits = all_below(&mut app, 3.0, -2.0);
        assert!(
            hits.len() == 1 && hits[0].0 == surface && (hits[0].1 - height).abs() < 1e-4,
            "{hits:?}"
        );
    }
    assert!(population(&mut app).1 > 0, "there are parts, and they are not seen");
}

#[test]
fn shapes_and_points_find_the_surface_once_where_it_is() {
    let (mut app, surface, _) = ball_on_sheet();
    set_weights(&mut app, surface, &[0.2, 0.0]);
    // By then the ball has been pushed out.
    run(&mut app, 60);
    for x in [0.1, 2.0] {
        let (cast, touching, closest) = ask(&mut app, move |query| {
            let shape = Collider::cuboid(0.4, 0.4, 0.4);
            let filter = SpatialQueryFilter::DEFAULT;
            let from = Vec3::new(x, -2.0, 0.0);
            let config = ShapeCastConfig::from_max_distance(100.0);
            let cast = query.shape_hits(&shape, from, Quat::IDENTITY, Dir3::Y, 10, &config, &filter);
            let touching = query.shape_intersections(&shape, Vec3::new(x, 0.1, 0.0), Quat::IDENTITY, &filter);
            (
                cast,
                touching,
                query.project_point(Vec3::new(x, -1.0, 0.0), false, &filter),
            )
        });
        let hits: Vec<_> = cast.iter().filter(|hit| hit.entity == surface).collect();
        assert!(hits.len() == 1 && (hits[0].distance - 2.0).abs() < 1e-3, "{cast:?}");
        assert_eq!(
            touching.iter().filter(|&&entity| entity == surface).count(),
            1,
            "{touching:?}"
        );
        let is_known = |entity: Entity| app.world().get::<bevy_morph_avian::MorphAvianPart>(entity).is_none();
        assert!(
            touching
                .iter()
                .copied()
                .chain(cast.iter().map(|hit| hit.entity))
                .all(is_known)
        );
        let closest = closest.expect("it is there");
        assert!(
            closest.entity == surface && (closest.point.y - 0.2).abs() < 1e-4,
            "{closest:?}"
        );
    }
}

#[test]
fn layers_keep_rays_and_bodies_away() {
    let mut app = app();
    let layers = CollisionLayers::new(LayerMask(0b10), LayerMask(0b10));
    let surface = spawn(&mut app, &sheet(16), layers);
    settle(&mut app);
    let falls = body(&mut app, Collider::sphere(0.3), Vec3::new(0.1, 0.5, 0.05));
    let rests = body(&mut app, Collider::sphere(0.3), Vec3::new(2.0, 0.31, 0.05));
    let both = CollisionLayers::new(LayerMask(0b11), LayerMask(0b11));
    app.world_mut().entity_mut(rests).insert(both);
    run(&mut app, 60);
    assert!(place(&app, falls).y < -1.0, "{}", place(&app, falls));
    assert!((place(&app, rests).y - 0.3).abs() < 1e-2, "{}", place(&app, rests));
    let seen = |app: &mut App, mask: u32| {
        ask(app, move |query| {
            let filter = SpatialQueryFilter::from_mask(LayerMask(mask));
            query
                .cast_ray(Vec3::new(-1.0, 5.0, 0.0), Dir3::NEG_Y, 100.0, true, &filter)
                .map(|hit| hit.entity)
        })
    };
    assert_eq!((seen(&mut app, 1), seen(&mut app, 2)), (None, Some(surface)));
    // Existing parts are updated too.
    app.world_mut()
        .entity_mut(surface)
        .insert(CollisionLayers::new(LayerMask(0b100), LayerMask(0b100)));
    run(&mut app, 60);
    assert!(place(&app, rests).y < -1.0, "{}", place(&app, rests));
}

#[test]
fn friction_and_restitution_are_the_surfaces() {
    let mut app = app();
    let bouncy = Restitution::new(0.8).with_combine_rule(CoefficientCombine::Max);
    let slippery = Friction::new(0.0).with_combine_rule(CoefficientCombine::Min);
    spawn(&mut app, &sheet(16), (bouncy, slippery));
    settle(&mut app);
    let ball = body(&mut app, Collider::sphere(0.3), Vec3::new(0.1, 1.3, 0.05));
    let slides = body(&mut app, Collider::cuboid(0.4, 0.4, 0.4), Vec3::new(-2.0, 0.2, 1.0));
    app.world_mut().entity_mut(slides).insert(LinearVelocity(Vec3::X));
    let mut highest: f32 = 0.0;
    for i in 0..75 {
        run(&mut app, 1);
        if i > 35 {
            highest = highest.max(place(&app, ball).y);
        }
    }
    // 0.8 of the speed is 0.64 of the height.
    assert!((0.8..1.1).contains(&highest), "{highest}");
    let speed = app.world().get::<LinearVelocity>(slides).unwrap().x;
    assert!((speed - 1.0).abs() < 0.02, "{speed}");
}

#[test]
fn a_mesh_on_a_dynamic_body_is_its_shape() {
    let mut app = app();
    let ground = (
        RigidBody::Static,
        Collider::cuboid(10.0, 1.0, 10.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    );
    app.world_mut().spawn(ground);
    let mut cube = rigid::box_mesh(Vec3::splat(0.5));
    cube.targets = vec![cube.positions.iter().map(|p| Vec3::Y * p.y).collect()];
    // It does not fall before it has a shape.
    let body = (
        RigidBody::Dynamic,
        GravityScale(0.0),
        Transform::from_xyz(0.0, 0.6, 0.0),
    );
    let jelly = spawn(&mut app, &cube, body);
    settle(&mut app);
    app.world_mut().entity_mut(jelly).insert(GravityScale(1.0));
    let mass = app.world().get::<ComputedMass>(jelly).unwrap().value();
    assert!((mass - 1.0).abs() < 1e-3, "{mass}");
    run(&mut app, 150);
    assert!((place(&app, jelly).y - 0.5).abs() < 1e-2, "{}", place(&app, jelly));
    assert!(is_asleep(&app, jelly));
    // It grows and is pushed out of the ground.
    for i in 1..=60 {
        set_weights(&mut app, jelly, &[i as f32 / 60.0]);
        run(&mut app, 1);
    }
    run(&mut app, 30);
    assert!((place(&app, jelly).y - 1.0).abs() < 2e-2, "{}", place(&app, jelly));
}
