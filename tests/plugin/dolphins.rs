//! Compares the dolphins with brute force, using asset server, glTF loader and animation.

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_testkit::oracle::{BodyPairs, BodyPose, scene_pairs};
use morph_collision_workspace::instances::Instances;

use crate::support::{app, assets};

/// The plugin's contacts in the oracle's form: bodies by index, `body_a < body_b`.
fn found(app: &App, instances: &Instances) -> Vec<BodyPairs> {
    let number = |body: Entity| instances.roots.iter().position(|&root| root == body);
    let mut found: Vec<BodyPairs> = app
        .world()
        .resource::<MorphCollisions>()
        .iter()
        .map(|contact| {
            let (a, b) = (number(contact.body1), number(contact.body2));
            let (a, b) = (a.expect("a root") as u32, b.expect("a root") as u32);
            let pairs = contact.triangles.iter();
            let mut triangles: Vec<_> = if a < b {
                pairs.map(|pair| (pair.triangle_a, pair.triangle_b)).collect()
            } else {
                pairs.map(|pair| (pair.triangle_b, pair.triangle_a)).collect()
            };
            triangles.sort_unstable();
            BodyPairs {
                body_a: a.min(b),
                body_b: a.max(b),
                triangles,
            }
        })
        .collect();
    found.sort_by_key(|pairs| (pairs.body_a, pairs.body_b));
    found
}

/// Weights and placement of every body, by index.
fn poses(app: &mut App, instances: &Instances) -> Vec<(Vec<f32>, GlobalTransform)> {
    let parts = app
        .world_mut()
        .query_filtered::<(&MorphColliderOf, &MeshMorphWeights, &GlobalTransform), With<MorphCollider>>();
    let world = app.world();
    let pose_of = |root: Entity| {
        let (_, weights, place) = parts.iter_manual(world).find(|(of, ..)| of.body == root)?;
        let weights = match weights {
            MeshMorphWeights::Value { weights } => weights.clone(),
            MeshMorphWeights::Reference(source) => world.get::<MorphWeights>(*source)?.weights().to_vec(),
        };
        Some((weights, *place))
    };
    let poses = instances.roots.iter().map(|&root| pose_of(root));
    poses.map(|pose| pose.expect("every dolphin is a collider")).collect()
}

#[test]
fn the_plugin_finds_what_brute_force_finds() {
    let file = assets().join("dolphin_564.glb");
    let mesh = read_meshes(&file)
        .expect("the dolphin comes with the repository")
        .remove(0);
    let mut app = app();
    let instances = Instances::spawn(&mut app, &file, 12, false).expect("the dolphin can be loaded");
    let mut touching = 0;
    let mut weights_of_first = Vec::new();
    for frame in [0, 57, 131, 260, 399] {
        instances.advance(app.world_mut(), frame, 400);
        app.update();
        let poses = poses(&mut app, &instances);
        let bodies: Vec<_> = poses
            .iter()
            .map(|(weights, place)| BodyPose {
                mesh: &mesh,
                weights,
                world_from_model: place.affine(),
                joints: None,
            })
            .collect();
        let expected = scene_pairs(&bodies);
        assert_eq!(found(&app, &instances), expected, "frame {frame}");
        touching += expected.len();
        weights_of_first.push(poses[0].0.clone());
    }
    assert!(touching >= 5, "only {touching} pairs touch: that tries little");
    let is_new = |(frame, weights): (usize, &Vec<f32>)| !weights_of_first[..frame].contains(weights);
    assert!(weights_of_first.iter().enumerate().all(is_new), "the animation plays");
}

#[test]
fn two_runs_find_the_same() {
    let run = || {
        let mut app = app();
        let file = assets().join("dolphin_564.glb");
        let instances = Instances::spawn(&mut app, &file, 12, false).expect("the dolphin can be loaded");
        let mut all = Vec::new();
        for frame in 0..40 {
            instances.advance(app.world_mut(), frame, 400);
            app.update();
            all.push(found(&app, &instances));
        }
        all
    };
    let first = run();
    assert!(first.iter().any(|pairs| !pairs.is_empty()));
    assert_eq!(first, run());
}
