//! The meshes of a model to try, and what is said if one does not allow a shape.

use std::path::Path;

use morph_collision_models::gltf::read::GltfFile;
use morph_collision_models::mesh::MorphMesh;

use super::character::characters;
use super::one_mesh::{Garment, subject};
use super::options::LintOptions;
use super::poses::Tried;
use super::subject::Subject;
use crate::error::CliError;
use crate::error::PoseError;
use crate::files::clip_files::ClipFiles;
use crate::files::clips::NoClip;
use crate::messages;

/// The meshes to try. Without `--mesh`, meshes that cannot collide, or not wear the garment, are left out with a warning.
pub(super) fn subjects(options: &LintOptions, file: &GltfFile) -> Result<Vec<Subject>, CliError> {
    let garment = options.garment.as_ref();
    let garment = garment.map(|path| Garment::read(options, path, file)).transpose()?;
    let mut clip_files = ClipFiles::new(&options.files, file.budget(), Path::new(""));
    for clip in &options.clip {
        let opened = clip_files.open(clip, file);
        opened.map_err(|reason| CliError::Flag { flag: "--clip", reason })?;
    }
    let mut subjects = Vec::new();
    let indices = match &options.mesh {
        Some(choice) => {
            let found = choice.find(file);
            vec![found.map_err(|reason| CliError::Flag { flag: "--mesh", reason })?]
        }
        None if garment.is_none() => {
            subjects = characters(options, &mut clip_files, file)?;
            Vec::new()
        }
        None => {
            let mut drawn: Vec<usize> = options.drawn.drawn(file)?.iter().map(|drawn| drawn.mesh).collect();
            drawn.dedup();
            drawn
        }
    };
    for index in indices {
        let is_garment = garment
            .as_ref()
            .is_some_and(|garment| garment.is_in_model && garment.index == index);
        if is_garment && options.mesh.is_none() {
            continue;
        }
        match subject(options, &mut clip_files, file, index, None, garment.as_ref()) {
            Ok(subject) => subjects.push(subject),
            Err(error) if options.mesh.is_some() => return Err(error),
            Err(error) => messages::complain(format_args!("warning: left out: {error}")),
        }
    }
    clip_files.warn();
    if subjects.is_empty() {
        let reason = match garment {
            Some(_) => "it has no mesh that can wear the garment",
            None => "it has no mesh that can collide",
        };
        return Err(CliError::NoUsableMesh {
            file: options.model.clone(),
            reason: reason.to_owned(),
        });
    }
    check_clips(options, &clip_files, file, &subjects)?;
    Ok(subjects)
}

/// An error if no subject has one of the clips that are asked for, or if it cannot be played.
fn check_clips(
    options: &LintOptions,
    clip_files: &ClipFiles<'_>,
    file: &GltfFile,
    subjects: &[Subject],
) -> Result<(), CliError> {
    for clip in &options.clip {
        let found = subjects
            .iter()
            .map(|subject| clip_files.find(clip, file, &subject.mesh, None, &subject.broken));
        let (found, missing): (Vec<_>, Vec<_>) = found.partition(Result::is_ok);
        let mut missing = missing.into_iter().filter_map(Result::err);
        let wrong = match found.is_empty() {
            true => missing.next(),
            false => missing.find(NoClip::is_broken),
        };
        if let Some(wrong) = wrong {
            let reason = wrong.reason();
            return Err(CliError::Flag { flag: "--clip", reason });
        }
    }
    Ok(())
}

/// A shape in a message.
pub(super) fn shape_words(shape: &Tried, mesh: &MorphMesh) -> String {
    let source = shape.source.words(&mesh.target_names);
    match shape.moment {
        Some(moment) => format!("{source} at {moment}"),
        None => source,
    }
}

/// The error for a shape that the mesh does not allow.
pub(super) fn refused(
    options: &LintOptions,
    index: usize,
    mesh: &MorphMesh,
    shape: String,
    reason: PoseError,
) -> CliError {
    CliError::Shape {
        file: options.model.clone(),
        mesh: index,
        name: mesh.name.clone(),
        shape,
        reason: Box::new(reason),
    }
}
