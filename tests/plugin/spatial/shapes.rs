//! Meshes and primitive shapes together, checked by distance formulas.

use bevy::math::Vec3A;
use bevy::prelude::*;
use bevy::shape::Aabb3d;
use bevy_morph_collision::prelude::*;

use super::{any, ask, three};
use crate::support::{Edits, add_mesh, app, settle, spawn, stretching_cube};

/// A stretching cube and shapes of every kind, at scattered places.
pub(super) fn crowd(count: u32) -> (App, Vec<(Entity, Transform, Option<MorphShape>)>) {
    let mut app = app();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let kinds = [
        None,
        Some(MorphShape::Ball { radius: 0.6 }),
        Some(MorphShape::Capsule {
            half_length: 0.5,
            radius: 0.3,
        }),
        Some(MorphShape::Cuboid {
            half_extents: Vec3::new(0.3, 0.7, 0.5),
        }),
        Some(MorphShape::RoundCuboid {
            half_extents: Vec3::new(0.3, 0.1, 0.4),
            border_radius: 0.2,
        }),
        Some(MorphShape::from(Cylinder::new(0.4, 1.2))),
        Some(MorphShape::from(Cone::new(0.5, 1.0))),
    ];
    let mut all = Vec::new();
    for i in 0..count {
        let x = i as f32;
        let at = Vec3::new((x * 0.7).sin(), (x * 1.3).cos(), (x * 2.1).sin()) * 6.0;
        let turn = Quat::from_euler(EulerRot::XYZ, x, 0.5 * x, 0.2 * x);
        let place = Transform::from_translation(at).with_rotation(turn);
        let shape = kinds[i as usize % kinds.len()].clone();
        let entity = match shape.clone() {
            Some(shape) => app.spawn((shape, place)),
            None => {
                let entity = spawn(&mut app, &mesh, 0.0);
                app.insert(entity, place);
                entity
            }
        };
        all.push((entity, place, shape));
    }
    settle(&mut app);
    (app, all)
}

/// The signed distance of a point from a placed collider; for a cube, the distance from its surface.
fn distance(point: Vec3, place: &Transform, shape: &Option<MorphShape>) -> f32 {
    let local = place.rotation.inverse() * (point - place.translation);
    let of_box = |half: Vec3| {
        let beyond = local.abs() - half;
        beyond.max(Vec3::ZERO).length() + beyond.max_element().min(0.0)
    };
    match *shape {
        None => of_box(Vec3::splat(0.5)).abs(),
        Some(MorphShape::Ball { radius }) => local.length() - radius,
        Some(MorphShape::Capsule { half_length, radius }) => {
            (local - Vec3::Y * local.y.clamp(-half_length, half_length)).length() - radius
        }
        Some(MorphShape::Cuboid { half_extents }) => of_box(half_extents),
        Some(MorphShape::RoundCuboid {
            half_extents,
            border_radius,
        }) => of_box(half_extents) - border_radius,
        Some(MorphShape::Cylinder { half_height, radius }) => {
            let beyond = Vec2::new(local.xz().length() - radius, local.y.abs() - half_height);
            beyond.max(Vec2::ZERO).length() + beyond.max_element().min(0.0)
        }
        Some(MorphShape::Cone { half_height, radius }) => {
            let (p, tip) = (Vec2::new(local.xz().length(), local.y), Vec2::new(0.0, half_height));
            let side = Vec2::new(2.0 * half_height, radius).normalize();
            let (beside, below) = (side.dot(p - tip), -half_height - p.y);
            let nearest_on = |from: Vec2, to: Vec2| {
                let t = (p - from).dot(to - from) / (to - from).length_squared();
                p.distance(from.lerp(to, t.clamp(0.0, 1.0)))
            };
            let rim = Vec2::new(radius, -half_height);
            if beside <= 0.0 && below <= 0.0 {
                beside.max(below)
            } else {
                nearest_on(rim, tip).min(nearest_on(rim, Vec2::new(0.0, -half_height)))
            }
        }
        Some(MorphShape::ConicalFrustum { .. } | MorphShape::ConvexHull(_) | MorphShape::HalfSpace { .. }) => {
            unreachable!("none is spawned")
        }
    }
}

#[test]
fn shapes_are_found_like_meshes() {
    let (mut app, all) = crowd(60);
    let placed: Vec<Entity> = all.iter().map(|(entity, ..)| *entity).collect();
    let (mut hits, mut inside, mut casts) = ([0, 0], 0, [0, 0]);
    for i in 0..150_u32 {
        let x = i as f32;
        let from = Vec3::new((x * 1.9).cos(), (x * 0.3).sin(), (x * 0.77).cos()) * 7.0;
        // Near the middle of a collider, rarely inside it.
        let to = all[i as usize * 7 % all.len()].1.translation
            + Vec3::new((x * 0.9).sin(), (x * 1.1).cos(), (x * 1.7).sin()) * 0.6;
        let direction = Dir3::new(to - from).unwrap();
        let is_shape = |entity: Entity| all.iter().any(|one| one.0 == entity && one.2.is_some());
        let nearest = |point: Vec3| -> (f32, Entity) {
            let each = all
                .iter()
                .map(|(entity, place, shape)| (distance(point, place, shape), *entity));
            each.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
        };

        let hit = ask(&mut app, move |s| s.cast_ray(from, direction, 30.0, &any()));
        let free = hit.map_or(30.0, |hit| hit.distance);
        for step in 0..300 {
            let distance = free * step as f32 / 300.0;
            assert!(
                nearest(from + direction * distance).0 > 0.0 || free == 0.0,
                "ray {i} at {distance}"
            );
        }
        if let Some(hit) = hit {
            hits[usize::from(is_shape(hit.entity))] += 1;
            let (_, place, shape) = all.iter().find(|one| one.0 == hit.entity).unwrap();
            if hit.distance > 0.0 {
                assert!(distance(hit.point, place, shape).abs() < 1e-4, "{hit:?}");
                assert!((hit.point - from - direction * hit.distance).length() < 1e-4);
                let out = distance(hit.point + 0.01 * hit.normal, place, shape);
                assert!((out - 0.01).abs() < 1e-3, "{out} {hit:?}");
            } else {
                assert!(
                    distance(from, place, shape) <= 0.0 && hit.normal == Vec3::ZERO,
                    "{hit:?}"
                );
            }
        }

        let projected = ask(&mut app, move |s| s.project_point(from, f32::INFINITY, &any())).unwrap();
        let (expected, _) = nearest(from);
        assert!(
            (projected.distance - expected.max(0.0)).abs() < 1e-4,
            "{projected:?} {expected}"
        );
        assert!((projected.point.distance(from) - projected.distance).abs() < 1e-4);

        let at = ask(&mut app, move |s| s.point_intersections(to, &any()));
        let expected: Vec<Entity> = {
            let holds = |place: &Transform, shape: &Option<MorphShape>| {
                let cube = MorphShape::Cuboid {
                    half_extents: Vec3::splat(0.5),
                };
                distance(to, place, &Some(shape.clone().unwrap_or_else(|| cube.clone()))) <= 0.0
            };
            let mut inside: Vec<Entity> = all
                .iter()
                .filter(|one| holds(&one.1, &one.2))
                .map(|one| one.0)
                .collect();
            inside.sort();
            inside
        };
        assert_eq!(at, expected, "{to}");
        inside += at.len();

        // A ball enlarges everything that is queried with it.
        let ball = || MorphShape::Ball { radius: 0.4 };
        let near = ask(&mut app, move |s| {
            s.shape_intersections(&ball(), to, Quat::IDENTITY, &any())
        });
        for (entity, place, shape) in &all {
            let away = distance(to, place, shape) - 0.4;
            assert!(
                away.abs() < 1e-4 || near.contains(entity) == (away < 0.0),
                "{away} {shape:?}"
            );
        }
        let cast = ask(&mut app, move |s| {
            s.cast_shape(&ball(), from, Quat::IDENTITY, direction, 30.0, &any())
        });
        let free = cast.map_or(30.0, |hit| hit.distance);
        for step in 0..300 {
            let distance = free * step as f32 / 300.0;
            assert!(
                nearest(from + direction * distance).0 > 0.4 - 1e-4 || free == 0.0,
                "cast {i} at {distance}"
            );
        }
        if let Some(hit) = cast {
            casts[usize::from(is_shape(hit.entity))] += 1;
            let (_, place, shape) = all.iter().find(|one| one.0 == hit.entity).unwrap();
            let away = distance(from + direction * hit.distance, place, shape) - 0.4;
            assert!(away < 1e-4, "{away} {hit:?}");
            assert!(
                hit.distance == 0.0 || distance(hit.point, place, shape).abs() < 1e-4,
                "{hit:?}"
            );
        }

        let boxes = ask(&mut app, move |s| {
            let around = Aabb3d {
                min: (to - 1.0).into(),
                max: (to + 1.0).into(),
            };
            s.aabb_intersections_with_aabb(around, &any())
        });
        assert!(near.iter().all(|entity| boxes.contains(entity)) && boxes.len() < placed.len());
    }
    assert!(
        hits[0] > 10 && hits[1] > 30 && casts[0] > 10 && casts[1] > 30 && inside > 10,
        "{hits:?} {casts:?} {inside}"
    );
}

#[test]
fn pairs_with_shapes_have_closest_points_and_contacts() {
    let (mut app, [a, ..]) = three();
    let ball = app.spawn((MorphShape::Ball { radius: 0.5 }, Transform::from_xyz(0.0, 2.0, 0.0)));
    let other = app.spawn((MorphShape::Ball { radius: 0.5 }, Transform::from_xyz(0.0, 4.0, 0.0)));
    settle(&mut app);
    for (first, second, sign) in [(a, ball, 1.0), (ball, a, -1.0), (ball, other, 1.0), (other, ball, -1.0)] {
        let closest = ask(&mut app, move |s| s.closest_points(first, second, 9.0)).unwrap();
        assert!((closest.distance - 1.0).abs() < 1e-6, "{closest:?}");
        assert!((closest.point2.y - closest.point1.y - sign).abs() < 1e-6, "{closest:?}");
        assert_eq!(ask(&mut app, move |s| s.closest_points(first, second, 0.9)), None);
        assert_eq!(ask(&mut app, move |s| s.contacts(first, second)), None);
    }
    app.insert(ball, Transform::from_xyz(0.0, 0.9, 0.0));
    app.update();
    for (first, second, sign) in [(a, ball, -1.0), (ball, a, 1.0)] {
        let contacts = ask(&mut app, move |s| s.contacts(first, second)).unwrap();
        assert!((contacts.normal.y - sign).abs() < 1e-5, "{contacts:?}");
        assert!(
            (contacts.depth - 0.1).abs() < 1e-5 && contacts.pair_count >= 1,
            "{contacts:?}"
        );
        let closest = ask(&mut app, move |s| s.closest_points(first, second, 9.0)).unwrap();
        assert_eq!((closest.distance, closest.point1), (0.0, closest.point2));
    }
    assert_eq!(ask(&mut app, move |s| s.closest_points(a, a, 9.0)), None);
}

#[test]
fn shapes_that_turn_touch_what_is_on_their_arc() {
    let (mut app, all) = crowd(60);
    let blade = || MorphShape::Cuboid {
        half_extents: Vec3::new(0.05, 3.0, 0.05),
    };
    let (mut hits, mut misses) = (0, 0);
    for i in 0..60_u32 {
        let x = i as f32;
        let hand = Vec3::new((x * 1.7).sin(), (x * 0.9).cos(), (x * 2.3).sin()) * 7.0;
        let rotation = Quat::from_rotation_z(x);
        let motion = MorphShapeMotion {
            translation: Vec3::new((3.1 * x).cos(), 0.0, 1.0),
            pivot: hand,
            rotation: Vec3::new(x.sin(), x.cos(), 0.5) * 2.0,
        };
        let middle = hand + rotation * Vec3::Y * 3.0;
        let hit = ask(&mut app, move |s| {
            s.cast_moving_shape(&blade(), middle, rotation, &motion, &any())
        });
        let touched_at = |share: f32| {
            let turn = Quat::from_scaled_axis(motion.rotation * share);
            let at = hand + turn * (middle - hand) + motion.translation * share;
            ask(&mut app, move |s| {
                s.shape_intersections(&blade(), at, turn * rotation, &any())
            })
        };
        let shares: Vec<f32> = (0..=40).map(|step| step as f32 / 40.0).collect();
        let first = shares.iter().copied().map(touched_at).position(|met| !met.is_empty());
        match (hit, first) {
            (None, None) => misses += 1,
            (Some(hit), first) => {
                hits += 1;
                let (_, place, shape) = all.iter().find(|(entity, ..)| *entity == hit.entity).unwrap();
                assert!(
                    hit.time == 0.0 || distance(hit.point, place, shape).abs() < 1e-3,
                    "{hit:?}"
                );
                let last_free = first.map_or(1.0, |first| shares[first]);
                assert!(hit.time <= last_free + 1e-5, "{hit:?} {last_free}");
                let turn = Quat::from_scaled_axis(motion.rotation * hit.time);
                let at = hand + turn * (middle - hand) + motion.translation * hit.time;
                let thicker = MorphShape::Cuboid {
                    half_extents: Vec3::new(0.051, 3.001, 0.051),
                };
                let met = ask(&mut app, move |s| {
                    s.shape_intersections(&thicker, at, turn * rotation, &any())
                });
                assert!(met.contains(&hit.entity), "{hit:?} is too early");
            }
            (None, Some(first)) => panic!("missed something at {first}"),
        }
    }
    assert!(hits > 10 && misses > 10, "{hits} {misses}");
}

#[test]
fn every_question_asks_its_predicate() {
    let (mut app, all) = crowd(24);
    let chosen = all[5].0;
    let at = all[5].1.translation;
    let only = move |entity: Entity| entity == chosen;
    let ball = || MorphShape::Ball { radius: 50.0 };
    let everything = Aabb3d {
        min: Vec3A::splat(-99.0),
        max: Vec3A::splat(99.0),
    };
    let frustum = bevy::camera::primitives::Frustum::default();
    let found = ask(&mut app, move |s| {
        let away = at + Vec3::new(30.0, 1.0, 0.0);
        let back = Dir3::new(at - away).unwrap();
        vec![
            s.ray_hits_predicate(away, back, 99.0, &any(), only)
                .iter()
                .map(|hit| hit.entity)
                .collect(),
            s.cast_ray_predicate(away, back, 99.0, &any(), only)
                .map(|hit| hit.entity)
                .into_iter()
                .collect(),
            s.cast_shape_predicate(&MorphShape::default(), away, Quat::IDENTITY, back, 99.0, &any(), only)
                .map(|hit| hit.entity)
                .into_iter()
                .collect(),
            s.cast_moving_shape_predicate(
                &MorphShape::default(),
                away,
                Quat::IDENTITY,
                &MorphShapeMotion {
                    translation: 1.5 * (at - away),
                    pivot: away,
                    rotation: Vec3::X,
                },
                &any(),
                only,
            )
            .map(|hit| hit.entity)
            .into_iter()
            .collect(),
            s.project_point_predicate(away, 99.0, &any(), only)
                .map(|near| near.entity)
                .into_iter()
                .collect(),
            s.point_intersections_predicate(at, &any(), only),
            s.shape_intersections_predicate(&ball(), at, Quat::IDENTITY, &any(), only),
            s.aabb_intersections_with_aabb_predicate(everything, &any(), only),
            s.frustum_intersections_predicate(&frustum, &any(), only),
        ]
    });
    for (i, found) in found.into_iter().enumerate() {
        let found: Vec<Entity> = found;
        assert_eq!(found, [chosen], "question {i}");
    }
    // One query within another.
    let nested = ask(&mut app, move |s| {
        let in_sight = |entity: Entity| {
            s.bounds(entity).is_some() && !s.shape_intersections(&ball(), at, Quat::IDENTITY, &any()).is_empty()
        };
        s.aabb_intersections_with_aabb_predicate(everything, &any(), in_sight)
            .len()
    });
    assert_eq!(nested, 24);
}

#[test]
fn questions_follow_colliders_that_move_come_and_go() {
    let (mut app, mut all) = crowd(80);
    // A collider's tolerance does not matter to queries.
    for (entity, ..) in all.iter().step_by(2) {
        let tolerant = MorphCollider::default().with_tolerance(5.0);
        app.insert(*entity, tolerant);
    }
    for frame in 0..30_u32 {
        for (i, (entity, place, _)) in all.iter_mut().enumerate() {
            place.translation += Vec3::new((i as f32).sin(), (i as f32).cos(), 0.3) * 0.4;
            app.insert(*entity, *place);
        }
        if frame % 4 == 3 {
            let (gone, ..) = all.swap_remove(frame as usize % all.len());
            app.world_mut().despawn(gone);
            let place = Transform::from_xyz(frame as f32, 0.0, 0.0);
            let shape = MorphShape::Ball { radius: 0.6 };
            let new = app.spawn((shape.clone(), place));
            all.push((new, place, Some(shape)));
        }
        app.update();
        let near = |from: Vec3| -> f32 {
            let each = all.iter().map(|(_, place, shape)| distance(from, place, shape));
            each.fold(f32::INFINITY, f32::min).max(0.0)
        };
        for i in 0..10 {
            let from = Vec3::new((i as f32 * 2.1).sin(), (i as f32).cos(), 0.1 * i as f32) * 8.0;
            let found = ask(&mut app, move |s| s.project_point(from, f32::INFINITY, &any())).unwrap();
            assert!(
                (found.distance - near(from)).abs() < 1e-4,
                "frame {frame}: {found:?} {}",
                near(from)
            );
        }
    }
}
