//! Every method on captured faces that press against each other, and on the scenes of talking heads and flip-book characters.

use std::error::Error;
use std::f64::consts::{PI, TAU};

use glam::{Affine3A, DQuat, DVec3};
use morph_collision::Aabb;
use morph_collision_testkit::bench::{Experiment, NoExperiment};
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::moments::real_model;
use morph_collision_testkit::rivals::Wanted;

use super::{Context, race};
use crate::render;
use crate::sweeps::methods;

/// Faces by other people, and their titles.
pub(super) const FACES: [(&str, &str); 2] = [
    ("mh_head_eyes_teeth_arkit52_dao.glb", "MakeHuman heads"),
    ("ict_face_skin.glb", "ICT faces"),
];

/// A table for each face and character. The table of a missing model stays as it is in the page.
pub(crate) fn faces(context: &Context, old: &str) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    for (file, title) in FACES {
        let Some(mesh) = face(file)? else {
            eprintln!("faces: {title} stay as they are in the page");
            text += &kept(old, title);
            continue;
        };
        text += &table(&heads(title, mesh, context.every), context)?;
    }
    for (name, title) in Experiment::characters() {
        match Experiment::named(name, context.every) {
            Ok(experiment) => text += &table(&experiment, context)?,
            Err(missing @ NoExperiment::Missing { .. }) => {
                eprintln!("faces: {missing}; {title} stay as they are in the page");
                text += &kept(old, title);
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(text)
}

/// The mesh of a face, if its file exists.
pub(super) fn face(file: &str) -> Result<Option<MorphMesh>, Box<dyn Error>> {
    let Some(path) = real_model(file) else {
        return Ok(None);
    };
    let meshes = read_meshes(&path).map_err(Box::new)?;
    let mesh = meshes.into_iter().next().ok_or_else(|| format!("{file}: no mesh"))?;
    Ok(Some(mesh))
}

fn table(experiment: &Experiment, context: &Context) -> Result<String, Box<dyn Error>> {
    eprintln!("faces: {}", experiment.title);
    let candidates = methods(experiment);
    let all = race(experiment, &candidates, Wanted::All, context.rounds)?;
    let first = race(experiment, &candidates, Wanted::First, context.rounds)?;
    Ok(render::table(experiment, &all, &first))
}

/// The part of a section about a scene: from its heading to the next.
pub(super) fn kept(old: &str, title: &str) -> String {
    let heading = format!("\n**{title},");
    let Some(start) = old.find(&heading) else {
        return String::new();
    };
    let end = old[start + 1..].find("\n**").map_or(old.len(), |end| start + 1 + end);
    old[start..end].to_owned()
}

/// Two heads that face each other, press their faces together and come apart twice in 400 steps, while each plays its clip.
fn heads(title: &str, mesh: MorphMesh, every: usize) -> Experiment {
    let bounds = Aabb::from_points(mesh.positions.iter().copied());
    let (size, middle) = (bounds.size().as_dvec3(), bounds.center());
    let clip = mesh.animations.first().cloned().unwrap_or_default();
    let targets = mesh.targets.len();
    let frame = |step: usize| {
        let t = step as f64 / 400.0;
        let apart = size.z * (0.93 + 0.09 * (2.0 * TAU * t).cos());
        let body = |turn: f64, z: f64, ahead: f64| {
            let mut weights = clip.sample(((t + ahead) * f64::from(clip.duration())) as f32);
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
        name: title.to_owned(),
        title: format!("{title}, 2 x {} triangles with {targets} targets", mesh.triangles.len()),
        bodies: 2,
        frames: steps.iter().map(|&step| frame(step)).collect(),
        steps,
        mesh,
    }
}

#[cfg(test)]
mod tests {
    use super::kept;

    #[test]
    fn the_part_about_a_face_is_kept_to_the_next_heading() {
        let old = "\nintro\n\n**A, 2 x 3.** x\n\n| row |\n\n**B, 2 x 4.** y\n| last |\n";
        assert_eq!(kept(old, "A"), "\n**A, 2 x 3.** x\n\n| row |\n");
        assert_eq!(kept(old, "B"), "\n**B, 2 x 4.** y\n| last |\n");
        assert_eq!(kept(old, "C"), "");
    }
}
