//! Meshes that run into themselves: our query with certificates and without, and other methods.

use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;

use morph_collision::{BuildOptions, MorphBvh, TrianglePair};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::bench::{Stopwatch, median};
use morph_collision_testkit::moments::find_real_model;
use morph_collision_testkit::report::{NOTHING, Store, Table, ratio, short};
use morph_collision_testkit::rivals::within::{SelfMethod, SelfMethodKind, certify};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

use super::Topic;
use crate::report::comparison::AS_USUALLY_WRITTEN;
use crate::report::context::Context;
use crate::report::page::Page;

const NAME: &str = "self_collisions";

pub(super) const TOPIC: Topic = Topic::on_one_core(NAME, measure, page);

/// The files, and what is said of them.
const FACES: [(&str, &str); 3] = [
    ("mh_head_eyes_teeth_arkit52_dao.glb", "MakeHuman head"),
    ("ict_face_skin.glb", "ICT face"),
    ("mh_body_arkit52.glb", "MakeHuman body"),
];

/// How many frames are compared.
const FRAMES: usize = 20;

/// A method on a model.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Timed {
    model: String,
    triangles: usize,
    targets: usize,
    method: String,
    frames: usize,
    /// Pairs that intersect, per frame, and the work.
    found: f64,
    boxes: f64,
    vertices: f64,
    box_tests: f64,
    triangle_tests: f64,
    milliseconds: f64,
    ratio: f64,
    /// Of making certificates, once.
    proving_seconds: Option<f64>,
    measured: String,
}

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let mut rows = Vec::new();
    for (file, name) in FACES {
        match find_real_model(file) {
            Ok(path) => {
                let mesh = read_meshes(&path).map_err(Box::new)?.into_iter().next();
                let mesh = mesh.ok_or_else(|| format!("{file}: no mesh"))?;
                rows.extend(compare(context, name, &mesh)?);
            }
            Err(missing) => {
                eprintln!("{NAME}: {missing}; its rows stay as they are");
                let kept: Vec<Timed> = context.store.rows(NAME)?;
                rows.extend(kept.into_iter().filter(|row| row.model == name));
            }
        }
    }
    context.store.write(NAME, &rows)
}

/// Weights of captured expressions, or, without a clip, mixtures of a few targets.
fn frames(mesh: &MorphMesh) -> Vec<Vec<f32>> {
    let targets = mesh.targets.len();
    let mut rng = Pcg64Mcg::seed_from_u64(26);
    let weights = |frame: usize| match mesh.animations.first() {
        Some(clip) => {
            let mut weights = clip.sample(clip.duration() * frame as f32 / FRAMES as f32);
            weights.resize(targets, 0.0);
            weights
        }
        None => {
            let mut weights = vec![0.0; targets];
            for _ in 0..6 {
                weights[rng.random_range(0..targets)] = rng.random_range(0.0..=1.0);
            }
            weights
        }
    };
    (0..FRAMES).map(weights).collect()
}

/// Rounds in which every method runs all frames, in turns. All pairs are compared in one round only.
fn compare(context: &Context, name: &str, mesh: &MorphMesh) -> Result<Vec<Timed>, Box<dyn Error>> {
    let frames = frames(mesh);
    let mut methods = Vec::new();
    for kind in SelfMethodKind::ALL {
        methods.push(Contender {
            kind,
            method: kind.set_up(mesh)?,
            times: Vec::new(),
            pairs: Vec::new(),
        });
    }
    for round in 0..=context.rounds {
        for contender in &mut methods {
            if contender.kind != SelfMethodKind::BruteForce || round == context.rounds {
                contender.run(&frames, round > 0)?;
            }
        }
    }
    let tree = Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default()));
    let watch = Stopwatch::start();
    certify(&tree)?;
    let proving = watch.elapsed().as_secs_f64();
    let ours = methods[0].pairs.clone();
    if let Some(other) = methods.iter().find(|other| other.pairs != ours) {
        return Err(format!("{name}: {} finds other pairs", other.kind).into());
    }
    let first = methods[0].times.clone();
    let per_frame = |count: u64, passes: usize| short(count as f64 / (passes * FRAMES) as f64);
    Ok(methods
        .iter()
        .map(|contender| {
            let Contender {
                kind, method, times, ..
            } = contender;
            let is_once = *kind == SelfMethodKind::BruteForce;
            let passes = if is_once { 1 } else { context.rounds + 1 };
            let work = method.work();
            let time = median(times.iter().copied());
            // In turns, so rounds are compared with each other.
            let ratios = times.iter().rev().zip(first.iter().rev());
            Timed {
                model: name.to_owned(),
                triangles: mesh.triangles.len(),
                targets: mesh.targets.len(),
                method: kind.to_string(),
                frames: FRAMES,
                found: per_frame(ours.len() as u64, 1),
                boxes: per_frame(work.nodes_blended, passes),
                vertices: per_frame(work.vertices_blended, passes),
                box_tests: per_frame(work.node_tests, passes),
                triangle_tests: per_frame(work.triangle_tests, passes),
                milliseconds: short(1e3 * time / FRAMES as f64),
                ratio: short(median(ratios.map(|(own, first)| own / first))),
                proving_seconds: (*kind == SelfMethodKind::Certified).then(|| short(proving)),
                measured: context.timed(1, context.rounds),
            }
        })
        .collect())
}

struct Contender {
    kind: SelfMethodKind,
    method: Box<dyn SelfMethod>,
    /// Seconds of all frames, per round.
    times: Vec<f64>,
    /// Sorted, of all frames.
    pairs: Vec<TrianglePair>,
}

impl Contender {
    fn run(&mut self, frames: &[Vec<f32>], is_timed: bool) -> Result<(), Box<dyn Error>> {
        let (mut found, mut seconds) = (Vec::new(), 0.0);
        self.pairs.clear();
        for weights in frames {
            found.clear();
            let watch = Stopwatch::start();
            self.method.find(black_box(weights), &mut found)?;
            seconds += watch.elapsed().as_secs_f64();
            found.sort_unstable();
            self.pairs.extend_from_slice(&found);
        }
        if is_timed {
            self.times.push(seconds);
        }
        Ok(())
    }
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Timed> = store.rows(NAME)?;
    let body = format!(
        "## Time\n\nMilliseconds per frame in the first column, and how many times as long the others take.\n\n{}\n## Work of a frame\n\n{}\n\
         ## Making certificates\n\nThey are proved once per mesh, on any number of threads, and stored with the tree. One run on one thread:\n\n{}",
        times(&rows),
        work(&rows),
        proving(&rows)
    );
    let page = Page {
        name: NAME,
        title: "Meshes that run into themselves",
        intro: "All pairs of intersecting triangles of one mesh, in every frame with new weights (`SelfQuery::all`). All methods find the same pairs.\n\
            \n\
            - *Certified* is our query on a tree with certificates for all weights from 0 to 1: pairs that are proved free are left out, and leaves\n  \
              that have no other pairs are not blended (`MorphBvh::set_certificates`).\n\
            - *No certificates* is the same query on a tree without.\n\
            - *Refit* (`bottom-up`) is our query after all boxes were fitted to the posed vertices (`Pose::refit`).\n\
            - *As usually written*: in plain code, blend every vertex, refit an eight-wide tree bottom up, and walk over it and itself.\n\
            - *Binary tree* is what one does with three-mesh-bvh, in Rust: blend every vertex, refit a binary tree with ten triangles in a leaf, split in the\n  \
              middle, and walk over it and itself one box at a time.\n\
            - *Brute force* compares the boxes of all pairs of triangles, in one round.\n\
            - The last three compute the boxes of all triangles, and reject pairs by them before anything else.\n\
            - The head and the ICT face play captured expressions; the body has mixtures of up to six targets.\n\
            \n\
            In the counts, a pair of triangles is tested if their boxes overlap; ours has a vertex once for each leaf in\n\
            which it is blended.\n",
        body,
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(|row| (row.measured.as_str(), row.model.as_str()))))
}

/// The rows of each model.
fn models(rows: &[Timed]) -> impl Iterator<Item = &[Timed]> {
    rows.chunk_by(|a, b| a.model == b.model)
}

fn title(of_model: &[Timed]) -> String {
    let row = &of_model[0];
    format!("{}, {} triangles, {} targets", row.model, row.triangles, row.targets)
}

fn times(rows: &[Timed]) -> Table {
    let others = [
        ("no certificates", SelfMethodKind::Morph),
        ("refit", SelfMethodKind::BottomUp),
        (AS_USUALLY_WRITTEN, SelfMethodKind::BottomUpScalar),
        ("binary tree", SelfMethodKind::Binary),
        ("brute force", SelfMethodKind::BruteForce),
    ];
    let mut table = Table::new(["", "certified, ms"].into_iter().chain(others.map(|(title, _)| title)));
    for of_model in models(rows) {
        let row = |kind: SelfMethodKind| of_model.iter().find(|row| row.method == kind.to_string());
        let certified = row(SelfMethodKind::Certified).map(|row| format!("{:.2}", row.milliseconds));
        let others = others.map(|(_, kind)| row(kind).map(|row| ratio(row.ratio)));
        let cells = [certified].into_iter().chain(others);
        let cells = cells.map(|cell| cell.unwrap_or(NOTHING.to_owned()));
        table.row(std::iter::once(title(of_model)).chain(cells));
    }
    table
}

fn work(rows: &[Timed]) -> Table {
    let mut table = Table::new([
        "",
        "method",
        "boxes computed",
        "vertices",
        "box tests",
        "triangle tests",
        "pairs found",
    ]);
    for row in rows {
        let counts = [row.boxes, row.vertices, row.box_tests, row.triangle_tests, row.found];
        let counts = counts.map(|count| format!("{count:.0}"));
        table.row([row.model.clone(), row.method.clone()].into_iter().chain(counts));
    }
    table
}

fn proving(rows: &[Timed]) -> Table {
    let mut table = Table::new(["", "seconds"]);
    for row in rows {
        if let Some(seconds) = row.proving_seconds {
            table.row([row.model.clone(), format!("{seconds:.1}")]);
        }
    }
    table
}
