//! Large meshes are copied in parts, over several frames.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::morph_collision::Pose;
use morph_collision_models::mesh::MorphMesh;

use crate::support::{add_mesh, bevy_mesh, settle, spawn, two_cubes};
use crate::trees::replace;

/// A strip of triangles with so many targets that copying takes several frames.
fn large() -> MorphMesh {
    let vertices = 20_000_u32;
    let positions = (0..vertices).map(|i| Vec3::new((i / 2) as f32 * 0.01, (i % 2) as f32, 0.0));
    let triangles = (0..vertices / 2 - 1).map(|i| [2 * i, 2 * i + 2, 2 * i + 1]);
    let mut mesh = MorphMesh::rigid("large", positions.collect(), triangles.collect());
    // Each target lifts one vertex.
    mesh.targets = vec![vec![Vec3::ZERO; vertices as usize]; 50];
    for (target, displacements) in mesh.targets.iter_mut().enumerate() {
        displacements[target] = Vec3::Z;
    }
    mesh.target_names = (0..50).map(|target| target.to_string()).collect();
    mesh
}

/// The heights to which the targets of the large mesh lift its vertices if it changes in every frame while it is copied, in frames
/// of this length.
fn copied_in_frames_of(length: Duration) -> Vec<f32> {
    let (mut app, _) = two_cubes(0.8);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(length));
    let mesh = add_mesh(&mut app, &large());
    spawn(&mut app, &mesh, 0.0);
    app.update();
    // There are a million displacements, of which a frame copies a sixteenth. Changing the asset without
    // Bevy noticing shows how much has been copied.
    let mark = |app: &mut App, z: f32| {
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        let mesh = meshes.get_mut_untracked(&mesh).unwrap();
        let mut targets = mesh.morph_targets().unwrap().clone();
        for (target, displacements) in targets.chunks_exact_mut(20_000).enumerate() {
            displacements[target].position.z = z;
        }
        mesh.set_morph_targets(targets);
    };
    for frame in 2..20 {
        mark(&mut app, frame as f32);
        app.update();
    }
    settle(&mut app);
    let tree = app.world().resource::<MorphTrees>().get(mesh.id()).unwrap().clone();
    let lift = |target: usize| {
        let mut pose = Pose::new(tree.clone());
        let mut weights = [0.0; 50];
        weights[target] = 1.0;
        pose.set_weights(&weights).unwrap();
        pose.source_vertex(target as u32).unwrap().z
    };
    let lifts: Vec<f32> = (0..50).map(lift).collect();
    assert!(lifts.is_sorted() && lifts[0] == 1.0, "{lifts:?}");
    lifts
}

/// The most displacements that were copied in one frame.
fn most_in_a_frame(lifts: &[f32]) -> usize {
    let in_frame = |z: f32| lifts.iter().filter(|&&lift| lift == z).count() * 20_000;
    (1..20).map(|z| in_frame(z as f32)).max().unwrap_or_default()
}

#[test]
fn a_large_mesh_is_copied_a_part_in_each_frame() {
    let lifts = copied_in_frames_of(Duration::from_secs(1) / 60);
    assert!(lifts[49] >= 15.0, "{lifts:?}");
    assert!(most_in_a_frame(&lifts) <= (1 << 16) + 20_000, "{lifts:?}");
}

#[test]
fn slow_frames_copy_larger_parts() {
    let lifts = copied_in_frames_of(Duration::from_secs(1) / 10);
    // Up to six times as much, less what the copying itself takes.
    let most = most_in_a_frame(&lifts);
    assert!((2 << 16..=(6 << 16) + 20_000).contains(&most), "{lifts:?}");
}

#[test]
fn a_mesh_that_changes_while_it_is_copied_is_copied_anew() {
    let (mut app, _) = two_cubes(0.8);
    let mut shape = large();
    let mesh = add_mesh(&mut app, &shape);
    spawn(&mut app, &mesh, 0.0);
    app.update();
    for height in 2..6 {
        for displacements in &mut shape.targets {
            displacements
                .iter_mut()
                .for_each(|d| d.z *= height as f32 / (height - 1) as f32);
        }
        replace(&mut app, mesh.id(), bevy_mesh(&shape));
        app.update();
    }
    settle(&mut app);
    let tree = app.world().resource::<MorphTrees>().get(mesh.id()).unwrap();
    let mut pose = Pose::new(tree.clone());
    pose.set_weights(&[1.0; 50]).unwrap();
    for vertex in [0, 25, 49] {
        assert_eq!(
            pose.source_vertex(vertex as u32),
            Some(shape.positions[vertex] + shape.targets[vertex][vertex])
        );
    }
}
