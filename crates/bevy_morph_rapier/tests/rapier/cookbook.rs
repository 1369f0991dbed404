//! The plugin's example with a character in the rain of balls, run without a window and checked against the vertices of the file
//! at each step.

#[allow(dead_code, reason = "its `main` opens a window, and is not called")]
#[path = "../../examples/rapier_character.rs"]
mod rapier_character;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use bevy::math::DVec3;
use bevy::mesh::morph::MorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::pbr::StandardMaterial;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::{PointQuery, Ray, RayCast};
use bevy_rapier3d::parry::shape::TriMesh;
use bevy_rapier3d::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, skinned_vertices};
use morph_collision_workspace::app::{update_until, without_collisions};
use morph_collision_workspace::physics::DT;

use crate::log::start;
use crate::support::global;
use rapier_character::{Ball, RADIUS, game};

/// The character's current shape in the world.
fn truth(app: &mut App, mesh: &MorphMesh) -> TriMesh {
    let skin = mesh.skin.as_ref().expect("a character has joints");
    let mut nodes = app.world_mut().query::<&MorphWeights>();
    let weights = nodes.single(app.world()).expect("there is one").weights().to_vec();
    let mut skins = app.world_mut().query::<&SkinnedMesh>();
    let joints = skins.single(app.world()).expect("there is one").joints.clone();
    let matrix = |(&entity, joint): (&Entity, &morph_collision_models::skeleton::Joint)| {
        bevy::math::Affine3A::from_mat4(Mat4::from(global(app, entity).affine()) * joint.inverse_bind)
    };
    let matrices: Vec<_> = joints.iter().zip(&skin.skeleton.joints).map(matrix).collect();
    let posed = posed_vertices(&mesh.positions, &mesh.targets, &weights);
    let vertices = skinned_vertices(&posed, &skin.sets, &matrices);
    let vertices = vertices.into_iter().map(DVec3::as_vec3).collect();
    TriMesh::new(vertices, mesh.triangles.clone()).expect("a mesh with triangles")
}

#[test]
fn balls_bounce_off_a_walking_character_and_none_falls_through() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    let file = assets.join("mh_character_low.glb");
    let mesh = read_meshes(&file).expect("it comes with the repository").remove(0);
    let mut app = without_collisions(&assets);
    app.add_plugins(RapierPhysicsPlugin::<NoUserData>::default())
        .add_plugins((MorphPlugins, MorphRapierPlugin, game))
        .insert_resource(TimestepMode::Fixed { dt: DT, substeps: 1 })
        .init_asset::<StandardMaterial>();
    start(&mut app);
    let mut balls = app.world_mut().query_filtered::<(Entity, &Transform), With<Ball>>();
    update_until(&mut app, &file, |world| Ok(balls.iter(world).count() > 0)).expect("it starts to rain");
    let mut before: HashMap<Entity, Vec3> = HashMap::new();
    let (mut touched, mut bounced, mut deepest) = (HashSet::new(), HashSet::new(), f32::INFINITY);
    let mut moved: Option<(Vec3, f32)> = None;
    for _ in 0..360 {
        app.update();
        let body = truth(&mut app, &mesh);
        let corner = body.vertices()[100];
        moved = moved.map_or(Some((corner, 0.0)), |(at, most)| {
            Some((at, corner.distance(at).max(most)))
        });
        let now: Vec<(Entity, Vec3)> = balls
            .iter(app.world())
            .map(|(ball, place)| (ball, place.translation))
            .collect();
        for (ball, at) in now {
            let distance = body.distance_to_point(&Pose::IDENTITY, at, false).abs();
            deepest = deepest.min(distance);
            if distance < RADIUS + 0.01 {
                touched.insert(ball);
            }
            // Between two steps its middle does not cross the surface.
            if let Some(last) = before.get(&ball).filter(|&&last| last != at) {
                let way = Ray::new(*last, at - *last);
                assert!(
                    !body.intersects_ray(&Pose::IDENTITY, &way, 1.0),
                    "a ball falls through at {at}"
                );
            }
            let velocity = before.get(&ball).map_or(Vec3::ZERO, |&last| (at - last) / DT);
            // Balls fall straight down until something pushes them sideways. High above the floor, only the character does.
            if at.y > 0.7 && velocity.xz().length() > 0.2 && touched.contains(&ball) {
                bounced.insert(ball);
            }
            before.insert(ball, at);
        }
    }
    assert!(deepest > 0.25 * RADIUS, "a ball's middle came as near as {deepest}");
    assert!(
        touched.len() >= 20 && bounced.len() >= 10,
        "{} touched, {} bounced",
        touched.len(),
        bounced.len()
    );
    assert!(moved.is_some_and(|(_, most)| most > 0.02), "the clip plays: {moved:?}");
}
