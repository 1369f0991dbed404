//! The hashed scenes: two scripted scenes with few triangles, and odd moments of random and degenerate models.

use super::hash::Hash;
use crate::moments::{self, MomentBody};
use glam::{Affine3A, DVec4, Vec3};
use morph_collision_models::generated::{dolphin, pass_through_body_at, random, rigs};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes::{dolphins, pass_through};
use morph_collision_models::skeleton::{Interpolation, JointChannel, JointClip, Property};

/// Meshes, and the weights and placements of bodies in each frame. Body `i` uses the same mesh in all frames.
#[derive(Debug)]
pub struct Scene {
    pub(super) name: String,
    pub(super) meshes: Vec<MorphMesh>,
    pub(super) frames: Vec<Vec<MomentBody>>,
    /// Joint matrices per frame and body. Empty for bodies that are not skinned, or for the whole list if none is.
    pub(super) joints: Vec<Vec<Vec<Affine3A>>>,
    /// The kind of shape that meets the first body. It differs between scenes, because some have few bodies.
    pub(super) first_shape: usize,
}

impl Scene {
    fn new(name: String, meshes: Vec<MorphMesh>, mut frames: Vec<Vec<MomentBody>>) -> Self {
        for (_, weights, place) in frames.iter_mut().flatten() {
            weights.iter_mut().for_each(snap);
            let mut columns = place.to_cols_array();
            columns.iter_mut().for_each(snap);
            *place = Affine3A::from_cols_array(&columns);
        }
        Self {
            name,
            meshes,
            frames,
            joints: Vec::new(),
            first_shape: 0,
        }
    }

    /// The matrices of a body's joints, if it is skinned.
    pub(super) fn joints_of(&self, frame: usize, body: usize) -> Option<&[Affine3A]> {
        let joints = self.joints.get(frame)?.get(body)?;
        (!joints.is_empty()).then_some(joints)
    }

    /// A hash of all inputs, which tells different answers from different questions.
    pub(super) fn hash(&self) -> u64 {
        let mut hash = Hash::EMPTY;
        for mesh in &self.meshes {
            let vectors = mesh.positions.iter().chain(mesh.targets.iter().flatten());
            vectors.for_each(|v| hash.vertex(*v));
            mesh.triangles.iter().flatten().for_each(|vertex| hash.u32(*vertex));
        }
        for (mesh, weights, place) in self.frames.iter().flatten() {
            hash.u64(*mesh as u64);
            let numbers = weights.iter().copied().chain(place.to_cols_array());
            numbers.for_each(|number| hash.u32(number.to_bits()));
        }
        let sets = self
            .meshes
            .iter()
            .filter_map(|mesh| mesh.skin.as_ref())
            .flat_map(|skin| &skin.sets);
        for set in sets {
            set.joints.iter().flatten().for_each(|joint| hash.u32((*joint).into()));
            set.weights
                .iter()
                .flatten()
                .for_each(|weight| hash.u32(weight.to_bits()));
        }
        for joint in self.joints.iter().flatten().flatten() {
            joint
                .to_cols_array()
                .iter()
                .for_each(|number| hash.u32(number.to_bits()));
        }
        hash.value()
    }
}

/// Machines differ in the last bits of sines. Rounding to multiples of 2^-14 hides that, and keeps numbers beyond 2^9
/// as they are.
fn snap(number: &mut f32) {
    const GRID: f32 = 16384.0;
    if number.abs() < 512.0 {
        *number = (*number * GRID).round() / GRID;
    }
}

/// Moments that others cover, or in which every triangle intersects every other, which takes long.
const LEFT_OUT: [&str; 4] = [
    "dolphins, frame 60",
    "dolphins, frame 200",
    "blobs both a line",
    "blobs both a point",
];

/// All scenes, in the order of the file.
#[must_use]
pub fn all() -> Vec<Scene> {
    let mut scenes = vec![swimming(), passing(), signed()];
    scenes.extend(
        moments::generated()
            .into_iter()
            .filter(|moment| !LEFT_OUT.contains(&moment.name.as_str()))
            .map(|moment| Scene::new(moment.name, moment.meshes, vec![moment.bodies])),
    );
    scenes.extend(skinned());
    scenes.push(clip());
    for (i, scene) in scenes.iter_mut().enumerate() {
        scene.first_shape = i;
    }
    scenes
}

/// A scene for each skinned model, with a frame for each kind of pose.
fn skinned() -> Vec<Scene> {
    let mut scenes: Vec<Scene> = Vec::new();
    for moment in moments::skinned() {
        let name = moment.meshes[0].name.clone();
        if scenes.last().is_none_or(|scene| scene.name != name) {
            scenes.push(Scene::new(name, moment.meshes, Vec::new()));
        }
        if let Some(scene) = scenes.last_mut() {
            scene.frames.push(moment.bodies);
            scene.joints.push(moment.joints);
        }
    }
    scenes
}

fn swimming() -> Scene {
    use dolphins::{COUNT, FRAMES, placement, weights};
    let bodies = |frame| {
        let body = |i| {
            let weights = weights(i, frame, FRAMES).to_vec();
            (0, weights, placement(i, COUNT, frame, FRAMES))
        };
        (0..COUNT).map(body).collect()
    };
    let frames = (0..FRAMES).step_by(80).map(bodies).collect();
    Scene::new("12 dolphins".to_owned(), vec![dolphin(0)], frames)
}

fn passing() -> Scene {
    use pass_through::{STEPS, placements, weights};
    let bodies = |step| {
        let weights = weights(step, STEPS).to_vec();
        placements(step, STEPS)
            .map(|place| (0, weights.clone(), place))
            .to_vec()
    };
    let frames = (40..STEPS).step_by(20).map(bodies).collect();
    Scene::new("pass-through".to_owned(), vec![pass_through_body_at(2)], frames)
}

/// Numbers that spread over -1..1 without a sine: multiples of an odd number.
fn wander(seed: u32) -> f32 {
    (seed.wrapping_mul(0x9e37_79b1) >> 16) as f32 / 32768.0 - 1.0
}

/// A tube whose joints are those of a clip, between its keys.
fn clip() -> Scene {
    let mesh = rigs::tube(38, 6, 4, 3);
    let skeleton = mesh.skin.as_ref().map(|skin| skin.skeleton.clone()).unwrap_or_default();
    let quaternion = |seed: u32| {
        let numbers = [0, 1, 2, 3].map(|i| f64::from(wander(seed + 577 * i)));
        DVec4::from_array(numbers).normalize_or(DVec4::W).as_vec4()
    };
    let channel = |node: u32| {
        let interpolation = [Interpolation::Linear, Interpolation::CubicSpline][node as usize % 2];
        let values = if node.is_multiple_of(2) { 4 } else { 12 };
        JointChannel {
            node,
            property: Property::Rotation,
            interpolation,
            times: vec![0.0, 0.5, 0.75, 2.0],
            values: (0..values)
                .map(|value| quaternion(1 + 31 * value + 1009 * node))
                .collect(),
        }
    };
    let clip = JointClip {
        channels: (0..skeleton.nodes.len() as u32).map(channel).collect(),
        ..JointClip::default()
    };
    let at = |seconds: f32| skeleton.world_from_mesh(Some(&clip), seconds);
    let body = || (0, vec![0.5, -0.25, 1.5], Affine3A::IDENTITY);
    let seconds = [0.1, 0.45, 0.6, 1.3, 1.9];
    let mut scene = Scene::new(
        "a clip".to_owned(),
        vec![mesh],
        vec![vec![body(), body()]; seconds.len()],
    );
    scene.joints = seconds.map(|seconds| vec![at(seconds), at(seconds + 0.05)]).to_vec();
    scene
}

/// Blobs with 24 targets each. The weights have any sign and sum, and most of them change from frame to frame.
fn signed() -> Scene {
    const TARGETS: u32 = 24;
    let meshes = vec![
        random::random_blob(21, 2, TARGETS as usize, 0.6),
        random::random_blob(22, 1, TARGETS as usize, 0.0),
    ];
    let bodies = |frame: u32| {
        let body = |i: u32| {
            let weight =
                |k| wander(1 + frame * 97 + k * 13 + i * 1009) * if frame.is_multiple_of(3) { 2.0 } else { 0.4 };
            let columns = std::array::from_fn(|c| {
                let diagonal = if c % 4 == 0 { 1.0 } else { 0.0 };
                diagonal + 0.5 * wander(7 + frame * 31 + c as u32 * 17 + i * 4099)
            });
            let place = Affine3A::from_cols_array(&columns);
            (
                (i % 2) as usize,
                (0..TARGETS).map(weight).collect(),
                Affine3A::from_translation(Vec3::X * (0.7 * i as f32)) * place,
            )
        };
        (0..3).map(body).collect()
    };
    Scene::new("signed weights".to_owned(), meshes, (0..6).map(bodies).collect())
}
