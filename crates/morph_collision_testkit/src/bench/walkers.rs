//! Scenes of a skinned character that walks and talks. Joints and face move in every frame.

use std::f64::consts::TAU;

use glam::{Affine3A, DQuat, DVec3};

use super::characters::{NoExperiment, STEPS};
use super::rays::rays_at;
use super::{Experiment, Frame};
use crate::moments::find_real_model;
use morph_collision_models::clip::looped;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;

const MODEL: &str = "mh_character.glb";
const CLIP: &str = "walk_and_talk";

/// How far each body is ahead of the one before it, in loops of the clip.
const AHEAD: f64 = 0.37;

/// Loops of the clip in the whole script: 400 steps at 60 a second, of 3 s each. Slightly off, so that frames lie between keys.
const LOOPS: f64 = 2.23;

/// Half the size of the box that rays aim at, around the middle of a character: head to feet, without arms.
const BODY: DVec3 = DVec3::new(0.7, 7.0, 0.7);

/// The motion of a scene's bodies.
pub(super) struct Walkers {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    bodies: usize,
    /// Number of rays cast at each body in a frame.
    pub(super) rays: usize,
    /// The placement of a body, from its index and the share of the script, in decimetres.
    place: fn(usize, f64) -> Affine3A,
}

pub(super) const WALKERS: [Walkers; 5] = [
    Walkers {
        name: "walkers-hands",
        title: "Walkers whose hands touch",
        bodies: 2,
        rays: 0,
        place: side_by_side,
    },
    Walkers {
        name: "walkers-deep",
        title: "Walkers deep in each other",
        bodies: 2,
        rays: 0,
        place: into_each_other,
    },
    Walkers {
        name: "walkers-crowd",
        title: "Walkers in a crowd",
        bodies: 12,
        rays: 0,
        place: crowd,
    },
    Walkers {
        name: "walkers-ray",
        title: "A walker and a ray",
        bodies: 1,
        rays: 1,
        place: side_by_side,
    },
    Walkers {
        name: "walkers-rays",
        title: "A walker and rays",
        bodies: 1,
        rays: 100,
        place: side_by_side,
    },
];

fn standing(at: DVec3, turn: f64) -> Affine3A {
    Affine3A::from_rotation_translation(DQuat::from_rotation_y(turn).as_quat(), at.as_vec3())
}

/// Just so far apart that swinging arms sometimes touch.
fn side_by_side(index: usize, t: f64) -> Affine3A {
    let side = if index == 0 { -1.0 } else { 1.0 };
    standing(DVec3::new(side * (2.3 + 0.3 * (TAU * t).sin()), 0.0, 0.0), 0.1 * side)
}

/// Face to face, a hand's width apart from chest to chest, then closer.
fn into_each_other(index: usize, t: f64) -> Affine3A {
    let side = if index == 0 { -1.0 } else { 1.0 };
    let at = DVec3::new(0.3 * side, 0.0, side * (0.5 + 0.3 * (TAU * t).sin()));
    standing(at, if index == 0 { 0.0 } else { TAU / 2.0 })
}

/// Three rows of four, shoulder to shoulder.
fn crowd(index: usize, t: f64) -> Affine3A {
    let (row, column) = ((index / 4) as f64, (index % 4) as f64);
    let sway = 0.3 * (TAU * (t + 0.19 * index as f64)).sin();
    let at = DVec3::new((column - 1.5) * 5.2 + sway, 0.0, (row - 1.0) * 3.4 + 0.5 * sway);
    standing(at, 0.4 * (1.7 * index as f64).sin())
}

impl Walkers {
    pub(super) fn experiment(&self, every: usize) -> Result<Experiment, NoExperiment> {
        let path = find_real_model(MODEL).map_err(|missing| NoExperiment::Missing {
            scene: self.name,
            missing,
        })?;
        let meshes = read_meshes(&path).map_err(Box::new)?;
        let mesh = meshes.into_iter().next().ok_or_else(|| self.unusable("mesh"))?;
        self.of_mesh(mesh, every)
    }

    fn of_mesh(&self, mesh: MorphMesh, every: usize) -> Result<Experiment, NoExperiment> {
        let skeleton = &mesh.skin.as_ref().ok_or_else(|| self.unusable("skin"))?.skeleton;
        let of_joints = skeleton.clip(CLIP).ok_or_else(|| self.unusable("clip of joints"))?;
        let of_face = mesh.animations.iter().find(|clip| clip.name == CLIP);
        let targets = mesh.targets.len();
        let of_face = of_face.filter(|clip| clip.weights.iter().all(|weights| weights.len() == targets));
        let of_face = of_face.ok_or_else(|| self.unusable("clip of weights"))?;
        let steps: Vec<usize> = (0..STEPS).step_by(every.max(1)).collect();
        let duration = f64::from(of_joints.duration());
        let (mut frames, mut joints, mut rays) = (Vec::new(), Vec::new(), Vec::new());
        for &step in &steps {
            let t = step as f64 / STEPS as f64;
            let (mut frame, mut of_bodies) = (Frame::new(), Vec::new());
            for body in 0..self.bodies {
                let seconds = ((LOOPS * t + AHEAD * body as f64) * duration) as f32;
                let of_face_seconds = looped(seconds, of_face.duration());
                let seconds = looped(seconds, of_joints.duration());
                let place = (self.place)(body, t);
                let world_from_mesh = skeleton.world_from_mesh(Some(of_joints), seconds);
                of_bodies.push(world_from_mesh.into_iter().map(|joint| place * joint).collect());
                frame.push((of_face.sample(of_face_seconds), Affine3A::IDENTITY));
            }
            if self.rays > 0 {
                let at = (self.place)(0, t).translation.as_dvec3();
                rays.push(rays_at(at + DVec3::Z * 0.6, BODY, step, self.rays));
            }
            frames.push(frame);
            joints.push(of_bodies);
        }
        let triangles = mesh.triangles.len();
        let joint_count = skeleton.joints.len();
        Ok(Experiment {
            name: self.name.to_owned(),
            title: format!(
                "{}, {} x {triangles} triangles with {targets} targets and {joint_count} joints",
                self.title, self.bodies
            ),
            bodies: self.bodies,
            frames,
            joints,
            rays,
            steps,
            mesh,
        })
    }

    fn unusable(&self, what: &'static str) -> NoExperiment {
        NoExperiment::Unusable {
            scene: self.name,
            model: MODEL,
            what,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use morph_collision_models::clip::WeightAnimation;
    use morph_collision_models::generated::rigs::tube;
    use morph_collision_models::skeleton::JointClip;

    #[test]
    fn a_character_without_a_skin_or_its_clips_is_refused() {
        let told = |mesh: MorphMesh| {
            let found = WALKERS[0].of_mesh(mesh, 50).map(|_| ());
            found.expect_err("something is missing").to_string()
        };
        assert_eq!(
            told(MorphMesh::default()),
            "walkers-hands: mh_character.glb has no skin"
        );
        let mut mesh = tube(1, 3, 2, 2);
        assert!(told(mesh.clone()).ends_with("has no clip of joints"));
        let skin = mesh.skin.as_mut().expect("a tube is skinned");
        skin.skeleton.clips.push(JointClip {
            name: CLIP.into(),
            ..JointClip::default()
        });
        assert!(told(mesh.clone()).ends_with("has no clip of weights"));
        mesh.animations.push(WeightAnimation {
            name: CLIP.into(),
            times: vec![0.0],
            weights: vec![vec![0.5, -1.0]],
            ..WeightAnimation::default()
        });
        let experiment = WALKERS[2].of_mesh(mesh, 50).expect("everything is there");
        assert_eq!(
            (experiment.frames.len(), experiment.joints.len(), experiment.bodies),
            (8, 8, 12)
        );
        assert_eq!(experiment.joints_of(7, 11).map(<[_]>::len), Some(3));
        assert_ne!(experiment.joints_of(0, 0), experiment.joints_of(0, 1));
        assert_eq!(experiment.frames[3][5].0, [0.5, -1.0]);
    }
}
