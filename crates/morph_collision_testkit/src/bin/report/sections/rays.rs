//! Rays at a head and at a skinned character, with every method that casts them.

use std::error::Error;

use morph_collision_testkit::bench::{Experiment, NoExperiment};
use morph_collision_testkit::rivals::Wanted;

use super::{Context, race};
use crate::render;
use crate::sweeps::methods;

/// A table for each mesh of the scenes with rays. The table of a missing model stays as it is in
/// the page.
pub(crate) fn rays(context: &Context, old: &str) -> Result<String, Box<dyn Error>> {
    let mut scenes = Vec::new();
    for (name, _) in Experiment::with_rays() {
        let experiment = match Experiment::named(name, context.every) {
            Ok(experiment) => experiment,
            Err(missing @ NoExperiment::Missing { .. }) => {
                eprintln!("rays: {missing}; the place stays as it is");
                return Ok(old.to_owned());
            }
            Err(error) => return Err(error.into()),
        };
        eprintln!("rays: {}", experiment.title);
        let rows = race(&experiment, &methods(&experiment), Wanted::All, context.rounds)?;
        scenes.push((experiment, rows));
    }
    let tables = scenes.chunk_by(|(a, _), (b, _)| a.mesh.name == b.mesh.name && a.mesh.triangles == b.mesh.triangles);
    Ok(tables.map(render::ray_table).collect())
}
