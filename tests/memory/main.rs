//! The memory that the plugin takes while meshes become trees, relative to what remains. A test program of its own, because its
//! allocator counts everything in the process.

use std::path::Path;

use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::random;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_testkit::moments::real_model;
use morph_collision_workspace::app::{headless, ready};
use morph_collision_workspace::crowd;
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Checks the peak from before a loaded model gets its colliders until all of them are ready.
fn check(file: &Path) {
    let mut app = headless(file.parent().unwrap());
    ready(&mut app);
    let (roots, _) = crowd::spawn(&mut app, file, &[Transform::default()], ()).unwrap();
    for _ in 0..5 {
        app.update();
    }
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    app.world_mut()
        .entity_mut(roots[0])
        .insert(MorphColliderScene::default());
    app.update();
    while app.world().resource::<MorphTrees>().building() > 0 {
        app.update();
    }
    for _ in 0..5 {
        app.update();
    }
    let (remaining, peak) = (MEMORY.current_usage() - before, MEMORY.peak_usage() - before);
    let trees = app.world().resource::<MorphTrees>();
    let counted: usize = trees.iter().map(|(_, tree)| tree.model().bytes() + tree.bytes()).sum();
    let (name, ratio) = (file.file_name().unwrap().display(), peak as f64 / remaining as f64);
    println!(
        "{name}: trees and models {counted} bytes, {remaining} with everything else, at most {ratio:.2} times as much"
    );
    assert!(counted > 0 && remaining > counted, "{name}");
    assert!(ratio <= 3.0, "{name}: {peak} bytes for {remaining}");
}

#[test]
fn an_import_takes_at_most_three_times_what_remains() {
    let folder = tempfile::tempdir().unwrap();
    for sparsity in [0.0, 0.5, 0.9] {
        let file = folder.path().join(format!("blob_{sparsity}.glb"));
        write_glb(&file, &random::random_blob(1, 5, 30, sparsity), &Appearance::default()).unwrap();
        check(&file.canonicalize().unwrap());
    }
    for name in ["mh_character.glb", "ict_face_skin.glb"] {
        if let Some(file) = real_model(name) {
            check(&file.canonicalize().unwrap());
        }
    }
}
