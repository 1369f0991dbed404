//! Models that are well known: time, tightness of the bounds and memory of the methods in one place.

use std::error::Error;

use morph_collision::{JointMatrices, Pose};
use morph_collision_testkit::bench::{Experiment, Questions};
use morph_collision_testkit::rivals::{JointNodes, MethodOptions, PaperNodes, Wanted};
use morph_collision_testkit::tightness::{self, Tightness};
use serde::{Deserialize, Serialize};

use super::bytes::at_rest;
use super::{Measure, Topic, faces, no_losses, skinned};
use crate::candidates::{self, Candidate};
use crate::context::Context;
use crate::page::Page;
use crate::race::Source;
use crate::record::{ALL, FIRST, Record, scene};
use crate::store::Store;
use crate::table::{NOTHING, Table, ratios, short};

const NAME: &str = "known_data";

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::OneCore(measure),
    page,
    losses: no_losses,
};

/// The scenes, with the origin of each model.
const SCENES: [(&str, &str); 4] = [
    (
        "horse-gallop",
        "`horse-gallop`: a flip-book, R. W. Sumner and J. Popovic, *Deformation transfer for triangle meshes*, SIGGRAPH 2004.",
    ),
    (
        "samba",
        "`samba`: a flip-book, D. Vlasic and others, *Articulated mesh animation from multi-view silhouettes*, SIGGRAPH 2008.",
    ),
    (
        "heads-cheek",
        "`mh_head_eyes_teeth_arkit52`: a MakeHuman head with the 52 targets of ARKit.",
    ),
    (
        "walkers-hands",
        "`mh_character`: a MakeHuman character with 53 joints and the 52 targets of ARKit.",
    ),
];

/// The methods of this page.
const METHODS: [&str; 6] = ["morph", "hybrid", "bottom-up", "parry-trimesh", "paper", "joint-boxes"];

/// How tight the boxes of a method are in a scene, and how much memory it needs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Known {
    scene: String,
    method: String,
    triangles: usize,
    /// The cost of all boxes over that of the smallest ones.
    tightness: f64,
    /// Bytes, if the method counts them.
    shared: Option<usize>,
    body: Option<usize>,
    measured: String,
}

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let old: Vec<Known> = context.store.rows(NAME)?;
    let mut rows = Vec::new();
    for (scene, _) in SCENES {
        match Source::named(scene, context.every)? {
            Source::Found(experiment) => {
                eprintln!("{NAME}: {}", experiment.title);
                let methods = candidates::methods(&experiment);
                for candidate in methods
                    .iter()
                    .filter(|candidate| METHODS.contains(&candidate.label.as_str()))
                {
                    rows.push(known(&experiment, candidate, &context.origin)?);
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

fn known(experiment: &Experiment, candidate: &Candidate, measured: &str) -> Result<Known, Box<dyn Error>> {
    let mut method = candidate.set_up(experiment)?.method;
    let mut questions = Questions::default();
    for frame in 0..experiment.frames.len() {
        experiment.set_bodies(method.as_mut(), frame)?;
        questions.ask(experiment, frame, method.as_mut(), Wanted::All);
    }
    let bytes = method.bytes(0);
    let tightness = tightness_of(experiment, &candidate.label)?;
    Ok(Known {
        scene: experiment.name.clone(),
        method: candidate.label.clone(),
        triangles: experiment.mesh.triangles.len(),
        tightness: tightness.map_or(1.0, |sum| short(sum.ratio())),
        shared: bytes.map(|bytes| bytes.shared),
        body: bytes.map(|bytes| bytes.body),
        measured: measured.to_owned(),
    })
}

/// The boxes of a method in all frames; `None` if it fits them to the vertices.
fn tightness_of(experiment: &Experiment, method: &str) -> Result<Option<Tightness>, Box<dyn Error>> {
    let mesh = &experiment.mesh;
    let mut pose = at_rest(mesh)?;
    Ok(match method {
        "morph" => Some(in_all_frames(experiment, &mut pose, |_, pose, corners| {
            tightness::of_pose(pose, corners)
        })?),
        "paper" => {
            let nodes = PaperNodes::new(mesh)?;
            Some(in_all_frames(experiment, &mut pose, |(frame, body), _, corners| {
                let weights = &experiment.frames[frame][body].0;
                tightness::of_nodes(corners, |visitor| nodes.visit(weights, visitor))
            })?)
        }
        "joint-boxes" => {
            let nodes = JointNodes::new(mesh, false, &MethodOptions::default())?;
            Some(in_all_frames(experiment, &mut pose, |(frame, body), _, corners| {
                let weights = &experiment.frames[frame][body].0;
                let joints = experiment.joints_of(frame, body).unwrap_or_default();
                tightness::of_nodes(corners, |visitor| nodes.visit(weights, joints, visitor))
            })?)
        }
        _ => None,
    })
}

/// The sum over all bodies in all frames, which are counted in this order.
fn in_all_frames(
    experiment: &Experiment,
    pose: &mut Pose,
    tightness: impl Fn((usize, usize), &mut Pose, &[[glam::DVec3; 3]]) -> Tightness,
) -> Result<Tightness, Box<dyn Error>> {
    let mut sum = Tightness::default();
    for (frame, bodies) in experiment.frames.iter().enumerate() {
        for (body, (weights, _)) in bodies.iter().enumerate() {
            if let Some(joints) = experiment.joints_of(frame, body) {
                pose.set_joints(&JointMatrices::new(joints)?)?;
            }
            pose.set_weights(weights)?;
            let corners = tightness::corners(pose);
            sum.add(&tightness((frame, body), pose, &corners));
        }
    }
    Ok(sum)
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Known> = store.rows(NAME)?;
    let mut times: Vec<Record> = store.rows(faces::NAME)?;
    times.extend(store.rows::<Record>(skinned::NAME)?);
    let mut body = String::new();
    for (name, origin) in SCENES {
        let (of_scene, known) = (scene(&times, name), |method: &str| {
            rows.iter().find(move |row| row.scene == name && row.method == method)
        });
        let Some(of_scene) = of_scene else { continue };
        let mut table = Table::new([
            "",
            "time: all pairs / first pairs",
            "boxes over smallest",
            "shared bytes for each triangle",
            "bytes of a body for each triangle",
        ]);
        for method in METHODS {
            let time = ratios([ALL, FIRST].map(|wanted| of_scene.ratio(method, wanted)));
            if time == NOTHING {
                continue;
            }
            let tightness = known(method).map_or(NOTHING.to_owned(), |row| format!("{:.2}", row.tightness));
            let bytes = |of: fn(&Known) -> Option<usize>| {
                let each = known(method).and_then(|row| Some(of(row)? as f64 / row.triangles as f64));
                each.map_or(NOTHING.to_owned(), |each| format!("{each:.0}"))
            };
            table.row([
                method.to_owned(),
                time,
                tightness,
                bytes(|row| row.shared),
                bytes(|row| row.body),
            ]);
        }
        body += &format!("\n**{}.**\n{origin}\n\n{table}", of_scene.title());
    }
    let page = Page {
        name: NAME,
        title: "Known data",
        intro: "Models that the field knows, each in a scene of two bodies, with the best methods of each kind.\n\
            \n\
            - *Time* is a ratio to ours, from the pages about [faces and flip-books](faces.md) and [skinned characters](skinned.md): all methods in turns in\n  \
              one run.\n\
            - *Boxes over smallest* is the cost of a tree's boxes by the surface-area heuristic, over that of the smallest boxes of the same nodes, in all\n  \
              frames of the scene. Methods that refit (`hybrid`, `bottom-up`, Parry's) fit boxes to the vertices, so theirs is 1. Smaller boxes in a\n  \
              different tree can still cost more or less: the ratio compares a tree with itself.\n\
            - *Shared bytes* are those of the mesh, its displacements and its tree, *bytes of a body* those that each further body needs, after the frames\n  \
              of the scene with all pairs. Parry's own count is used for its mesh. \"-\" means that the method does not count its memory.\n",
        command: "just report --only known_data",
        data: &[NAME, faces::NAME, skinned::NAME],
        body,
        ..Page::default()
    };
    let shown = times
        .iter()
        .filter(|row| SCENES.iter().any(|(scene, _)| *scene == row.scene));
    let bounds = rows.iter().map(|row| (row.measured.as_str(), "tightness and memory"));
    Ok(page.about(shown.map(Record::origin).chain(bounds)))
}
