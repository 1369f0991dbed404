//! The table of recorded frames: the walk, which finds its pairs itself, beside the tests of the pairs that a recording lists.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use morph_collision::motion::{MotionQuery, MovingBody, StageCounts};
use morph_collision::{Body, BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::motion::records::FramePair;

use super::features::recorded_pairs;
use super::timing::{TOLERANCE, median_seconds};

/// A row for each recording.
pub(crate) fn table(pairs: &[PathBuf], rounds: usize) -> Result<String, Box<dyn Error>> {
    let mut text = String::from(
        "| | triangles | walk: contacts | pairs tested | exactly | ms | list: contacts | pairs tested | exactly | ms |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for path in pairs {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let (triangles, walk) = walk(&path.with_extension("glb"), rounds)?;
        let list = list(path, rounds)?;
        text += &format!("| {name} | {triangles} | {walk} | {list} |\n");
    }
    Ok(text)
}

/// The number of triangles, and all contacts of the mesh with itself: its boxes and vertices are computed anew.
fn walk(model: &Path, rounds: usize) -> Result<(usize, String), Box<dyn Error>> {
    let meshes = read_meshes(model).map_err(Box::new)?;
    let mesh = meshes.first().ok_or_else(|| format!("{}: no mesh", model.display()))?;
    let bvh = Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default()));
    let world = WorldFromModel::IDENTITY;
    let (mut query, mut contacts) = (MotionQuery::new(), Vec::new());
    let mut fresh = [Pose::new(bvh.clone()), Pose::new(bvh.clone())];
    fresh[1].set_weights(&[1.0])?;
    let mut failure = Ok(());
    let milliseconds = 1e3
        * median_seconds(
            rounds,
            || fresh.clone(),
            |[mut start, mut end]| {
                contacts.clear();
                let [start, end] = [Body::new(&mut start, &world), Body::new(&mut end, &world)];
                match MovingBody::new(start, end) {
                    Ok(body) => query.all_within(body, TOLERANCE, &mut contacts),
                    Err(error) => failure = Err(error),
                }
            },
        );
    failure?;
    let (found, stats) = (contacts.len(), query.stats());
    let cells = format!(
        "{found} | {} | {} | {milliseconds:.1}",
        stats.feature_tests, stats.undecided_by_filter
    );
    Ok((bvh.model().triangle_count(), cells))
}

/// The pairs that the recording lists, each tested.
fn list(path: &Path, rounds: usize) -> Result<String, Box<dyn Error>> {
    let listed = recorded_pairs(&FramePair::read(path)?)?;
    let test = || {
        let mut stages = StageCounts::default();
        let touching = listed.iter().filter(|features| features.impact(&mut stages).is_some());
        (touching.count(), stages)
    };
    let milliseconds = 1e3 * median_seconds(rounds, || (), |()| test());
    let (touching, stages) = test();
    Ok(format!(
        "{touching} | {} | {} | {milliseconds:.1}",
        stages.total(),
        stages.exact
    ))
}
