//! The order of hits: by exact distance, then by entity, then by triangle. What is first of all is what is first.

use bevy::math::DVec3;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_collision::spatial::MorphRayHit;
use morph_collision_models::generated::random::random_blob;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle;

use super::{any, ask};
use crate::support::{Edits, add_mesh, app, cube, settle, spawn, stretching_cube};

/// Places at which surfaces coincide, or nearly do: twice the same one, mirrored, half a turn, larger by one rounding, collapsed to
/// a sheet, a line and a point.
fn places() -> [Transform; 9] {
    let scaled = |scale: Vec3| Transform::from_scale(scale);
    [
        Transform::IDENTITY,
        scaled(Vec3::new(-1.0, 1.0, 1.0)),
        scaled(Vec3::splat(1.0 + f32::EPSILON)),
        Transform::IDENTITY,
        Transform::from_rotation(Quat::from_xyzw(0.0, 1.0, 0.0, 0.0)),
        scaled(Vec3::new(1.0, 0.0, 1.0)),
        scaled(Vec3::new(1.0, 0.0, 0.0)),
        scaled(Vec3::ZERO),
        Transform::from_xyz(0.25, 0.0, 0.0),
    ]
}

const WEIGHT: f32 = 0.5;

/// A collider and the triangles of its mesh in world space, by the oracle's definition.
type Placed = (Entity, Vec<[DVec3; 3]>);

/// A mesh with one target at all these places, and shapes on its surface.
fn nested(mesh: &MorphMesh) -> (App, Vec<Placed>) {
    let mut app = app();
    let handle = add_mesh(&mut app, mesh);
    let mut placed = Vec::new();
    for place in places() {
        let entity = spawn(&mut app, &handle, 0.0);
        let weights = MeshMorphWeights::Value { weights: vec![WEIGHT] };
        app.insert(entity, (place, weights));
        let posed = oracle::posed_vertices(&mesh.positions, &mesh.targets, &[WEIGHT]);
        let world = oracle::world_vertices(&posed, &place.compute_affine());
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| world[corner as usize]);
        placed.push((entity, mesh.triangles.iter().map(corners).collect()));
    }
    for shape in [
        MorphShape::Cuboid {
            half_extents: Vec3::splat(0.5),
        },
        MorphShape::Ball { radius: 1.0 },
    ] {
        app.spawn((shape, MorphCollider::default(), Transform::IDENTITY));
    }
    settle(&mut app);
    (app, placed)
}

/// Rays at corners, edges and insides of triangles: along an axis, which meets what it is aimed at exactly, and in any direction.
fn rays(placed: &[Placed]) -> Vec<(Vec3, Dir3)> {
    let mut all = Vec::new();
    let triangles: Vec<&[DVec3; 3]> = placed.iter().flat_map(|(_, triangles)| triangles).collect();
    for i in 0..220_usize {
        let [a, b, c] = *triangles[(i * 7919) % triangles.len()];
        let target = [a, 0.5 * (a + b), (a + b + c) / 3.0][i % 3].as_vec3();
        let angle = i as f32;
        let away = match i % 4 {
            0 => Vec3::AXES[i / 4 % 3] * 8.0,
            1 => Vec3::AXES[i / 4 % 3] * -8.0,
            // From the surface itself.
            2 => Vec3::AXES[i / 4 % 3] * 0.0,
            _ => Vec3::new((angle * 0.7).sin(), (angle * 1.3).cos(), (angle * 2.1).sin()) * 5.0,
        };
        let direction = Dir3::new(-away).unwrap_or(Dir3::from_xyz(0.0, 1.0, 0.0).unwrap());
        all.push((target + away, direction));
    }
    all
}

fn names(hits: &[MorphRayHit]) -> Vec<(Entity, u32)> {
    hits.iter().map(|hit| (hit.entity, hit.triangle)).collect()
}

#[test]
fn the_first_hit_is_the_first_of_all_hits() {
    let blob = random_blob(5, 1, 1, 0.3);
    let (mut compared, mut shared) = (0, 0);
    for mesh in [&stretching_cube(), &blob] {
        let (mut app, placed) = nested(mesh);
        let rays = rays(&placed);
        let entities: Vec<Entity> = placed.iter().map(|(entity, _)| *entity).collect();
        let counts = ask(&mut app, move |s| {
            let (mut compared, mut shared) = (0, 0);
            for (i, &(origin, direction)) in rays.iter().enumerate() {
                let left_out = entities[i % entities.len()];
                let all = s.ray_hits(origin, direction, f32::INFINITY, &any());
                let ends = all.iter().map(|hit| hit.distance).take(3).chain([f32::INFINITY]);
                for max_distance in ends {
                    for filter in [any(), any().with_only_front()] {
                        let accepts = |entity| entity != left_out;
                        let (all, first) = (
                            s.ray_hits(origin, direction, max_distance, &filter),
                            s.cast_ray(origin, direction, max_distance, &filter),
                        );
                        assert_eq!(first, all.first().copied(), "ray {i} up to {max_distance}: {all:?}");
                        assert!(all.is_sorted_by(|a, b| a.distance <= b.distance), "ray {i}: {all:?}");
                        let (all, first) = (
                            s.ray_hits_predicate(origin, direction, max_distance, &filter, accepts),
                            s.cast_ray_predicate(origin, direction, max_distance, &filter, accepts),
                        );
                        assert_eq!(first, all.first().copied(), "ray {i} up to {max_distance}: {all:?}");
                        compared += 2;
                        shared += usize::from(all.len() > 1 && all[0].distance == all[1].distance);
                    }
                }
            }
            (compared, shared)
        });
        compared += counts.0;
        shared += counts.1;
    }
    assert!(compared > 3000 && shared > 1000, "{compared} {shared}");
}

#[test]
fn hits_are_in_the_order_of_exact_distances_then_entities_then_triangles() {
    let blob = random_blob(5, 1, 1, 0.3);
    let mut ties = 0;
    for mesh in [&stretching_cube(), &blob] {
        let (mut app, placed) = nested(mesh);
        let rays = rays(&placed);
        let entities: Vec<Entity> = placed.iter().map(|(entity, _)| *entity).collect();
        let found = {
            let rays = rays.clone();
            ask(&mut app, move |s| {
                let hits = |&(origin, direction): &(Vec3, Dir3)| {
                    let is_mesh = |entity| entities.contains(&entity);
                    names(&s.ray_hits_predicate(origin, direction, f32::INFINITY, &any(), is_mesh))
                };
                rays.iter().map(hits).collect::<Vec<_>>()
            })
        };
        for ((origin, direction), found) in rays.into_iter().zip(found) {
            let mut truth: Vec<(f64, Entity, u32)> = Vec::new();
            for (entity, triangles) in &placed {
                for (number, triangle) in (0..).zip(triangles) {
                    let t = oracle::ray_parameter(origin.as_dvec3(), direction.as_dvec3(), triangle);
                    truth.extend(t.map(|t| (t, *entity, number)));
                }
            }
            truth.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
            ties += truth.windows(2).filter(|two| two[0].0 == two[1].0).count();
            let truth: Vec<_> = truth.iter().map(|(_, entity, number)| (*entity, *number)).collect();
            assert_eq!(found, truth, "from {origin} along {direction:?}");
        }
    }
    assert!(ties > 1000, "{ties}");
}

/// In `f32`, both surfaces are at the same distance.
#[test]
fn of_two_surfaces_closer_together_than_a_rounding_the_nearer_one_is_first() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let cubes = [spawn(&mut app, &mesh, 0.0), spawn(&mut app, &mesh, 0.0)];
    // The farther one would win if both were at the same distance.
    let (inner, outer) = (cubes[0].min(cubes[1]), cubes[0].max(cubes[1]));
    let larger = Transform::from_scale(Vec3::splat(1.0 + f32::EPSILON));
    app.insert(outer, larger);
    settle(&mut app);
    let (from, along) = (Vec3::new(10.0, 0.1, 0.2), Dir3::NEG_X);
    let hits = ask(&mut app, move |s| s.ray_hits(from, along, f32::INFINITY, &any()));
    assert_eq!(hits[0].distance, hits[1].distance);
    assert_eq!((hits[0].entity, hits[1].entity), (outer, inner));
    let first = ask(&mut app, move |s| s.cast_ray(from, along, f32::INFINITY, &any()));
    assert_eq!(first, Some(hits[0]));
    let (ball, still) = (MorphShape::Ball { radius: 0.25 }, Quat::IDENTITY);
    let met = ask(&mut app, move |s| {
        s.cast_shape(&ball, from, still, along, f32::INFINITY, &any())
    });
    assert_eq!(met.map(|met| met.entity), Some(outer));
    let near = ask(&mut app, move |s| s.project_point(from, f32::INFINITY, &any()));
    assert_eq!(near.map(|near| near.entity), Some(outer));
}

/// Casts and projections have no list. What they find is the first by distance, entity and triangle of what they find on each collider.
#[test]
fn casts_and_projections_find_the_first_of_what_they_find_on_each_collider() {
    let blob = random_blob(5, 1, 1, 0.3);
    for mesh in [&stretching_cube(), &blob] {
        let (mut app, placed) = nested(mesh);
        let rays = rays(&placed);
        let entities: Vec<Entity> = placed.iter().map(|(entity, _)| *entity).collect();
        ask(&mut app, move |s| {
            let (ball, still) = (MorphShape::Ball { radius: 0.125 }, Quat::IDENTITY);
            for (i, &(origin, direction)) in rays.iter().enumerate() {
                let cast = |of: &dyn Fn(Entity) -> bool| {
                    s.cast_shape_predicate(&ball, origin, still, direction, f32::INFINITY, &any(), of)
                };
                let project =
                    |of: &dyn Fn(Entity) -> bool| s.project_point_predicate(origin, f32::INFINITY, &any(), of);
                let is_mesh = |entity| entities.contains(&entity);
                let (met, near) = (cast(&is_mesh), project(&is_mesh));
                for &one in &entities {
                    let of_one = |entity| entity == one;
                    // Distances that are equal in `f32` may be different.
                    if let Some(other) = cast(&of_one) {
                        let met = met.unwrap();
                        assert!(met.distance <= other.distance, "{i}: {met:?} {other:?}");
                        assert!(met.entity != one || met == other, "{i}: {met:?} {other:?}");
                    }
                    let (near, other) = (near.unwrap(), project(&of_one).unwrap());
                    assert!(near.distance <= other.distance, "{i}: {near:?} {other:?}");
                    assert!(near.entity != one || near == other, "{i}: {near:?} {other:?}");
                }
                // The first and the fourth collider coincide.
                let (twins, lower) = ([entities[0], entities[3]], entities[0].min(entities[3]));
                let (of_both, of_lower) = (|entity| twins.contains(&entity), |entity| entity == lower);
                assert_eq!(cast(&of_both), cast(&of_lower), "{i}");
                assert_eq!(project(&of_both), project(&of_lower), "{i}");
            }
        });
    }
}
