//! Compares spatial queries of systems with brute force over posed vertices.

use bevy::camera::CameraProjection;
use bevy::ecs::system::RunSystemOnce;
use bevy::math::{Affine3A, DVec3};
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

mod batches;
mod casters;
mod order;
mod shapes;
mod systems;

use crate::support::{Edits, add_mesh, app, bevy_mesh, cube, set_weight, settle, spawn, stretching_cube};

/// Runs a system once that makes queries.
fn ask<T: Send + 'static>(app: &mut App, ask: impl Fn(&MorphSpatialQuery) -> T + Send + Sync + 'static) -> T {
    let system = move |spatial: MorphSpatialQuery| ask(&spatial);
    app.world_mut()
        .run_system_once(system)
        .expect("its parameters are there")
}

fn any() -> MorphQueryFilter {
    MorphQueryFilter::default()
}

/// A stretching cube at 0, and cubes at 3 and 6.
fn three() -> (App, [Entity; 3]) {
    let mut app = app();
    let (morphing, rigid) = (add_mesh(&mut app, &stretching_cube()), add_mesh(&mut app, &cube()));
    let cubes = [
        spawn(&mut app, &morphing, 0.0),
        spawn(&mut app, &rigid, 3.0),
        spawn(&mut app, &rigid, 6.0),
    ];
    settle(&mut app);
    (app, cubes)
}

#[test]
fn a_ray_hits_the_morphed_surface_first() {
    let (mut app, [a, b, c]) = three();
    let from_left = |app: &mut App| {
        ask(app, |s| {
            s.cast_ray(Vec3::new(10.0, 0.1, 0.2), Dir3::NEG_X, 100.0, &any())
        })
    };
    let hit = from_left(&mut app).unwrap();
    assert_eq!((hit.entity, hit.distance, hit.normal), (c, 3.5, Vec3::X));
    let hit = ask(&mut app, move |s| {
        s.cast_ray(
            Vec3::new(10.0, 0.1, 0.2),
            Dir3::NEG_X,
            100.0,
            &any().with_excluded_entities([b, c]),
        )
    });
    assert_eq!(hit.map(|hit| (hit.entity, hit.distance)), Some((a, 9.5)));
    set_weight(&mut app, a, 1.0);
    app.update();
    let hit = ask(&mut app, move |s| {
        let ray = (Vec3::new(10.0, 0.1, 0.2), Dir3::NEG_X);
        s.cast_ray_predicate(ray.0, ray.1, f32::INFINITY, &any(), |entity| entity == a)
    });
    let hit = hit.unwrap();
    assert_eq!((hit.distance, hit.point), (8.5, Vec3::new(1.5, 0.1, 0.2)));
    assert!((hit.barycentrics.element_sum() - 1.0).abs() < 1e-6);
    let corners = ask(&mut app, move |s| s.posed_triangle(hit.entity, hit.triangle)).unwrap();
    let [u, v, w] = hit.barycentrics.to_array();
    assert!((corners[0] * u + corners[1] * v + corners[2] * w).distance(hit.point) < 1e-6);

    let short = ask(&mut app, |s| {
        s.cast_ray(Vec3::new(10.0, 0.1, 0.2), Dir3::NEG_X, 3.0, &any())
    });
    assert_eq!(short, None);
    let nan = ask(&mut app, |s| s.cast_ray(Vec3::NAN, Dir3::X, 3.0, &any()));
    assert_eq!(nan, None);
}

#[test]
fn all_hits_of_a_ray_come_nearest_first() {
    let (mut app, [a, b, c]) = three();
    let hits = ask(&mut app, |s| {
        s.ray_hits(Vec3::new(-4.0, 0.1, 0.2), Dir3::X, f32::INFINITY, &any())
    });
    let hits: Vec<_> = hits.iter().map(|hit| (hit.entity, hit.distance)).collect();
    assert_eq!(hits, [(a, 3.5), (a, 4.5), (b, 6.5), (b, 7.5), (c, 9.5), (c, 10.5)]);
}

#[test]
fn layers_and_disabled_colliders_are_heeded() {
    let (mut app, [a, b, c]) = three();
    app.insert(c, MorphCollisionLayers::new(0b100, u32::MAX));
    app.insert(b, MorphColliderDisabled);
    app.update();
    let first = |app: &mut App, filter: MorphQueryFilter| {
        let hit = ask(app, move |s| {
            s.cast_ray(Vec3::new(10.0, 0.1, 0.2), Dir3::NEG_X, 100.0, &filter)
        });
        hit.map(|hit| hit.entity)
    };
    assert_eq!(first(&mut app, MorphQueryFilter::from_mask(0b100)), Some(c));
    assert_eq!(first(&mut app, MorphQueryFilter::from_mask(0b011)), Some(a));
    assert_eq!(first(&mut app, MorphQueryFilter::from_mask(0)), None);
    // Colliders that collide with nothing can still be queried.
    app.insert(c, MorphCollisionLayers::NONE);
    app.update();
    assert_eq!(first(&mut app, any()), Some(c));
}

#[test]
fn overlaps_are_those_of_the_surface() {
    let (mut app, [a, b, c]) = three();
    let ball = move |app: &mut App, x: f32, radius: f32| {
        let ball = MorphShape::Ball { radius };
        ask(app, move |s| {
            s.shape_intersections(&ball, Vec3::new(x, 0.0, 0.0), Quat::IDENTITY, &any())
        })
    };
    let ascending = |mut entities: Vec<Entity>| {
        entities.sort();
        entities
    };
    assert_eq!(ball(&mut app, 1.5, 0.9), []);
    assert_eq!(ball(&mut app, 1.5, 1.0), ascending(vec![a, b]));
    assert_eq!(ball(&mut app, 3.0, 0.4), [], "inside, and off its surface");
    let boxed = |app: &mut App, min: f32, max: f32| {
        let cuboid = MorphShape::Cuboid {
            half_extents: Vec3::new(0.5 * (max - min), 9.0, 9.0),
        };
        let center = Vec3::new(0.5 * (min + max), 0.0, 0.0);
        ask(app, move |s| {
            s.shape_intersections(&cuboid, center, Quat::IDENTITY, &any())
        })
    };
    assert_eq!(boxed(&mut app, 0.75, 1.75), []);
    assert_eq!(boxed(&mut app, 2.0, 9.0), ascending(vec![b, c]));
    set_weight(&mut app, a, 1.0);
    app.update();
    assert_eq!(boxed(&mut app, 0.75, 1.75), [a]);

    // A camera at x = 1.75 that looks along +X.
    let view = Transform::from_xyz(1.75, 0.0, 0.0).looking_to(Vec3::X, Vec3::Y);
    let projection = PerspectiveProjection {
        fov: 1.0,
        aspect_ratio: 1.0,
        near: 0.1,
        far: 3.0,
        ..default()
    };
    let frustum = projection.compute_frustum(&view.into());
    assert_eq!(ask(&mut app, move |s| s.frustum_intersections(&frustum, &any())), [b]);

    // Shapes are tested by their boxes: one behind the camera, one outside its view, one in view.
    let mut ball = |at: Vec3| {
        let shape = (MorphCollider::default(), MorphShape::Ball { radius: 0.2 });
        app.spawn((shape, Transform::from_translation(at)))
    };
    let [_, _, seen] = [Vec3::X, Vec3::new(3.0, 0.0, 4.0), Vec3::new(3.5, 0.0, 0.0)].map(&mut ball);
    app.update();
    assert_eq!(
        ask(&mut app, move |s| s.frustum_intersections(&frustum, &any())),
        ascending(vec![b, seen])
    );
}

#[test]
fn points_project_onto_the_closest_surface() {
    let (mut app, [_, b, c]) = three();
    let near = ask(&mut app, |s| {
        s.project_point(Vec3::new(4.0, 0.2, 0.1), f32::INFINITY, &any())
    });
    let near = near.unwrap();
    assert_eq!(
        (near.entity, near.distance, near.point),
        (b, 0.5, Vec3::new(3.5, 0.2, 0.1))
    );
    assert_eq!(near.normal, Vec3::X);
    let near = ask(&mut app, |s| s.project_point(Vec3::new(5.0, 0.2, 0.1), 0.6, &any())).unwrap();
    assert_eq!((near.entity, near.distance), (c, 0.5));
    assert_eq!(
        ask(&mut app, |s| s.project_point(Vec3::new(4.5, 0.0, 0.0), 0.9, &any())),
        None
    );
}

#[test]
fn two_colliders_have_closest_points_and_contacts() {
    let (mut app, [a, b, _]) = three();
    let closest = ask(&mut app, move |s| s.closest_points(a, b, 10.0)).unwrap();
    assert_eq!((closest.distance, closest.point1.x, closest.point2.x), (2.0, 0.5, 2.5));
    assert_eq!(ask(&mut app, move |s| s.closest_points(a, b, 1.0)), None);
    assert_eq!(ask(&mut app, move |s| s.contacts(a, b)), None);
    set_weight(&mut app, a, 2.25);
    app.update();
    let contacts = ask(&mut app, move |s| s.contacts(a, b)).unwrap();
    assert!(contacts.normal.x < -0.9 && contacts.pair_count > 0, "{contacts:?}");
    assert!(!contacts.points.is_empty(), "{contacts:?}");
    let mut places = contacts.points.iter().map(|point| point.point.x);
    assert!(places.all(|x| (2.5..=2.75).contains(&x)), "{contacts:?}");
}

#[test]
fn posed_vertices_and_bounds_are_those_of_the_pose() {
    let (mut app, [a, ..]) = three();
    set_weight(&mut app, a, -0.5);
    let turned = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_y(0.5));
    app.insert(a, turned);
    app.update();
    let posed = ask(&mut app, move |s| s.posed_vertices(a)).unwrap();
    let expected = stretching_cube().posed(&[-0.5]);
    assert_eq!(posed.len(), expected.len());
    let affine: Affine3A = turned.compute_affine();
    let bounds = ask(&mut app, move |s| s.bounds(a)).unwrap();
    for (i, (posed, expected)) in (0..).zip(posed.iter().zip(expected)) {
        assert!(posed.distance(affine.transform_point3(expected)) < 1e-5);
        assert!(bounds.contains(*posed));
        assert_eq!(ask(&mut app, move |s| s.posed_vertex(a, i)), Some(*posed));
    }
    assert_eq!(ask(&mut app, move |s| s.posed_vertex(a, 1000)), None);
    let nobody = app.world_mut().spawn_empty().id();
    assert!(ask(&mut app, move |s| s.posed_vertices(nobody)).is_none());
}

#[test]
fn hits_have_the_texture_coordinates_of_the_mesh() {
    let mut app = app();
    let square = morph_collision_models::mesh::MorphMesh {
        targets: vec![vec![Vec3::Z; 4]],
        target_names: vec!["lift".into()],
        ..morph_collision_models::mesh::MorphMesh::rigid(
            "square",
            vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            vec![[0, 1, 2], [0, 2, 3]],
        )
    };
    let mesh = bevy_mesh(&square).with_inserted_attribute(
        Mesh::ATTRIBUTE_UV_0,
        vec![[0.0_f32, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]],
    );
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let square = spawn(&mut app, &mesh, 0.0);
    let weights = MeshMorphWeights::Value { weights: vec![0.5] };
    app.insert(square, weights);
    settle(&mut app);
    let hit = ask(&mut app, |s| {
        s.cast_ray(Vec3::new(0.25, 0.75, 2.0), Dir3::NEG_Z, 9.0, &any())
    })
    .unwrap();
    assert_eq!((hit.distance, hit.triangle), (1.5, 1));
    assert!(hit.uv.unwrap().distance(Vec2::new(0.5, 0.75)) < 1e-6, "{hit:?}");
}

#[test]
fn the_texture_coordinates_of_a_hit_need_no_look_at_the_indices() {
    use bevy::asset::RenderAssetUsages;
    use bevy::mesh::{Indices, PrimitiveTopology};
    // Four squares in a row, as a list and as a strip with a stitch, which numbers triangles
    // differently.
    let corners: Vec<Vec3> = (0..10)
        .map(|i| Vec3::new((i / 2) as f32, (i % 2) as f32, 0.0))
        .collect();
    let uvs: Vec<[f32; 2]> = corners.iter().map(|p| [p.x * 0.25, p.y]).collect();
    let list = (0..4_u16)
        .flat_map(|i| [0, 2, 1, 1, 2, 3].map(|corner| 2 * i + corner))
        .collect();
    let strip = vec![0, 1, 2, 3, 4, 5, 5, 5, 5, 4, 5, 6, 7, 8, 9];
    let shapes = [
        (PrimitiveTopology::TriangleList, list),
        (PrimitiveTopology::TriangleStrip, strip),
    ];
    for (topology, indices) in shapes {
        let mut app = app();
        let mesh = Mesh::new(topology, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners.clone())
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs.clone())
            .with_inserted_indices(Indices::U16(indices));
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        spawn(&mut app, &mesh, 0.0);
        settle(&mut app);
        // If anything read the indices from the asset now, it would get wrong ones; the plugin does not
        // notice this change.
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        meshes
            .get_mut_untracked(&mesh)
            .unwrap()
            .insert_indices(Indices::U16(vec![9; 300]));
        for x in [0.2, 0.9, 1.5, 2.75, 3.1] {
            let hit = ask(&mut app, move |s| {
                s.cast_ray(Vec3::new(x, 0.25, 2.0), Dir3::NEG_Z, 9.0, &any())
            });
            let hit = hit.unwrap();
            assert!(
                hit.uv.unwrap().distance(Vec2::new(0.25 * x, 0.25)) < 1e-5,
                "{topology:?}: {hit:?}"
            );
        }
    }
}

#[test]
fn rays_at_a_crowd_find_what_brute_force_finds() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let mut placed = Vec::new();
    for i in 0..40 {
        let (angle, height) = (i as f32 * 2.4, (i as f32 * 0.7).sin());
        let place = Transform::from_xyz(angle.cos() * i as f32 * 0.1, height, angle.sin() * i as f32 * 0.1)
            .with_rotation(Quat::from_euler(EulerRot::XYZ, angle, height, 0.3))
            .with_scale(Vec3::new(0.3, 0.5, 0.2));
        let weight = (i as f32 * 1.3).sin() * 2.0;
        let entity = spawn(&mut app, &mesh, 0.0);
        let weights = MeshMorphWeights::Value { weights: vec![weight] };
        app.insert(entity, (place, weights));
        placed.push((entity, place, weight));
    }
    settle(&mut app);
    let shape = stretching_cube();
    let mut hits = 0;
    for i in 0..200 {
        let angle = i as f32 * 0.77;
        let origin = Vec3::new(6.0 * angle.cos(), (angle * 1.7).sin(), 6.0 * angle.sin());
        let aim = Vec3::new(
            (angle * 3.1).sin() * 2.0,
            (angle * 2.3).cos(),
            (angle * 1.9).sin() * 2.0,
        );
        let direction = Dir3::new(aim - origin).unwrap();
        let found = ask(&mut app, move |s| s.cast_ray(origin, direction, f32::INFINITY, &any()));
        let mut best = (f64::INFINITY, None);
        for (entity, place, weight) in &placed {
            let posed = shape.posed(&[*weight]);
            let affine = place.compute_affine();
            let world: Vec<DVec3> = posed.iter().map(|p| affine.transform_point3(*p).as_dvec3()).collect();
            for triangle in &shape.triangles {
                let [a, b, c] = triangle.map(|corner| world[corner as usize]);
                if let Some(t) = moeller_trumbore(origin.as_dvec3(), direction.as_dvec3(), [a, b, c])
                    && t < best.0
                {
                    best = (t, Some(*entity));
                }
            }
        }
        assert_eq!(found.map(|hit| hit.entity), best.1, "ray {i}");
        if let Some(hit) = found {
            assert!((f64::from(hit.distance) - best.0).abs() < 1e-4);
            hits += 1;
        }
    }
    assert!(hits > 50, "{hits} hits try little");
}

/// The parameter at which a ray hits a triangle in general position.
fn moeller_trumbore(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (u, v) = (b - a, c - a);
    let p = direction.cross(v);
    let determinant = u.dot(p);
    let s = (origin - a) / determinant;
    let (x, q) = (s.dot(p), s.cross(u));
    let y = direction.dot(q);
    let t = v.dot(q);
    (determinant != 0.0 && x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t >= 0.0).then_some(t)
}

#[test]
fn rays_may_pass_through_what_they_see_from_behind() {
    let (mut app, [_, b, c]) = three();
    let cast = |app: &mut App, only_front: bool| {
        let filter = MorphQueryFilter { only_front, ..any() };
        // Starts in the middle of the second cube.
        let hit = ask(app, move |s| {
            s.cast_ray(Vec3::new(3.0, 0.1, 0.2), Dir3::X, 100.0, &filter)
        });
        hit.map(|hit| (hit.entity, hit.distance))
    };
    assert_eq!(cast(&mut app, false), Some((b, 0.5)));
    assert_eq!(cast(&mut app, true), Some((c, 2.5)));
    let filter = MorphQueryFilter {
        only_front: true,
        ..any()
    };
    let hits = ask(&mut app, move |s| {
        s.ray_hits(Vec3::new(3.0, 0.1, 0.2), Dir3::X, 100.0, &filter)
    });
    assert_eq!(hits.iter().map(|hit| hit.distance).collect::<Vec<_>>(), [2.5]);
}
