//! What queries about motion cost: instructions, and pairs of features in recorded frames.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use morph_collision::motion::{MotionQuery, MovingBody};
use morph_collision::{Body, BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::motion::records::find_records;
use serde::{Deserialize, Serialize};

use super::{Measure, Topic, no_losses};
use crate::context::Context;
use crate::counts::{self, Count};
use crate::page::Page;
use crate::store::Store;
use crate::table::Table;

const NAME: &str = "motion";

const TOLERANCE: f64 = 1e-6;

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::OneCore(measure),
    page,
    losses: no_losses,
};

/// The work for a body that moves from one recorded frame to the next.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Recorded {
    frames: String,
    triangles: usize,
    contacts: usize,
    feature_tests: u64,
    exact: u64,
    measured: String,
}

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let files = match find_records("ccdp") {
        Ok(files) => files,
        Err(missing) => {
            eprintln!("{NAME}: {missing}; its rows stay as they are");
            return Ok(());
        }
    };
    let rows = files
        .iter()
        .map(|file| recorded(&file.with_extension("glb"), &context.origin));
    context.store.write(NAME, &rows.collect::<Result<Vec<_>, _>>()?)
}

fn recorded(model: &Path, measured: &str) -> Result<Recorded, Box<dyn Error>> {
    let meshes = read_meshes(model).map_err(Box::new)?;
    let mesh = meshes.first().ok_or_else(|| format!("{}: no mesh", model.display()))?;
    let bvh = Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default()));
    let (mut start, mut end) = (Pose::new(Arc::clone(&bvh)), Pose::new(bvh));
    end.set_weights(&[1.0])?;
    let place = WorldFromModel::IDENTITY;
    let body = MovingBody::new(Body::new(&mut start, &place), Body::new(&mut end, &place))?;
    let (mut query, mut contacts) = (MotionQuery::new(), Vec::new());
    query.all_within(body, TOLERANCE, &mut contacts);
    let stats = query.stats();
    Ok(Recorded {
        frames: model.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        triangles: mesh.triangles.len(),
        contacts: contacts.len(),
        feature_tests: stats.feature_tests,
        exact: stats.undecided_by_filter,
        measured: measured.to_owned(),
    })
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let (counts, rows): (Vec<Count>, Vec<Recorded>) = (store.rows(counts::MOTION)?, store.rows(NAME)?);
    let mut table = Table::new(["", "triangles", "contacts", "pairs of features tested", "exactly"]);
    for row in &rows {
        let numbers = [row.triangles, row.contacts].map(|number| number.to_string());
        let tests = [row.feature_tests, row.exact].map(|number| number.to_string());
        table.row([row.frames.clone()].into_iter().chain(numbers).chain(tests));
    }
    let page = Page {
        name: NAME,
        title: "Motion",
        intro: "What queries about a motion cost (`motion::MotionQuery`).\n",
        command: "just instructions-report; just report --only motion",
        data: &[counts::MOTION, NAME],
        body: format!(
            "## Next to a discrete query\n\n\
             Thousand instructions per step, weights and transforms included. Two dolphins of 9024 triangles change their shapes in every step. The second one\n\
             moves by a share of its length in each of 40 steps: five lengths away (*apart*), close *beside* the first one, or *through* it.\n\n\
             - *discrete* is `PairQuery::any` at the end of each step; *motion* and *first* are `MotionQuery::any` and `first` (tolerance 1e-3).\n\
             - *touch* columns count the steps in which the bodies touch, for a discrete query and for the motion. A body that passes through another within\n  \
               a step is found at any speed; the discrete query sees it only if a step happens to end inside.\n\
             - A query about a motion needs the bounds of two poses instead of one.\n\
             - `first` is expensive in a step in which two bodies pass all the way through each other, because their parts touch in very many pairs of\n  \
               features. It starts again for the time before each earlier contact, and does not visit nodes in the order of time.\n\n\
             {}\n\
             ## Recorded frames\n\n\
             Models with one target, each against itself, from one recorded frame of a simulation to the next. A test compares the contacts with the recording.\n\
             The last column counts the pairs that the filter leaves to exact arithmetic.\n\n{table}\n\
             `just motions` compares single pairs of features with exact arithmetic: a million random ones of every kind, and all recorded ones.\n",
            counts::table(&counts, "lengths in a step"),
        ),
        ..Page::default()
    };
    let recorded = rows.iter().map(|row| (row.measured.as_str(), row.frames.as_str()));
    Ok(page.about(counts.iter().map(Count::origin).chain(recorded)))
}
