//! The plugin's example with crates on a heaving hill, run without a window and checked against the vertices of the file.

#[allow(dead_code, reason = "its `main` opens a window, and is not called")]
#[path = "../../examples/avian_hill.rs"]
mod avian_hill;

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::time::Duration;

use avian3d::parry::math::Pose;
use avian3d::parry::query::{PointQuery, Ray, RayCast};
use avian3d::parry::shape::TriMesh;
use avian3d::prelude::*;
use bevy::math::DVec3;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::pbr::StandardMaterial;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, world_vertices};
use morph_collision_workspace::app::{update_until, without_collisions};

use crate::log::{Errors, start};
use crate::support::DT;
use avian_hill::{Crate, EDGE, game};

/// The hill's current shape in the world.
fn truth(app: &mut App, mesh: &MorphMesh) -> TriMesh {
    let mut nodes = app.world_mut().query::<&MorphWeights>();
    let weights = nodes.single(app.world()).expect("there is one").weights().to_vec();
    let mut parts = app
        .world_mut()
        .query_filtered::<&GlobalTransform, (With<MeshMorphWeights>, With<MorphPhysicsCollider>, With<Friction>)>();
    let place = *parts.single(app.world()).expect("it is in physics, and rough");
    let posed = posed_vertices(&mesh.positions, &mesh.targets, &weights);
    let vertices = world_vertices(&posed, &place.affine());
    let vertices = vertices.into_iter().map(DVec3::as_vec3).collect();
    TriMesh::new(vertices, mesh.triangles.clone()).expect("a mesh with triangles")
}

#[test]
fn crates_ride_on_a_heaving_hill_and_none_falls_through() {
    Errors::collect(|errors| {
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
        let file = assets.join("heaving_body_5120.glb");
        let mesh = read_meshes(&file).expect("it comes with the repository").remove(0);
        let mut app = without_collisions(&assets);
        app.add_plugins(PhysicsPlugins::default())
            .add_plugins((MorphPlugins, MorphAvianPlugin, game))
            .insert_resource(Time::<Fixed>::from_duration(Duration::from_secs_f32(DT)))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(DT)))
            .init_asset::<StandardMaterial>();
        start(&mut app);
        let mut crates = app.world_mut().query_filtered::<(Entity, &Position), With<Crate>>();
        update_until(&mut app, &file, |world| Ok(crates.iter(world).count() > 0)).expect("it starts to rain");
        let mut ages: HashMap<Entity, (Vec3, usize)> = HashMap::new();
        let (mut riders, mut rises, mut sinks) = (HashSet::new(), 0, 0);
        let mut deepest = f32::INFINITY;
        for _ in 0..900 {
            app.update();
            let hill = truth(&mut app, &mesh);
            let now: Vec<(Entity, Vec3)> = crates.iter(app.world()).map(|(it, at)| (it, at.0)).collect();
            for (it, at) in now {
                let distance = hill.distance_to_point(&Pose::IDENTITY, at, false);
                deepest = deepest.min(distance);
                let (last, age) = ages.insert(it, (at, 0)).unwrap_or((at, 0));
                ages.insert(it, (at, age + 1));
                // Between two steps its middle does not cross the surface.
                if last != at {
                    let way = Ray::new(last, at - last);
                    let crosses = hill.intersects_ray(&Pose::IDENTITY, &way, 1.0);
                    assert!(!crosses, "a crate falls through at {at}");
                }
                // It has come to rest on the hill. Now only the hill lifts and lowers it.
                if age > 180 && distance < 0.55 * EDGE {
                    riders.insert(it);
                    rises += usize::from(at.y - last.y > 0.05 * DT);
                    sinks += usize::from(at.y - last.y < -0.05 * DT);
                }
            }
        }
        let counts = (riders.len(), rises, sinks);
        assert!(deepest > 0.4 * EDGE, "a crate's middle came as near as {deepest}");
        assert!(counts.0 >= 8 && counts.1 >= 800 && counts.2 >= 800, "{counts:?}");
        assert_eq!((errors.take(), errors.take_warnings()), (vec![], vec![]));
    });
}
