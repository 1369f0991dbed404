//! Recorded frames: the walk, which finds its pairs itself, beside the tests of the pairs that a recording lists.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use morph_collision::motion::{MotionQuery, MovingBody, StageCounts};
use morph_collision::{Body, BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_testkit::motion::records::FramePair;
use morph_collision_testkit::report::Table;
use serde::{Deserialize, Serialize};

use super::features::recorded_pairs;
use super::timing::{TOLERANCE, median_seconds};

/// A body that moves from one recorded frame to the next, and how it is tested against itself.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Recorded {
    pub(super) frames: String,
    triangles: usize,
    way: String,
    contacts: usize,
    tested: u64,
    exactly: u64,
    milliseconds: f64,
    pub(super) measured: String,
}

/// Two rows for each recording: the walk and the list.
///
/// # Errors
/// A recording or its model cannot be read.
pub(super) fn measure(pairs: &[PathBuf], rounds: usize, measured: &str) -> Result<Vec<Recorded>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for path in pairs {
        let walk = walk(&path.with_extension("glb"), rounds)?;
        let list = Recorded {
            triangles: walk.triangles,
            ..list(path, rounds)?
        };
        rows.extend([walk, list].map(|row| Recorded {
            frames: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            measured: measured.to_owned(),
            ..row
        }));
    }
    Ok(rows)
}

/// All contacts of the mesh with itself: its boxes and vertices are computed anew.
fn walk(model: &Path, rounds: usize) -> Result<Recorded, Box<dyn Error>> {
    let meshes = read_meshes(model).map_err(Box::new)?;
    let mesh = meshes.first().ok_or_else(|| format!("{}: no mesh", model.display()))?;
    let bvh = Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default()));
    let world = WorldFromModel::IDENTITY;
    let (mut query, mut contacts) = (MotionQuery::new(), Vec::new());
    let mut fresh = [Pose::new(bvh.clone()), Pose::new(bvh.clone())];
    fresh[1].set_weights(&[1.0])?;
    let mut failure = Ok(());
    let seconds = median_seconds(
        rounds,
        || fresh.clone(),
        |[mut start, mut end]| {
            contacts.clear();
            let [start, end] = [Body::new(&mut start, &world), Body::new(&mut end, &world)];
            let walk = || -> Result<(), Box<dyn Error>> {
                Ok(query.all_within(MovingBody::new(start, end)?, TOLERANCE, &mut contacts)?)
            };
            if let Err(error) = walk() {
                failure = Err(error);
            }
        },
    );
    failure?;
    let stats = query.stats();
    Ok(Recorded {
        frames: String::new(),
        triangles: bvh.model().triangle_count(),
        way: "walk".to_owned(),
        contacts: contacts.len(),
        tested: stats.feature_tests,
        exactly: stats.exact_feature_tests,
        milliseconds: 1e3 * seconds,
        measured: String::new(),
    })
}

/// The pairs that the recording lists, each tested.
fn list(path: &Path, rounds: usize) -> Result<Recorded, Box<dyn Error>> {
    let listed = recorded_pairs(&FramePair::read(path)?)?;
    let test = || {
        let mut stages = StageCounts::default();
        let touching = listed.iter().filter(|features| features.impact(&mut stages).is_some());
        (touching.count(), stages)
    };
    let seconds = median_seconds(rounds, || (), |()| test());
    let (contacts, stages) = test();
    Ok(Recorded {
        frames: String::new(),
        triangles: 0,
        way: "list".to_owned(),
        contacts,
        tested: stages.total(),
        exactly: stages.exact,
        milliseconds: 1e3 * seconds,
        measured: String::new(),
    })
}

/// The table of the page.
pub(super) fn table(rows: &[Recorded]) -> Table {
    let mut table = Table::new(["", "triangles", "way", "contacts", "pairs tested", "exactly", "ms"]);
    for row in rows {
        table.row([
            row.frames.clone(),
            row.triangles.to_string(),
            row.way.clone(),
            row.contacts.to_string(),
            row.tested.to_string(),
            row.exactly.to_string(),
            format!("{:.1}", row.milliseconds),
        ]);
    }
    table
}
