//! Files that a user provides: checked before anything on the stage changes, loaded, and judged.
//!
//! If a file is invalid, the previous model stays where it is. There is nothing to show only if the very first file is invalid.

mod inbox;
pub mod race;

use std::path::Path;

use bevy::gltf::Gltf;
use bevy::prelude::*;
use bevy::world_serialization::WorldAsset;
use morph_collision_models::gltf::read::{GltfFile, ReadOptions};
use morph_collision_models::inspect::{FileReport, MeshReport};

pub use self::inbox::{Inbox, Judged, Verdict};
use crate::app::is_loaded;
use crate::view::clock::{Clock, Pending, Trouble};
use crate::view::files::Files;
use crate::view::sliders::Sliders;

/// A file was accepted and loaded. It replaces the model on the stage.
#[derive(Message, Clone, Debug)]
pub struct Accepted {
    /// The file.
    pub gltf: Handle<Gltf>,
    /// Its default scene.
    pub scene: Handle<WorldAsset>,
}

/// The systems that judge files and send [`Accepted`], in [`Update`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct IntakeSystems;

/// Takes files from the inbox and sends [`Accepted`] for each good one.
pub fn plugin(app: &mut App) {
    app.init_resource::<Inbox>()
        .init_resource::<Verdict>()
        .add_message::<Accepted>()
        .add_systems(Update, (receive, examine).chain().in_set(IntakeSystems));
    // On a web page, the page handles dropped files.
    #[cfg(not(target_arch = "wasm32"))]
    app.add_systems(Update, drop_on_window.before(receive));
}

#[cfg(not(target_arch = "wasm32"))]
fn drop_on_window(mut drops: MessageReader<FileDragAndDrop>, inbox: Res<Inbox>, verdict: Res<Verdict>) {
    for event in drops.read() {
        if let FileDragAndDrop::DroppedFile { path_buf: path, .. } = event {
            match std::fs::read(path) {
                Ok(bytes) => inbox.put(path.display().to_string(), bytes),
                Err(error) => verdict.change(|judged| judged.error = Some(format!("{}: {error}", path.display()))),
            }
        }
    }
}

/// A file that was read successfully and is being loaded.
#[derive(Component)]
struct Candidate {
    /// How many files were provided, including this one.
    number: u32,
    name: String,
    /// Its name among the [`Files`].
    file: String,
    gltf: Handle<Gltf>,
}

fn receive(
    inbox: Res<Inbox>,
    verdict: Res<Verdict>,
    files: Res<Files>,
    assets: Res<AssetServer>,
    others: Query<(Entity, &Candidate)>,
    clock: Res<Clock>,
    mut commands: Commands,
) {
    let Some((name, bytes)) = inbox.take() else {
        return;
    };
    let number = verdict.now().number + 1;
    let read = look_into(&name, &bytes);
    verdict.change(|judged| {
        *judged = Judged {
            number,
            name: name.clone(),
            report: read.as_ref().ok().map(ToString::to_string),
            error: read.as_ref().err().cloned(),
            shown: false,
        };
    });
    if let Err(error) = read {
        if !clock.started {
            commands.insert_resource(Trouble(error));
        }
        return;
    }
    // A newer file replaces one that is still loading.
    for (other, candidate) in &others {
        files.remove(Path::new(&candidate.file));
        commands.entity(other).despawn();
    }
    let file = format!("{number}.glb");
    files.insert(Path::new(&file), bytes);
    let gltf = assets.load(Files::asset_path(&file));
    let candidate = Candidate {
        number,
        name,
        file,
        gltf,
    };
    commands.spawn((candidate, Pending));
}

/// Reads a file like the command-line tool. Something in it has to morph or follow joints.
fn look_into(name: &str, bytes: &[u8]) -> Result<FileReport, String> {
    let path = Path::new(name);
    let file = GltfFile::parse(bytes, path, &ReadOptions::default()).map_err(|error| error.to_string())?;
    let report = FileReport::read(&file);
    if let Some(reason) = report.why_unusable() {
        return Err(format!("{name}: no usable mesh: {reason}"));
    }
    let deforms = |mesh: &MeshReport| !mesh.rigid || mesh.skin.is_some();
    if !report.meshes.iter().any(|mesh| deforms(mesh) && mesh.usable.is_some()) {
        return Err(format!("{name}: no mesh has morph targets or joints"));
    }
    Ok(report)
}

/// Announces a file once it is loaded.
fn examine(world: &mut World) {
    let Ok((entity, candidate)) = world.query::<(Entity, &Candidate)>().single(world) else {
        return;
    };
    let (gltf, number) = (candidate.gltf.clone(), candidate.number);
    let (name, file) = (candidate.name.clone(), candidate.file.clone());
    let loaded = is_loaded(world.resource::<AssetServer>(), gltf.id().untyped(), Path::new(&name));
    let put = match loaded {
        Ok(false) => return,
        Ok(true) => match scene_of(world, &gltf) {
            Some(scene) => {
                world.insert_resource(Sliders::default());
                world.write_message(Accepted { gltf, scene });
                Ok(())
            }
            None => Err(format!("{name}: the file has no scene")),
        },
        // Users do not know the file's internal name.
        Err(error) => Err(error.to_string().replace(&Files::asset_path(&file), &name)),
    };
    if let Err(error) = &put
        && !world.resource::<Clock>().started
    {
        world.insert_resource(Trouble(error.clone()));
    }
    world.resource::<Verdict>().change(|judged| match put {
        // A later file has been judged already.
        _ if judged.number != number => {}
        Ok(()) => judged.shown = true,
        Err(error) => judged.error = Some(error),
    });
    world.resource::<Files>().remove(Path::new(&file));
    world.despawn(entity);
}

fn scene_of(world: &World, gltf: &Handle<Gltf>) -> Option<Handle<WorldAsset>> {
    let gltf = world.resource::<Assets<Gltf>>().get(gltf)?;
    gltf.default_scene.as_ref().or(gltf.scenes.first()).cloned()
}
