//! Every method on captured faces that press against each other, on talking heads and on flip-book characters.

use std::error::Error;
use std::f64::consts::{PI, TAU};

use glam::{Affine3A, DQuat, DVec3};
use morph_collision::Aabb;
use morph_collision_models::clip::looped;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::bench::Experiment;
use morph_collision_testkit::moments::find_real_model;

use super::EveryMethod;
use crate::report::race::Source;

/// The files of captured faces, with the names and titles of their scenes.
const CAPTURED: [(&str, (&str, &str)); 2] = [
    ("mh_head_eyes_teeth_arkit52_dao.glb", ("heads-press", "MakeHuman heads")),
    ("ict_face_skin.glb", ("ict-faces-press", "ICT faces")),
];

pub(super) struct Faces;

impl EveryMethod for Faces {
    const NAME: &'static str = "faces";
    const TITLE: &'static str = "Faces and flip-books";
    const INTRO: &'static str = "Models by other people.\n\
        \n\
        - Two heads press their faces together and separate, while each plays captured expressions: many targets, most of them active, with weights\n  \
          that sum to about 10.\n\
        - Two talking heads touch at their cheeks, and twelve talk in a crowd.\n\
        - Two galloping horses and two dancers pass through each other. They are flip-books: a target for every recorded frame, two of them active.\n\
        - Models with many targets have no patches of corners, so our queries gather the corners of leaves from blended vertices.\n";

    fn sources(every: usize) -> Result<Vec<Source>, Box<dyn Error>> {
        let mut sources = Vec::new();
        for (file, name) in CAPTURED {
            sources.push(match find_real_model(file) {
                Ok(path) => {
                    let mesh = read_meshes(&path).map_err(Box::new)?.into_iter().next();
                    heads(name, mesh.ok_or_else(|| format!("{file}: no mesh"))?, every).into()
                }
                Err(missing) => Source::Missing {
                    scene: name.0.to_owned(),
                    reason: missing.to_string(),
                },
            });
        }
        for (name, _) in Experiment::characters().filter(|scene| Experiment::walkers().all(|walkers| walkers != *scene))
        {
            sources.push(Source::named(name, every)?);
        }
        Ok(sources)
    }
}

/// Two heads that face each other, press their faces together and come apart twice in 400 steps, while each plays its clip.
fn heads((name, title): (&str, &str), mesh: MorphMesh, every: usize) -> Experiment {
    let bounds = Aabb::from_points(mesh.positions.iter().copied());
    let (size, middle) = (bounds.size().as_dvec3(), bounds.center());
    let clip = mesh.animations.first().cloned().unwrap_or_default();
    let targets = mesh.targets.len();
    let frame = |step: usize| {
        let t = step as f64 / 400.0;
        let apart = size.z * (0.93 + 0.09 * (2.0 * TAU * t).cos());
        let body = |turn: f64, z: f64, ahead: f64| {
            let mut weights = clip.sample(looped(
                ((t + ahead) * f64::from(clip.duration())) as f32,
                clip.duration(),
            ));
            weights.resize(targets, 0.0);
            let turned = DQuat::from_rotation_y(turn).as_quat();
            let place = Affine3A::from_rotation_translation(turned, DVec3::new(0.0, 0.0, z).as_vec3());
            (weights, place * Affine3A::from_translation(-middle))
        };
        vec![body(0.0, 0.0, 0.0), body(PI, apart, 0.37)]
    };
    let steps: Vec<usize> = (0..400).step_by(every).collect();
    Experiment {
        joints: Vec::new(),
        rays: Vec::new(),
        name: name.to_owned(),
        title: format!("{title}, 2 x {} triangles with {targets} targets", mesh.triangles.len()),
        bodies: 2,
        frames: steps.iter().map(|&step| frame(step)).collect(),
        steps,
        mesh,
    }
}
