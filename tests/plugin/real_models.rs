//! Loaded models: a mouth opens, a tail slaps, a smile is picked, and boxes enclose all vertices.

use std::path::{Path, PathBuf};

use bevy::camera::primitives::Aabb;
use bevy::ecs::system::RunSystemOnce;
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::models::{play, shared, with_models};
use crate::support::{Edits, Messages, assets, settle, touches};

/// The head in the repository: a real face without a clip.
fn head() -> PathBuf {
    assets().join("mh_head_eyes_teeth_arkit52.glb")
}

/// An app with one model, with culling and collision, and the model's clips.
fn with_model(file: &Path) -> (App, Vec<Handle<AnimationClip>>) {
    let (app, _, clips) = with_models(file, &[Transform::default()]);
    (app, clips.into_iter().map(|(_, clip)| clip).collect())
}

/// Every entity that shows a morphing mesh.
fn morphing(app: &mut App) -> Vec<Entity> {
    let mut meshes = app
        .world_mut()
        .query_filtered::<Entity, (With<Mesh3d>, With<MeshMorphWeights>)>();
    meshes.iter(app.world()).collect()
}

fn weights_of(app: &App, mesh: Entity) -> Vec<f32> {
    match app.world().get::<MeshMorphWeights>(mesh).unwrap() {
        MeshMorphWeights::Value { weights } => weights.clone(),
        MeshMorphWeights::Reference(source) => app.world().get::<MorphWeights>(*source).unwrap().weights().to_vec(),
    }
}

/// Sets a weight, by name, on every mesh that has such a target.
fn set_target(app: &mut App, name: &str, weight: f32) {
    let mut set = 0;
    for mesh in morphing(app) {
        let world = app.world();
        let handle = world.get::<Mesh3d>(mesh).unwrap();
        let asset = world.resource::<Assets<Mesh>>().get(&handle.0).unwrap();
        let Some(target) = asset
            .morph_target_names()
            .and_then(|names| names.iter().position(|n| n == name))
        else {
            continue;
        };
        let Some(&MeshMorphWeights::Reference(source)) = world.get::<MeshMorphWeights>(mesh) else {
            continue;
        };
        app.world_mut().get_mut::<MorphWeights>(source).unwrap().weights_mut()[target] = weight;
        set += 1;
    }
    assert!(set > 0, "no mesh has a target {name}");
}

/// Posed vertices of a mesh in its own space, blended one by one from the data that Bevy draws.
fn posed(app: &App, mesh: Entity) -> Vec<Vec3> {
    let weights = weights_of(app, mesh);
    let handle = app.world().get::<Mesh3d>(mesh).unwrap();
    let asset = app.world().resource::<Assets<Mesh>>().get(&handle.0).unwrap();
    let positions = asset
        .attribute(Mesh::ATTRIBUTE_POSITION)
        .and_then(|p| p.as_float3())
        .unwrap();
    let displacements: &[MorphAttributes] = asset.try_morph_targets().ok().unwrap();
    let mut posed: Vec<Vec3> = positions.iter().map(|&p| Vec3::from_array(p)).collect();
    let vertices = posed.len();
    for (target, weight) in weights.iter().enumerate() {
        for (vertex, p) in posed.iter_mut().enumerate() {
            *p += *weight * displacements[target * vertices + vertex].position;
        }
    }
    posed
}

fn box_holds_vertices(app: &App, mesh: Entity, when: &str) {
    let aabb = app.world().get::<Aabb>(mesh).unwrap();
    let (min, max) = (Vec3::from(aabb.min()), Vec3::from(aabb.max()));
    for p in posed(app, mesh) {
        let holds = p.cmpge(min).all() && p.cmple(max).all();
        assert!(holds, "{when}: {p} is not in {aabb:?}");
    }
}

#[test]
fn the_box_holds_every_posed_vertex_of_a_face_that_makes_faces() {
    let (mut app, _) = with_model(&head());
    let meshes = morphing(&mut app);
    assert!(!meshes.is_empty());
    let rest: Vec<Aabb> = meshes.iter().map(|&mesh| *app.world().get(mesh).unwrap()).collect();
    let mut outgrown = 0;
    for frame in 0..24_usize {
        for &mesh in &meshes {
            let mut weights = weights_of(&app, mesh);
            // About 10 of 52 targets at a time; sums of 4 and more, and a few negative weights.
            for (target, weight) in weights.iter_mut().enumerate() {
                *weight = match (7 * frame + 11 * target) % 5 {
                    0 => 0.25 + 0.125 * ((frame + target) % 7) as f32,
                    1 if target % 9 == 0 => -0.25,
                    _ => 0.0,
                };
            }
            let Some(&MeshMorphWeights::Reference(source)) = app.world().get::<MeshMorphWeights>(mesh) else {
                panic!("a glTF's meshes refer to their node's weights")
            };
            let mut shared = app.world_mut().get_mut::<MorphWeights>(source).unwrap();
            shared.weights_mut().copy_from_slice(&weights);
        }
        app.update();
        for (&mesh, rest) in meshes.iter().zip(&rest) {
            box_holds_vertices(&app, mesh, &format!("frame {frame}"));
            let out = |p: Vec3| p.cmplt(rest.min().into()).any() || p.cmpgt(rest.max().into()).any();
            outgrown += usize::from(posed(&app, mesh).into_iter().any(out));
        }
    }
    assert!(outgrown > 0, "the box of the rest pose would not do");
}

#[test]
fn the_box_holds_every_posed_vertex_as_clips_play() {
    let mut files = vec![assets().join("dolphin_564.glb")];
    let names = [
        "AnimatedMorphCube.gltf",
        "AnimatedMorphSphere.gltf",
        "MorphStressTest.gltf",
        "SimpleMorph.gltf",
        "mh_head_eyes_teeth_arkit52_dao.glb",
        "ict_face_skin.glb",
    ];
    files.extend(names.iter().filter_map(|name| shared(name)));
    for file in files {
        let (mut app, clips) = with_model(&file);
        assert!(!clips.is_empty(), "{} has a clip", file.display());
        let meshes = morphing(&mut app);
        let mut moved = 0;
        for clip in clips {
            let duration = play(&mut app, &clip, &[], |_, _| 0.0);
            let mut before = Vec::new();
            // Up to three seconds of it.
            for frame in 0..=((duration * 60.0) as usize).min(180) {
                app.update();
                for &mesh in &meshes {
                    let weights = weights_of(&app, mesh);
                    moved += usize::from(weights != before);
                    before = weights;
                    box_holds_vertices(&app, mesh, &format!("{}, frame {frame}", file.display()));
                }
            }
        }
        assert!(moved > 4, "{} hardly moves", file.display());
    }
}

#[test]
fn a_tail_slaps_a_ball() {
    let (mut app, _) = with_model(&assets().join("dolphin_564.glb"));
    let dolphin = morphing(&mut app)[0];
    // The vertex that the morph moves most: where it is, and where it would be.
    let targets = weights_of(&app, dolphin).len();
    let set = |app: &mut App, target: usize, weight: f32| {
        let Some(&MeshMorphWeights::Reference(source)) = app.world().get::<MeshMorphWeights>(dolphin) else {
            panic!("a glTF's meshes refer to their node's weights")
        };
        let mut weights = app.world_mut().get_mut::<MorphWeights>(source).unwrap();
        weights.weights_mut().fill(0.0);
        weights.weights_mut()[target] = weight;
        app.update();
    };
    let mut farthest = (0.0, 0, 0);
    set(&mut app, 0, 0.0);
    let rest = posed(&app, dolphin);
    for target in 0..targets {
        set(&mut app, target, 1.0);
        for (vertex, (p, q)) in posed(&app, dolphin).iter().zip(&rest).enumerate() {
            if p.distance(*q) > farthest.0 {
                farthest = (p.distance(*q), target, vertex);
            }
        }
    }
    let (way, target, vertex) = farthest;
    set(&mut app, target, 1.0);
    let tip = posed(&app, dolphin)[vertex];
    let place = *app.world().get::<GlobalTransform>(dolphin).unwrap();
    let ball = Transform::from_translation(place.transform_point(tip));
    let shape = MorphShape::Ball { radius: way * 0.05 };
    let ball = app.spawn((shape, MorphCollider::new(MorphCollisionMode::Contacts), ball));
    set(&mut app, target, 0.0);
    assert!(!touches(&app, dolphin, ball), "at rest the tail is elsewhere");
    let mut messages = Messages::default();
    messages.read(&app);
    let mut started = Vec::new();
    for step in 0..=10 {
        set(&mut app, target, step as f32 / 10.0);
        started.extend(messages.read(&app).0.into_iter().map(|start| (step, start)));
    }
    assert_eq!(started.len(), 1, "{started:?}");
    let (step, start) = started[0];
    assert!(step > 2, "only when it gets there");
    assert!(
        start.point.distance(place.transform_point(tip)) < way * 0.2,
        "{start:?}"
    );
}

#[test]
fn a_mouth_opens_onto_a_ball() {
    let (mut app, _) = with_model(&head());
    let meshes = morphing(&mut app);
    let in_world = |app: &App| -> Vec<Vec3> {
        let of = |&mesh: &Entity| {
            let place = *app.world().get::<GlobalTransform>(mesh).unwrap();
            posed(app, mesh).into_iter().map(move |p| place.transform_point(p))
        };
        meshes.iter().flat_map(of).collect()
    };
    let closed = in_world(&app);
    set_target(&mut app, "jawOpen", 1.0);
    app.update();
    let open = in_world(&app);
    set_target(&mut app, "jawOpen", 0.0);
    app.update();
    // The place reached by the jaw that is farthest from everything while the mouth is closed.
    let way = |i: usize| closed[i].distance(open[i]);
    let mut moved: Vec<usize> = (0..closed.len()).collect();
    moved.sort_by(|&i, &j| way(j).total_cmp(&way(i)));
    let room = |i: usize| closed.iter().map(|p| p.distance(open[i])).fold(f32::INFINITY, f32::min);
    let rooms = moved.iter().take(300).map(|&i| (room(i), open[i]));
    let (room, place) = rooms.max_by(|x, y| x.0.total_cmp(&y.0)).unwrap();
    let shape = MorphShape::Ball { radius: room * 0.2 };
    let ball = app.spawn((shape, Transform::from_translation(place)));
    settle(&mut app);
    let touched = |app: &App| app.world().resource::<MorphCollisions>().collisions_with(ball).count() > 0;
    assert!(!touched(&app), "the mouth is closed");
    let mut opened = Vec::new();
    for step in 0..=10 {
        set_target(&mut app, "jawOpen", step as f32 / 10.0);
        app.update();
        opened.push(touched(&app));
    }
    assert!(opened[10] && !opened[0] && opened.is_sorted(), "{opened:?}");
}

#[test]
fn a_smile_is_picked_where_it_is_drawn() {
    let (mut app, _) = with_model(&head());
    let cast = |app: &mut App, origin: Vec3, direction: Dir3| {
        let system = move |spatial: MorphSpatialQuery| {
            spatial.cast_ray(origin, direction, f32::INFINITY, &MorphQueryFilter::default())
        };
        app.world_mut().run_system_once(system).unwrap()
    };
    let rest: Vec<Vec<Vec3>> = morphing(&mut app).iter().map(|&mesh| posed(&app, mesh)).collect();
    for name in ["mouthSmileLeft", "mouthSmileRight"] {
        set_target(&mut app, name, 1.0);
    }
    app.update();
    let mut tried = 0;
    for (mesh, rest) in morphing(&mut app).into_iter().zip(rest) {
        let place = *app.world().get::<GlobalTransform>(mesh).unwrap();
        let smile = posed(&app, mesh);
        // Aims rays at the vertices that the smile moves most. Each must hit its vertex where it is, or something
        // in front of it.
        let mut moved: Vec<usize> = (0..smile.len()).collect();
        moved.sort_by(|&i, &j| smile[j].distance(rest[j]).total_cmp(&smile[i].distance(rest[i])));
        for &vertex in moved.iter().take(2000).step_by(40) {
            let way = smile[vertex].distance(rest[vertex]);
            if way < 1e-4 {
                break;
            }
            let target = place.transform_point(smile[vertex]);
            for direction in [Dir3::NEG_Z, Dir3::Z, Dir3::NEG_Y, Dir3::Y, Dir3::NEG_X, Dir3::X] {
                let far = 100.0 * target.length();
                let hit = cast(&mut app, target - direction * far, direction).expect("something is there");
                assert!(
                    hit.distance <= far * (1.0 + 1e-5),
                    "what is drawn there is hit, or something before it"
                );
                if hit.distance >= far * (1.0 - 1e-5) && hit.entity == mesh {
                    tried += 1;
                    break;
                }
            }
        }
    }
    assert!(tried >= 5, "{tried} vertices of the smile were in sight");
}
