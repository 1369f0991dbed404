//! Casters, compared with single queries.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::{any, ask, three};
use crate::log::{Errors, start};
use crate::support::Edits;

fn ray_hits(app: &App, caster: Entity) -> Vec<MorphRayHit> {
    app.world()
        .get::<MorphRayHits>(caster)
        .expect("it is required")
        .to_vec()
}

fn shape_hits(app: &App, caster: Entity) -> Vec<MorphShapeHit> {
    app.world()
        .get::<MorphShapeHits>(caster)
        .expect("it is required")
        .to_vec()
}

/// Low-discrepancy places around the cubes, turned and scaled.
fn place(number: usize) -> Transform {
    let share = |stride: f64| (2.0 * (number as f64 * stride).fract() - 1.0) as f32;
    let [x, y, z] = [0.819_173, 0.671_044, 0.549_7].map(share);
    Transform::from_xyz(3.0 + 5.0 * x, 1.5 * y, 1.5 * z)
        .with_rotation(Quat::from_euler(EulerRot::XYZ, 7.0 * y, 5.0 * z, 3.0 * x))
        .with_scale(Vec3::new(1.0 + z.abs(), 0.5, 2.0))
}

#[test]
fn casters_hit_what_single_queries_hit() {
    let (mut app, [_, b, _]) = three();
    app.spawn((MorphShape::Ball { radius: 0.7 }, Transform::from_xyz(1.5, 0.0, 0.0)));
    // So many that they are spread over threads.
    let casters: Vec<Entity> = (0..1200)
        .map(|number| {
            let origin = Vec3::new(0.1, -0.2, 0.3);
            let filter = any().with_excluded_entities((number % 5 == 0).then_some(b));
            let ray = MorphRayCaster::new(origin, Dir3::NEG_Z)
                .with_max_hits(number % 4)
                .with_max_distance(4.0)
                .with_filter(filter.clone());
            let shape = MorphShape::Cuboid {
                half_extents: Vec3::new(0.3, 0.1, 0.2),
            };
            let shape = MorphShapeCaster::new(shape, origin, Dir3::NEG_Z)
                .with_rotation(Quat::from_rotation_y(1.0))
                .with_max_hits(number % 4)
                .with_max_distance(4.0)
                .with_filter(filter);
            app.world_mut().spawn((ray, shape, place(number))).id()
        })
        .collect();
    app.update();
    let (mut met, mut touched) = (0, 0);
    for caster in casters {
        let world = app.world();
        let (ray, shape) = (
            world.get::<MorphRayCaster>(caster),
            world.get::<MorphShapeCaster>(caster),
        );
        let (ray, shape) = (ray.unwrap().clone(), shape.unwrap().clone());
        let place = *world.get::<GlobalTransform>(caster).unwrap();
        let (hits, touches) = ask(&mut app, move |s| {
            let origin = place.transform_point(ray.origin);
            let direction = Dir3::new(place.rotation() * *ray.direction).unwrap();
            let mut hits = match ray.max_hits {
                1 => Vec::from_iter(s.cast_ray(origin, direction, 4.0, &ray.filter)),
                _ => s.ray_hits(origin, direction, 4.0, &ray.filter),
            };
            hits.truncate(ray.max_hits);
            // Each collider alone, then the nearest ones.
            let rotation = place.rotation() * shape.rotation;
            let mut touches = Vec::new();
            while touches.len() < shape.max_hits {
                let known: Vec<Entity> = touches.iter().map(|hit: &MorphShapeHit| hit.entity).collect();
                let others = shape.filter.clone().with_excluded_entities(known);
                match s.cast_shape(&shape.shape, origin, rotation, direction, 4.0, &others) {
                    Some(hit) => touches.push(hit),
                    None => break,
                }
            }
            (hits, touches)
        });
        // Casters turn their directions in `f64`.
        let (found, also_found) = (ray_hits(&app, caster), shape_hits(&app, caster));
        assert_eq!((found.len(), also_found.len()), (hits.len(), touches.len()));
        for (found, hit) in found.iter().zip(&hits) {
            assert_eq!((found.entity, found.triangle), (hit.entity, hit.triangle));
            let off = found.point.distance(hit.point) + found.normal.distance(hit.normal);
            assert!((found.distance - hit.distance).abs() + off < 1e-5, "{found:?} {hit:?}");
        }
        for (found, touch) in also_found.iter().zip(&touches) {
            assert_eq!(found.entity, touch.entity);
            assert!((found.distance - touch.distance).abs() < 1e-5, "{found:?} {touch:?}");
        }
        met += hits.len();
        touched += touches.len();
    }
    assert!(met > 100 && touched > 100, "{met} hits, {touched} touches");
}

#[test]
fn hits_change_only_when_they_differ() {
    let (mut app, [a, ..]) = three();
    let caster = app.spawn((
        Transform::from_xyz(-5.0, 0.1, 0.2),
        MorphRayCaster::new(Vec3::ZERO, Dir3::X),
        MorphShapeCaster::new(MorphShape::Ball { radius: 0.1 }, Vec3::ZERO, Dir3::X),
    ));
    app.update();
    assert_eq!(ray_hits(&app, caster)[0].entity, a);
    assert_eq!(shape_hits(&app, caster)[0].entity, a);
    let changed = |app: &App| {
        let entity = app.world().entity(caster);
        let (rays, shapes) = (entity.get_ref::<MorphRayHits>(), entity.get_ref::<MorphShapeHits>());
        (rays.unwrap().last_changed(), shapes.unwrap().last_changed())
    };
    let since = changed(&app);
    app.update();
    assert_eq!(changed(&app), since);
    app.world_mut().get_mut::<MorphRayCaster>(caster).unwrap().enabled = false;
    app.world_mut().get_mut::<MorphShapeCaster>(caster).unwrap().enabled = false;
    app.update();
    assert_eq!((ray_hits(&app, caster), shape_hits(&app, caster)), (vec![], vec![]));
    let now = changed(&app);
    assert!(now.0 != since.0 && now.1 != since.1);
}

#[test]
fn a_caster_ignores_the_body_that_it_is_on() {
    let (mut app, [a, b, _]) = three();
    let body = app.spawn(());
    for collider in [a, b] {
        app.world_mut().entity_mut(collider).insert(MorphColliderOf { body });
    }
    // On a child of a collider, on one of the body, and on nothing.
    for (parent, others) in [(Some(a), 1), (Some(body), 1), (None, 3)] {
        let ray = MorphRayCaster::new(Vec3::ZERO, Dir3::X).with_max_hits(100);
        let caster = app.spawn((Transform::from_xyz(-5.0, 0.1, 0.2), ray));
        app.world_mut().entity_mut(body).insert(Transform::default());
        if let Some(parent) = parent {
            let between = app.spawn((Transform::default(), ChildOf(parent)));
            app.world_mut().entity_mut(caster).insert(ChildOf(between));
        }
        app.update();
        let met = |app: &App| {
            let mut met: Vec<Entity> = ray_hits(app, caster).iter().map(|hit| hit.entity).collect();
            met.dedup();
            met.len()
        };
        assert_eq!(met(&app), others);
        app.world_mut().get_mut::<MorphRayCaster>(caster).unwrap().ignore_self = false;
        app.update();
        assert_eq!(met(&app), 3);
    }
}

#[test]
fn hits_stay_while_collision_is_paused() {
    let (mut app, _) = three();
    let caster = app.spawn((
        Transform::from_xyz(-5.0, 0.1, 0.2),
        MorphRayCaster::new(Vec3::ZERO, Dir3::X),
    ));
    app.update();
    let before = ray_hits(&app, caster);
    assert_eq!(before.len(), 1);
    app.settings().paused = true;
    app.world_mut().get_mut::<Transform>(caster).unwrap().translation.y = 100.0;
    app.update();
    assert_eq!(ray_hits(&app, caster), before);
    app.settings().paused = false;
    app.update();
    assert_eq!(ray_hits(&app, caster), []);
}

#[test]
fn bad_casters_hit_nothing_and_are_named_once() {
    Errors::collect(|log| {
        let (mut app, _) = three();
        start(&mut app);
        let ray = MorphRayCaster::new(Vec3::ZERO, Dir3::X);
        let ball = MorphShape::Ball { radius: f32::NAN };
        let casters = [
            app.spawn((Name::new("eye"), ray.clone().with_max_distance(-1.0))),
            app.spawn((Name::new("nose"), ray, Transform::from_scale(Vec3::ZERO))),
            app.spawn((Name::new("foot"), MorphShapeCaster::new(ball, Vec3::ZERO, Dir3::X))),
        ];
        app.update();
        app.update();
        assert!(ray_hits(&app, casters[0]).is_empty() && ray_hits(&app, casters[1]).is_empty());
        assert!(shape_hits(&app, casters[2]).is_empty());
        let mut warnings = log.take_warnings();
        warnings.sort();
        let expected = [
            "the `MorphRayCaster` of entity `eye` hits nothing: max_distance is -1, it must be 0 or more",
            "the `MorphRayCaster` of entity `nose` hits nothing: its GlobalTransform has no rotation: a scale is 0 or a number is not finite",
            "the `MorphShapeCaster` of entity `foot` hits nothing: ",
        ];
        assert_eq!(warnings.len(), 3, "{warnings:?}");
        for (warning, expected) in warnings.iter().zip(expected) {
            assert!(warning.starts_with(expected), "{warning}");
        }
    });
}
