//! Scenes with models by other people: talking heads and flip-book characters. Those of a skinned character are in `walkers`.

use glam::{Affine3A, DVec3, Vec3};
use morph_collision::Aabb;
use thiserror::Error;

use super::Experiment;
use super::rays::rays_at;
use super::walkers::WALKERS;
use super::{flip_books, heads, talk};
use crate::moments::{MissingModel, find_real_model};
use morph_collision_models::clip::looped;
use morph_collision_models::gltf::read::{ReadError, read_meshes};
use morph_collision_models::mesh::MorphMesh;

/// Steps of each script.
pub(super) const STEPS: usize = 400;

/// Length of the scripts with heads in seconds, at 60 steps a second.
const SECONDS: f64 = STEPS as f64 / 60.0;

/// How far each body is ahead of the one before it: in seconds of its talk, or in passes through its flip-book.
const AHEAD: f64 = 0.37;

/// The motion of a scene's bodies.
struct Script {
    name: &'static str,
    title: &'static str,
    /// The model's name for [`find_real_model`].
    model: &'static str,
    bodies: usize,
    /// Number of rays cast at each body in a frame.
    rays: usize,
    motion: Motion,
    /// The placement of a body's middle, from its index, the share of the script, and the size of the mesh at rest.
    place: fn(usize, f64, DVec3) -> Affine3A,
}

/// Weights at a share of the script, for a body that is ahead by this much.
type Weights = Box<dyn Fn(f64, f64) -> Vec<f32>>;

/// The source of the weights.
#[derive(Clone, Copy)]
enum Motion {
    /// [`talk::weights`].
    Talk,
    /// The mesh's first clip, played this many times over the whole script. This is about the recorded speed, and nearly all
    /// frames lie between two keys, whichever steps are used.
    FlipBook { passes: f64 },
}

impl Motion {
    /// The point that is put at a body's place. A head turns about the middle of its bounds at rest. A flip-book character is
    /// held by the mean of its vertices, because otherwise its steps would carry it away and the end of its clip would put it
    /// back.
    fn middle(self, mesh: &MorphMesh, weights: &[f32], rest: Vec3) -> Vec3 {
        match self {
            Self::Talk => rest,
            Self::FlipBook { .. } => {
                let sum: DVec3 = mesh.posed(weights).iter().map(|vertex| vertex.as_dvec3()).sum();
                let mean = (sum / mesh.positions.len().max(1) as f64).as_vec3();
                Vec3::new(mean.x, rest.y, mean.z)
            }
        }
    }
}

const HEAD: &str = "mh_head_eyes_teeth_arkit52.glb";

const SCRIPTS: [Script; 6] = [
    Script {
        name: "heads-cheek",
        title: "Heads cheek to cheek",
        model: HEAD,
        bodies: 2,
        rays: 0,
        motion: Motion::Talk,
        place: heads::cheek_to_cheek,
    },
    Script {
        name: "heads-crowd",
        title: "Heads in a crowd",
        model: HEAD,
        bodies: heads::CROWD,
        rays: 0,
        motion: Motion::Talk,
        place: heads::crowd,
    },
    Script {
        name: "horse-gallop",
        title: "Galloping horses",
        model: "sequences/horse-gallop.glb",
        bodies: 2,
        rays: 0,
        motion: Motion::FlipBook { passes: 3.3 },
        place: flip_books::horses,
    },
    Script {
        name: "samba",
        title: "Samba dancers",
        model: "sequences/samba.glb",
        bodies: 2,
        rays: 0,
        motion: Motion::FlipBook { passes: 1.7 },
        place: flip_books::dancers,
    },
    Script {
        name: "head-ray",
        title: "A head and a ray",
        model: HEAD,
        bodies: 1,
        rays: 1,
        motion: Motion::Talk,
        place: heads::cheek_to_cheek,
    },
    Script {
        name: "head-rays",
        title: "A head and rays",
        model: HEAD,
        bodies: 1,
        rays: 100,
        motion: Motion::Talk,
        place: heads::cheek_to_cheek,
    },
];

/// Why a scene cannot be measured.
#[derive(Debug, Error)]
pub enum NoExperiment {
    /// There is no scene with this name.
    #[error("there is no scene '{name}', expected one of: {}", Experiment::names().join(", "))]
    Unknown {
        /// The name.
        name: String,
    },
    /// The model was not found.
    #[error("{scene}: {missing}")]
    Missing {
        /// The scene's name.
        scene: &'static str,
        /// The missing model.
        missing: MissingModel,
    },
    /// The model cannot be read.
    #[error(transparent)]
    Read(#[from] Box<ReadError>),
    /// The model is not the one that the scene was made for.
    #[error("{scene}: {model} has no {what}")]
    Unusable {
        /// The scene's name.
        scene: &'static str,
        /// The model.
        model: &'static str,
        /// What it lacks.
        what: &'static str,
    },
}

impl Experiment {
    /// The scenes with models by other people, by name and the beginning of their headings:
    ///
    /// - two heads that touch at their cheeks, and a crowd of heads;
    /// - two flip-book horses and two flip-book dancers that pass through each other;
    /// - skinned characters that walk and talk: two whose hands touch, two deep inside each other, and a crowd.
    ///
    /// Only the heads' model is in `assets/`. The scenes of [`with_rays`](Self::with_rays) are not included.
    pub fn characters() -> impl Iterator<Item = (&'static str, &'static str)> {
        let scripts = SCRIPTS.iter().filter(|script| script.rays == 0);
        scripts.map(|script| (script.name, script.title)).chain(Self::walkers())
    }

    /// Those of [`characters`](Self::characters) that are skinned. Their scripts have 60 steps a second.
    pub fn walkers() -> impl Iterator<Item = (&'static str, &'static str)> {
        let walkers = WALKERS.iter().filter(|walkers| walkers.rays == 0);
        walkers.map(|walkers| (walkers.name, walkers.title))
    }

    /// The scenes with rays, by name and the beginning of their headings: a talking head, and a skinned character that walks and
    /// talks, each hit by one ray per frame or by a hundred.
    pub fn with_rays() -> impl Iterator<Item = (&'static str, &'static str)> {
        let walkers = WALKERS.iter().filter(|walkers| walkers.rays > 0);
        let walkers = walkers.map(|walkers| (walkers.name, walkers.title));
        let scripts = SCRIPTS.iter().filter(|script| script.rays > 0);
        scripts.map(|script| (script.name, script.title)).chain(walkers)
    }

    /// The names of the scenes that are benchmarked by default. [`Experiment::named`] accepts some more.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        let paper = Self::paper_names().iter().copied();
        let others = Self::characters().chain(Self::with_rays());
        paper.chain(others.map(|(name, _)| name)).collect()
    }

    /// One with [generated](Self::generated) bodies, or of the scenes of [`characters`](Self::characters) and [`with_rays`](Self::with_rays).
    /// Uses every `every`-th step, at least 1.
    ///
    /// # Errors
    /// There is no scene with this name, or its model is missing or not the expected one.
    pub fn named(name: &str, every: usize) -> Result<Self, NoExperiment> {
        if let Some(experiment) = Self::generated(name, every) {
            return Ok(experiment);
        }
        if let Some(walkers) = WALKERS.iter().find(|walkers| walkers.name == name) {
            return walkers.experiment(every);
        }
        let unknown = || NoExperiment::Unknown { name: name.to_owned() };
        let script = SCRIPTS.iter().find(|script| script.name == name).ok_or_else(unknown)?;
        script.experiment(every)
    }
}

impl Script {
    fn experiment(&self, every: usize) -> Result<Experiment, NoExperiment> {
        let path = find_real_model(self.model).map_err(|missing| NoExperiment::Missing {
            scene: self.name,
            missing,
        })?;
        let meshes = read_meshes(&path).map_err(Box::new)?;
        let mesh = meshes.into_iter().next().ok_or_else(|| self.unusable("mesh"))?;
        let weights = self.weights(&mesh)?;
        let bounds = Aabb::from_points(mesh.positions.iter().copied());
        let (size, rest) = (bounds.size().as_dvec3(), bounds.center());
        let (bodies, triangles, targets) = (self.bodies, mesh.triangles.len(), mesh.targets.len());
        let title = format!(
            "{}, {bodies} x {triangles} triangles with {targets} targets",
            self.title
        );
        let steps: Vec<usize> = (0..STEPS).step_by(every.max(1)).collect();
        let frame = |&step: &usize| {
            let t = step as f64 / STEPS as f64;
            let body = |index: usize| {
                let weights = weights(t, AHEAD * index as f64);
                let middle = self.motion.middle(&mesh, &weights, rest);
                let place = (self.place)(index, t, size);
                (weights, place * Affine3A::from_translation(-middle))
            };
            (0..bodies).map(body).collect()
        };
        let rays = |&step: &usize| {
            let at = (self.place)(0, step as f64 / STEPS as f64, size).translation.as_dvec3();
            rays_at(at, 0.4 * size, step, self.rays)
        };
        let rays = if self.rays > 0 {
            steps.iter().map(rays).collect()
        } else {
            Vec::new()
        };
        Ok(Experiment {
            name: self.name.to_owned(),
            title,
            bodies,
            frames: steps.iter().map(frame).collect(),
            joints: Vec::new(),
            rays,
            steps,
            mesh,
        })
    }

    fn weights(&self, mesh: &MorphMesh) -> Result<Weights, NoExperiment> {
        match self.motion {
            Motion::Talk => {
                let names = mesh.target_names.clone();
                Ok(Box::new(move |t, ahead| talk::weights(&names, SECONDS * t + ahead)))
            }
            Motion::FlipBook { passes } => {
                let targets = mesh.targets.len();
                let fits = |weights: &Vec<f32>| weights.len() == targets;
                let clip = mesh
                    .animations
                    .first()
                    .filter(|clip| !clip.weights.is_empty() && clip.weights.iter().all(fits));
                let clip = clip.cloned().ok_or_else(|| self.unusable("clip"))?;
                let duration = f64::from(clip.duration());
                Ok(Box::new(move |t, ahead| {
                    clip.sample(looped(((passes * t + ahead) * duration) as f32, clip.duration()))
                }))
            }
        }
    }

    fn unusable(&self, what: &'static str) -> NoExperiment {
        NoExperiment::Unusable {
            scene: self.name,
            model: self.model,
            what,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_that_is_not_at_hand_is_told_with_its_scene() {
        let script = Script {
            name: "nobody",
            model: "absent.glb",
            ..SCRIPTS[0]
        };
        let error = script.experiment(20).map_err(|error| error.to_string());
        let told = error.expect_err("there is no such model");
        assert!(told.starts_with("nobody: there is no absent.glb in assets/"), "{told}");
    }

    #[test]
    fn a_flip_book_without_a_clip_is_refused() {
        let error = SCRIPTS[2].weights(&MorphMesh::default()).map(|_| ());
        let told = error.map_err(|error| error.to_string());
        assert_eq!(
            told,
            Err("horse-gallop: sequences/horse-gallop.glb has no clip".to_owned())
        );
    }
}
