//! Draws random shapes and placements, both ordinary and extreme.

use glam::{Affine3A, DVec3, Mat3, Quat, Vec3, Vec3A};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{AnswerSource, Meshes, Situation, nearly_touching};
use crate::rivals::PoseError;
use morph_collision_models::generated::rigs::PoseKind;
use morph_collision_models::mesh::MorphMesh;

/// A source of situations of two meshes; the same seed gives the same situations.
#[derive(Debug)]
pub struct Draw<'a> {
    meshes: Meshes<'a>,
    rng: Pcg64Mcg,
}

/// Distances of the two bodies, in sums of their radii. Every fifth round uses nearly touching bodies instead.
const CLOSENESS: [std::ops::Range<f32>; 4] = [0.2..0.8, 0.0..0.2, 0.8..1.1, 1.1..2.0];

impl<'a> Draw<'a> {
    /// Draws the situations of round `round` for a seed.
    #[must_use]
    pub fn new(meshes: Meshes<'a>, seed: u64, round: u64) -> Self {
        let mixed = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ round.wrapping_mul(0xd1b5_4a32_d192_ed03);
        Self {
            meshes,
            rng: Pcg64Mcg::seed_from_u64(mixed),
        }
    }

    /// The situations of a round: partly overlapping, deep, grazing or apart. In every fifth round there are two that nearly
    /// touch, found with answers from `source`.
    ///
    /// # Errors
    /// The source refuses a situation.
    pub fn situations(&mut self, round: u64, source: &mut impl AnswerSource) -> Result<Vec<Situation>, PoseError> {
        let closeness = match round % 5 {
            1 => return self.nearly_touching(source),
            0 => 0,
            other => other as usize - 1,
        };
        let mut situation = self.shapes();
        let distance = self.rng.random_range(CLOSENESS[closeness].clone());
        let apart = self.direction() * f64::from(distance);
        situation.bring_together(self.meshes, apart);
        Ok(vec![situation])
    }

    /// Two neighbouring situations, one of which touches; or a single one that does not touch if the bodies cannot be made to.
    fn nearly_touching(&mut self, source: &mut impl AnswerSource) -> Result<Vec<Situation>, PoseError> {
        let mut last = Vec::new();
        for _ in 0..8 {
            let mut situation = self.shapes();
            let size = situation.sizes(self.meshes);
            let [a, b] = [0, 1].map(|body| self.point_on(&situation, body));
            situation.places[1].translation += Vec3A::from((a - b).as_vec3());
            let away = (self.direction() * size * 2.5).as_vec3();
            let apart = situation.places[1].translation + Vec3A::from(away);
            if let Some(found) = nearly_touching(&situation, apart, source)? {
                return Ok(found.to_vec());
            }
            last = vec![situation];
        }
        Ok(last)
    }

    /// Weights, joints and linear maps. The first body is near the origin.
    fn shapes(&mut self) -> Situation {
        let weights = [0, 1].map(|body| self.weights(self.meshes[body]));
        let mut places = [0, 1].map(|_| Affine3A::from_mat3(self.linear()));
        places[0].translation = self.direction().as_vec3().into();
        let joints = [0, 1].map(|body| self.joints(body));
        Situation {
            weights,
            places,
            joints,
        }
    }

    /// Joint matrices of every kind: at a time of the mesh's own clips, and random ones. Empty for a mesh without a skin.
    fn joints(&mut self, body: usize) -> Vec<Affine3A> {
        let Some(skin) = &self.meshes[body].skin else {
            return Vec::new();
        };
        let (skeleton, rng) = (&skin.skeleton, &mut self.rng);
        let clips = skeleton.clips.len();
        if clips > 0 && rng.random_bool(0.4) {
            let clip = &skeleton.clips[rng.random_range(0..clips)];
            return skeleton.world_from_mesh(Some(clip), moment(rng, clip.duration()));
        }
        let kind = PoseKind::ALL[rng.random_range(0..PoseKind::ALL.len())].of_body(body);
        kind.draw(skeleton, rng.random())
    }

    /// A random point of a random triangle, in world space.
    fn point_on(&mut self, situation: &Situation, body: usize) -> DVec3 {
        let triangles = self.meshes[body].triangles.len() as u32;
        let triangle = self.rng.random_range(0..triangles.max(1));
        let [a, b, c] = situation.world_triangle(self.meshes, body, triangle);
        let (s, t): (f64, f64) = (self.rng.random_range(0.1..0.45), self.rng.random_range(0.1..0.45));
        a * (1.0 - s - t) + b * s + c * t
    }

    /// Weights of every kind: of the mesh's own clips, convex, signed, above one, twelve in sum, one-hot and zero.
    fn weights(&mut self, mesh: &MorphMesh) -> Vec<f32> {
        let count = mesh.targets.len();
        let mut weights = vec![0.0; count];
        if count == 0 {
            return weights;
        }
        let rng = &mut self.rng;
        let clips = mesh.animations.len();
        match rng.random_range(if clips > 0 { 0..9 } else { 3..9 }) {
            0..=2 => {
                let clip = &mesh.animations[rng.random_range(0..clips)];
                let sample = clip.sample(moment(rng, clip.duration()));
                if sample.len() == count {
                    weights = sample;
                }
            }
            3 => share(rng, &mut weights, 1.0),
            4 => weights.fill_with(|| rng.random_range(-1.0..1.0)),
            5 => weights.fill_with(|| rng.random_range(0.0..2.0)),
            6 => share(rng, &mut weights, 12.0),
            7 => weights[rng.random_range(0..count)] = 1.0,
            _ => {}
        }
        weights
    }

    /// A rotation, often also a scale per axis, a mirroring or a shear.
    fn linear(&mut self) -> Mat3 {
        let rng = &mut self.rng;
        let turn = |rng: &mut Pcg64Mcg| rng.random_range(-3.2..3.2_f32);
        let rotation =
            Quat::from_rotation_x(turn(rng)) * Quat::from_rotation_y(turn(rng)) * Quat::from_rotation_z(turn(rng));
        let mut linear = Mat3::from_quat(rotation);
        if rng.random_bool(0.2) {
            linear = Mat3::IDENTITY;
        }
        if rng.random_bool(0.5) {
            linear *= Mat3::from_diagonal(Vec3::from_array(std::array::from_fn(|_| rng.random_range(0.3..3.0))));
        }
        if rng.random_bool(0.25) {
            linear *= Mat3::from_diagonal(Vec3::new(1.0, -1.0, 1.0));
        }
        if rng.random_bool(0.25) {
            let [x, y, z] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
            linear *= Mat3::from_cols(Vec3::X, Vec3::new(x, 1.0, 0.0), Vec3::new(y, z, 1.0));
        }
        linear
    }

    /// A vector of length 1.
    fn direction(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.rng.random_range(-1.0..1.0))).normalize_or(DVec3::X)
    }
}

/// A time in a clip of a length, in seconds: one of eleven is its very end.
fn moment(rng: &mut Pcg64Mcg, length: f32) -> f32 {
    rng.random_range(0.0..1.1_f32).min(1.0) * length.max(0.0)
}

/// Random shares of a sum.
fn share(rng: &mut Pcg64Mcg, weights: &mut [f32], sum: f32) {
    weights.fill_with(|| rng.random_range(0.0..1.0));
    let total: f32 = weights.iter().sum();
    if total > 0.0 {
        weights.iter_mut().for_each(|weight| *weight *= sum / total);
    }
}
