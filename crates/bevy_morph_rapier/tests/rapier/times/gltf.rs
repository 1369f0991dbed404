//! A surface that a glTF clip animates, played by Bevy's animation player.

use bevy::gltf::Gltf;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_workspace::app::{load_gltf, update_until};
use morph_collision_workspace::physics::{body, settle, sheet};

use super::{FRAMES, Frames, STEPS, Watched, app, begin_to_watch, frames, range};

#[test]
fn a_ball_rises_with_a_clip_in_every_step() {
    let mut mesh = sheet(16);
    mesh.animations = vec![WeightAnimation {
        name: "rise".into(),
        times: vec![0.0, 100.0],
        weights: vec![vec![0.0, 0.0], vec![50.0, 0.0]],
        ..WeightAnimation::default()
    }];
    let folder = tempfile::tempdir().expect("there is room for a file");
    let file = folder.path().join("sheet.glb");
    write_glb(&file, &mesh, &Appearance::default()).expect("the sheet can be written");
    for steps in STEPS {
        for lengths in FRAMES {
            let mut app = app(folder.path(), steps);
            let gltf = load_gltf(&mut app, &file).expect("the sheet can be loaded");
            let (scene, clip) = {
                let gltf = app.world().resource::<Assets<Gltf>>().get(&gltf).unwrap();
                (gltf.scenes[0].clone(), gltf.named_animations["rise"].clone())
            };
            #[derive(Resource, Default)]
            struct Ready(bool);
            app.init_resource::<Ready>();
            app.world_mut()
                .add_observer(|_: On<WorldInstanceReady>, mut ready: ResMut<Ready>| ready.0 = true);
            app.world_mut().spawn((WorldAssetRoot(scene), Visibility::default()));
            update_until(&mut app, &file, |world| Ok(world.resource::<Ready>().0)).expect("the scene is spawned");
            let world = app.world_mut();
            let mut meshes = world.query_filtered::<Entity, With<MeshMorphWeights>>();
            let surface = meshes.single(world).expect("there is one mesh");
            world.entity_mut(surface).insert(MorphPhysicsCollider::default());
            settle(&mut app);
            let ball = body(&mut app, Collider::ball(0.5), Vec3::new(0.1, 0.5, 0.05));
            frames(&mut app, Frames::Every(1.0 / 60.0), 60);

            let (graph, node) = AnimationGraph::from_clip(clip);
            let world = app.world_mut();
            let graph = world.resource_mut::<Assets<AnimationGraph>>().add(graph);
            let mut players = world.query_filtered::<Entity, With<AnimationPlayer>>();
            let player = players.single(world).expect("there is one player");
            world.entity_mut(player).insert(AnimationGraphHandle(graph));
            frames(&mut app, lengths, 10);
            app.world_mut().get_mut::<AnimationPlayer>(player).unwrap().play(node);
            begin_to_watch(&mut app, ball);
            frames(&mut app, lengths, 200);
            let seen = &app.world().resource::<Watched>().steps[30..];
            assert!(seen.len() > 50);
            let (low, high) = range(seen.iter().map(|(_, velocity)| velocity.y));
            assert!(
                low > 0.49 && high < 0.51,
                "{steps:?}, {lengths:?}: velocities from {low} to {high}"
            );
        }
    }
}
