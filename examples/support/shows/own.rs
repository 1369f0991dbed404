//! Any model that a user provides: inspected, played, and run into a copy of itself.
//!
//! A new file is checked before anything on the stage changes. If it is invalid, the previous model stays where it is. There is
//! nothing to show only if the very first file is invalid.

mod inbox;
mod race;

use std::f32::consts::TAU;
use std::path::Path;

use bevy::gltf::Gltf;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::gltf_read::{GltfFile, ReadOptions};
use morph_collision_testkit::inspect::{FileReport, MeshReport};

pub use self::inbox::{Inbox, Judged, Verdict};
use self::race::Race;
use super::group::{Extent, Idle, Member};
use crate::app::is_loaded;
use crate::physics::wobbling;
use crate::view::Show;
use crate::view::clock::{Clock, Pending, Trouble};
use crate::view::files::Files;
use crate::view::models::Plays;
use crate::view::overlay::OverlaySystems;
use crate::view::sliders::Sliders;
use crate::view::stage::Notes;

/// Two copies of the model that comes into the inbox.
#[must_use]
pub fn own(inbox: Inbox, verdict: Verdict) -> Show {
    Show {
        name: "own",
        about: "Two copies of your model run into each other. Touching triangles are red.",
        keys: &[],
        eye: Vec3::new(0.9, 0.7, 3.7),
        target: Vec3::new(0.35, 0.0, 0.0),
        pictures: &[100, 140],
        scene: Box::new(|app| {
            app.insert_resource(inbox)
                .insert_resource(verdict)
                .init_resource::<Fit>()
                .init_resource::<Race>()
                .add_systems(Update, (receive, examine, measure, meet, morph).chain())
                .add_systems(PostUpdate, race::run.after(OverlaySystems));
            // On a web page, the page handles dropped files.
            #[cfg(not(target_arch = "wasm32"))]
            app.add_systems(Update, drop_on_window.before(receive));
        }),
    }
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

/// How the model on the stage is scaled to the common size.
#[derive(Resource, Default)]
struct Fit(Option<Fitted>);

#[derive(Clone, Copy)]
struct Fitted {
    center: Vec3,
    size: Vec3,
    scale: f32,
}

/// The scaled length of the longest side.
const LENGTH: f32 = 2.0;

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

/// Puts a loaded file on the stage.
fn examine(world: &mut World) {
    let Ok((entity, candidate)) = world.query::<(Entity, &Candidate)>().single(world) else {
        return;
    };
    let (gltf, number) = (candidate.gltf.clone(), candidate.number);
    let (name, file) = (candidate.name.clone(), candidate.file.clone());
    let loaded = is_loaded(world.resource::<AssetServer>(), gltf.id().untyped(), Path::new(&name));
    let put = match loaded {
        Ok(false) => return,
        Ok(true) => put_on_stage(world, entity, &gltf),
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

fn put_on_stage(world: &mut World, candidate: Entity, gltf: &Handle<Gltf>) -> Result<(), String> {
    let Some(Candidate { name, .. }) = world.entity_mut(candidate).take::<Candidate>() else {
        return Ok(());
    };
    let scene = world.resource::<Assets<Gltf>>().get(gltf);
    let scene = scene.and_then(|gltf| gltf.default_scene.as_ref().or(gltf.scenes.first()));
    let scene = scene.cloned().ok_or_else(|| format!("{name}: the file has no scene"))?;

    let before: Vec<Entity> = world.query_filtered::<Entity, With<Member>>().iter(world).collect();
    before.into_iter().for_each(|member| {
        world.despawn(member);
    });
    world.insert_resource(Fit::default());
    world.insert_resource(Race::default());
    world.insert_resource(Sliders::default());
    for index in 0..2 {
        world.spawn((
            Member(index),
            Name::new(format!("copy {index}")),
            WorldAssetRoot(scene.clone()),
            Plays::new(gltf.clone(), 0.3 * index as f32),
            MorphColliderScene::default(),
            Pending,
            Visibility::default(),
            // They keep apart until their size is known.
            Transform::from_xyz(1e6 * index as f32, 0.0, 0.0),
        ));
    }
    Ok(())
}

fn measure(mut fit: ResMut<Fit>, extent: Extent) {
    if fit.0.is_some() {
        return;
    }
    let (min, max) = extent.of_first();
    let size = max - min;
    let longest = size.max_element();
    if longest.is_finite() && longest > 0.0 {
        fit.0 = Some(Fitted {
            center: 0.5 * (min + max),
            size,
            scale: LENGTH / longest,
        });
    }
}

/// One turns on the spot, the other comes and goes.
fn meet(mut members: Query<(&Member, &mut Transform)>, fit: Res<Fit>, clock: Res<Clock>) {
    let Some(Fitted { center, size, scale }) = fit.0 else {
        return;
    };
    let seconds = clock.frame as f32 / 60.0;
    let apart = size.x * scale * (0.65 + 0.45 * (TAU * seconds / 8.0).cos());
    for (&Member(index), mut place) in &mut members {
        let turn = if index == 0 { 0.25 } else { -0.15 };
        let rotation = Quat::from_rotation_y(turn * (TAU * seconds / 5.0).sin());
        *place = Transform {
            translation: Vec3::X * apart * index as f32 - rotation * center * scale,
            rotation,
            scale: Vec3::splat(scale),
        };
    }
}

/// Without a clip, shows the targets one after the other.
fn morph(mut idle: Idle, clock: Res<Clock>) {
    let seconds = clock.frame as f32 / 60.0;
    idle.for_each(|index, weights| weights.copy_from_slice(&wobbling(seconds + 1.3 * index as f32, weights.len())));
}

/// Notes about the model and its costs.
fn notes(race: &Race, verdict: &Verdict) -> Notes {
    let mut notes = race.notes();
    if let Some(error) = verdict.now().error {
        notes.push(("refused", error));
    }
    Notes(notes)
}
