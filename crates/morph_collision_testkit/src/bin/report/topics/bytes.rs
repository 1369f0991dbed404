//! Bytes per triangle, in this library and in Parry's triangle mesh.

use std::error::Error;
use std::sync::Arc;

use morph_collision::{BuildOptions, MorphBvh, Pose};
use morph_collision_testkit::bench::Experiment;
use morph_collision_testkit::mesh::MorphMesh;
use parry3d::shape::TriMesh;
use serde::{Deserialize, Serialize};

use super::{Measure, Topic, faces, no_losses};
use crate::context::Context;
use crate::page::Page;
use crate::race::Source;
use crate::store::Store;
use crate::table::Table;

pub(super) const NAME: &str = "bytes";

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::OneCore(measure),
    page,
    losses: no_losses,
};

/// The memory of a mesh and of one of its bodies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bytes {
    pub(crate) scene: String,
    pub(crate) title: String,
    /// What grows in a series of scenes of the same name.
    pub(crate) size: Option<usize>,
    pub(crate) triangles: usize,
    pub(crate) targets: usize,
    pub(crate) model: usize,
    pub(crate) tree: usize,
    pub(crate) pose: usize,
    pub(crate) parry: usize,
    pub(crate) measured: String,
}

impl Bytes {
    /// The memory of a pose of an experiment's mesh, and of Parry's mesh of the same triangles.
    pub(crate) fn of(
        experiment: &Experiment,
        title: &str,
        pose: &Pose,
        measured: String,
    ) -> Result<Self, Box<dyn Error>> {
        let mesh = &experiment.mesh;
        Ok(Self {
            scene: experiment.name.clone(),
            title: title.to_owned(),
            size: None,
            triangles: mesh.triangles.len(),
            targets: mesh.targets.len(),
            model: pose.bvh().model().bytes(),
            tree: pose.bvh().bytes(),
            pose: pose.bytes(),
            parry: TriMesh::new(mesh.positions.clone(), mesh.triangles.clone())?.heap_memory_size(),
            measured,
        })
    }

    /// Where it is from, and what it is about.
    pub(crate) fn origin(&self) -> (&str, &str) {
        (&self.measured, &self.title)
    }

    /// Bytes of a triangle.
    pub(crate) fn each(&self, bytes: usize) -> f64 {
        (bytes as f64 / self.triangles as f64).round()
    }
}

/// A mesh's pose at rest.
pub(super) fn at_rest(mesh: &MorphMesh) -> Result<Pose, Box<dyn Error>> {
    let model = Arc::new(mesh.to_model()?);
    Ok(Pose::new(Arc::new(MorphBvh::build(model, &BuildOptions::default()))))
}

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let old: Vec<Bytes> = context.store.rows(NAME)?;
    let mut sources: Vec<_> = Experiment::tuning(context.every)
        .into_iter()
        .map(Source::from)
        .collect();
    sources.extend(faces::sources(context.every)?);
    for (name, _) in Experiment::walkers().take(1) {
        sources.push(Source::named(name, context.every)?);
    }
    let mut rows: Vec<Bytes> = Vec::new();
    for source in sources {
        match source {
            Source::Found(experiment) => {
                let title = experiment.title.split(',').next().unwrap_or_default();
                let mut pose = at_rest(&experiment.mesh)?;
                pose.refit();
                let row = Bytes::of(&experiment, title, &pose, context.origin.clone())?;
                let mesh = |row: &Bytes| (row.triangles, row.targets, row.model, row.tree);
                // Some scenes have the same mesh.
                if rows.iter().all(|other| mesh(other) != mesh(&row)) {
                    rows.push(row);
                }
            }
            Source::Missing { scene, reason } => {
                eprintln!("{NAME}: {reason}; its rows stay as they are");
                rows.extend(old.iter().filter(|row| row.scene == scene).cloned());
            }
        }
    }
    context.store.write(NAME, &rows)
}

const IF_TOO_MUCH: &str = "\
## If a flip-book takes too much memory

For each triangle that it moves, a target takes about 6 bytes in the model and 6 in the tree, however small the movement. In a flip-book, every
target moves every vertex. There are four ways to make one smaller:

- **Fewer targets.** Weights blend between neighbouring frames, so a clip often looks the same with every second frame. (With eight targets or
  fewer, the tree also stores the corners of triangles side by side, which takes more memory and less time.)
- **Fewer triangles.** Draw the detailed mesh, and collide with a coarse one whose targets have the same order and receive the same weights.
- **One mesh for each clip**, loaded only while it is played.
- **Joints instead of targets.** A skinned mesh takes no more memory for more clips (the walkers above).
";

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Bytes> = store.rows(NAME)?;
    let mut table = Table::new([
        "bytes for each triangle",
        "triangles",
        "targets",
        "model",
        "tree",
        "pose, refitted",
        "Parry's `TriMesh`",
    ]);
    for row in &rows {
        let counts = [row.triangles, row.targets].map(|count| count.to_string());
        let bytes = [row.model, row.tree, row.pose, row.parry].map(|bytes| row.each(bytes).to_string());
        table.row([row.title.clone()].into_iter().chain(counts).chain(bytes));
    }
    let page = Page {
        name: NAME,
        title: "Bytes",
        intro: "Heap bytes per triangle: `MorphModel::bytes`, `MorphBvh::bytes` and `Pose::bytes` next to `TriMesh::heap_memory_size`. The latter is Parry's own\n\
            count of a mesh: its vertices, its indices and its tree, without displacements. With ours, all bodies of a mesh share one model and one tree,\n\
            and each has a pose, here after `Pose::refit`. With Parry, each deforming body has its own mesh, and displacements come on top.\n\
            [Known data](known_data.md) has the memory of other methods, and [scale](scale.md) that of growing meshes.\n",
        command: "just report --only bytes",
        data: &[NAME],
        body: format!("{table}\n{IF_TOO_MUCH}"),
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(Bytes::origin)))
}
