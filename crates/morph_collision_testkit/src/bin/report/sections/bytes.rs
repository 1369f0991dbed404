//! Bytes per triangle, in this library and in Parry's triangle mesh.

use std::error::Error;
use std::sync::Arc;

use morph_collision::{BuildOptions, MorphBvh, Pose};
use morph_collision_testkit::bench::{Experiment, NoExperiment};
use morph_collision_testkit::mesh::MorphMesh;
use parry3d::shape::TriMesh;

use super::Context;
use super::faces::{FACES, face};

/// A row for each model of the page. The row of a missing model stays as it is in the page.
pub(crate) fn bytes(context: &Context, old: &str) -> Result<String, Box<dyn Error>> {
    let mut text = String::from(
        "\n| bytes for each triangle | triangles | targets | model | tree | pose, refitted | Parry's `TriMesh` |\n\
         |---|--:|--:|--:|--:|--:|--:|\n",
    );
    let mut add = |title: &str, mesh: Option<&MorphMesh>| -> Result<(), Box<dyn Error>> {
        text += &match mesh {
            Some(mesh) => row(title, mesh)?,
            None => kept(old, title),
        };
        Ok(())
    };
    for experiment in Experiment::tuning(context.every) {
        let title = experiment.title.split(',').next().unwrap_or_default();
        add(title, Some(&experiment.mesh))?;
    }
    for (file, title) in FACES {
        add(title, face(file)?.as_ref())?;
    }
    for (name, title) in Experiment::characters() {
        match Experiment::named(name, context.every) {
            Ok(experiment) => add(title, Some(&experiment.mesh))?,
            Err(NoExperiment::Missing { .. }) => add(title, None)?,
            Err(error) => return Err(error.into()),
        }
    }
    Ok(text)
}

fn row(title: &str, mesh: &MorphMesh) -> Result<String, Box<dyn Error>> {
    let model = Arc::new(mesh.to_model()?);
    let bvh = Arc::new(MorphBvh::build(Arc::clone(&model), &BuildOptions::default()));
    let mut pose = Pose::new(Arc::clone(&bvh));
    pose.refit();
    let positions: Option<Vec<_>> = (0..mesh.positions.len())
        .map(|i| pose.source_vertex(i as u32))
        .collect();
    let parry = TriMesh::new(positions.unwrap_or_default(), mesh.triangles.clone())?;
    let triangles = mesh.triangles.len();
    let of_each = |bytes: usize| (bytes as f64 / triangles as f64).round();
    Ok(format!(
        "| {title} | {triangles} | {} | {} | {} | {} | {} |\n",
        mesh.targets.len(),
        of_each(model.bytes()),
        of_each(bvh.bytes()),
        of_each(pose.bytes()),
        of_each(parry.heap_memory_size()),
    ))
}

/// The row of a table for a model.
fn kept(old: &str, title: &str) -> String {
    eprintln!("bytes: {title} stay as they are in the page");
    let row = old.lines().find(|line| line.starts_with(&format!("| {title} |")));
    row.map(|row| format!("{row}\n")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::kept;

    #[test]
    fn the_row_of_a_model_that_is_not_there_is_kept() {
        let old = "| bytes | model |\n|---|--:|\n| A | 1 |\n| B | 2 |\n";
        assert_eq!(kept(old, "B"), "| B | 2 |\n");
        assert_eq!(kept(old, "C"), "");
    }
}
