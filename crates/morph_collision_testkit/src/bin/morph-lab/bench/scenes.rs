//! What is measured: the named scenes, or one scene per model.

use std::path::Path;

use morph_collision_cli::shared::{AnyError, CliError, complain, count_memory, read_clips, read_mesh};
use morph_collision_testkit::bench::{Entrant, Experiment, NoExperiment};

use super::BenchArgs;

/// An experiment, and how errors refer to it.
pub(super) struct BenchScene {
    pub(super) experiment: Experiment,
    /// The model's file, or the scene's name.
    pub(super) origin: String,
}

/// The scenes that the flags select. Counts their memory for all methods.
pub(super) fn scenes(args: &BenchArgs, entrants: &[Entrant]) -> Result<Vec<BenchScene>, AnyError> {
    let every = usize::from(args.every);
    let names: Vec<String> = if args.models.is_empty() {
        Experiment::names().iter().map(ToString::to_string).collect()
    } else {
        args.models.iter().map(|model| name_of(model)).collect()
    };
    if let Some(unknown) = args.scenes.iter().find(|name| !names.contains(name)) {
        return Err(CliError::Flag {
            flag: "--scene",
            reason: format!("there is no scene '{unknown}', expected one of: {}", names.join(", ")),
        }
        .into());
    }
    let wanted = |name: &String| args.scenes.is_empty() || args.scenes.contains(name);
    if args.models.is_empty() {
        let of_name = |name| named(name, every, args.scenes.is_empty()).transpose();
        return names.into_iter().filter(wanted).filter_map(of_name).collect();
    }
    let chosen = args.models.iter().zip(names).filter(|(_, name)| wanted(name));
    chosen
        .map(|(model, name)| of_model(args, model, name, entrants))
        .collect()
}

/// A named scene. If it `may_be_missing` and its model is not available, prints a message and returns `None`.
fn named(name: String, every: usize, may_be_missing: bool) -> Result<Option<BenchScene>, AnyError> {
    match Experiment::named(&name, every) {
        Ok(experiment) => Ok(Some(BenchScene {
            experiment,
            origin: name,
        })),
        Err(missing @ NoExperiment::Missing { .. }) if may_be_missing => {
            complain(format_args!("skipped: {missing}"));
            Ok(None)
        }
        Err(error) => Err(error.into()),
    }
}

fn name_of(model: &Path) -> String {
    model.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn of_model(args: &BenchArgs, model: &Path, name: String, entrants: &[Entrant]) -> Result<BenchScene, AnyError> {
    let file = args.files.open(model)?;
    let no_mesh = |reason| CliError::NoUsableMesh {
        file: model.into(),
        reason,
    };
    let (mut largest, mut errors) = (None, Vec::new());
    for index in 0..file.mesh_count() {
        match file.budget().lend(|| file.mesh(index)) {
            Ok(found) => largest = largest.max(Some((found.mesh.triangles.len(), std::cmp::Reverse(index)))),
            Err(error) => errors.push(CliError::from(error)),
        }
    }
    let Some((_, std::cmp::Reverse(index))) = largest else {
        return Err(errors
            .into_iter()
            .next()
            .unwrap_or_else(|| no_mesh("it has none".to_owned()))
            .into());
    };
    for error in errors {
        complain(format_args!("warning: passed over: {error}"));
    }
    let mut mesh = read_mesh(&file, index, None)?;
    let bodies = u64::from(args.bodies);
    let of_method = |entrant: &Entrant| {
        if entrant.is_paper() {
            let paper = args.paper.options();
            paper.tree_bytes(&mesh) + bodies * paper.body_bytes(&mesh)
        } else {
            mesh.tree_bytes() + bodies * mesh.body_bytes(true)
        }
    };
    let frames = Experiment::bytes_of_model(&mesh, usize::from(args.bodies), usize::from(args.every));
    let bytes = entrants.iter().map(of_method).fold(frames, u64::saturating_add);
    count_memory(&file, index, bytes, || {
        format!("its trees for {bodies} bodies and {} methods", entrants.len())
    })?;
    read_clips(&args.files, &file, index, None, &mut mesh, None);
    Ok(BenchScene {
        experiment: Experiment::of_model(name, mesh, usize::from(args.bodies), usize::from(args.every)),
        origin: model.display().to_string(),
    })
}
