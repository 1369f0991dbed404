//! Bodies at one moment, with the correct answers, to check methods against.

mod skinned;

use std::path::{Path, PathBuf};

use glam::{Affine3A, Mat3, Quat, Vec3};
use morph_collision::{Aabb, QueryStats};

use crate::oracle;
use crate::rivals::{MethodKind, MethodOptions, PoseError, SetUpError};
use morph_collision::batch::Wanted;
use morph_collision_models::generated::{degenerate, dolphin, pass_through_body, random};
use morph_collision_models::gltf::read::{ReadError, read_meshes};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes;

pub use self::skinned::skinned;

/// A body: the index of its mesh, its weights and its placement.
pub type MomentBody = (usize, Vec<f32>, Affine3A);

/// Two bodies and a triangle of each that intersect: `[body a, body b, triangle a, triangle b]` with `body a < body b`.
pub type Touch = [u32; 4];

/// Bodies at one moment.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Its name, for failure messages.
    pub name: String,
    /// The meshes.
    pub meshes: Vec<MorphMesh>,
    /// The bodies.
    pub bodies: Vec<MomentBody>,
    /// The joint matrices of each body with a skinned mesh, in world space. Empty for other bodies, and if no body is skinned.
    pub joints: Vec<Vec<Affine3A>>,
}

/// Why a method gives no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnswerError {
    /// It could not be set up.
    #[error(transparent)]
    SetUp(#[from] SetUpError),
    /// A body could not be posed.
    #[error(transparent)]
    Pose(#[from] PoseError),
}

impl Moment {
    fn pair(name: &str, mesh: &MorphMesh, bodies: [(Vec<f32>, Affine3A); 2]) -> Self {
        Self {
            name: name.to_owned(),
            meshes: vec![mesh.clone()],
            bodies: bodies.into_iter().map(|(weights, place)| (0, weights, place)).collect(),
            joints: Vec::new(),
        }
    }

    /// The matrices of a body's joints, if its mesh is skinned.
    pub fn joints_of(&self, body: usize) -> Option<&[Affine3A]> {
        self.joints
            .get(body)
            .filter(|joints| !joints.is_empty())
            .map(Vec::as_slice)
    }

    /// All intersecting triangle pairs by brute force, ascending.
    ///
    /// # Panics
    /// See [`oracle::scene_pairs`].
    pub fn truth(&self) -> Vec<Touch> {
        let bodies: Vec<_> = self
            .bodies
            .iter()
            .enumerate()
            .map(|(body, (mesh, weights, place))| oracle::BodyPose {
                mesh: &self.meshes[*mesh],
                weights,
                world_from_model: *place,
                joints: self.joints_of(body),
            })
            .collect();
        let mut all = Vec::new();
        for pairs in oracle::scene_pairs(&bodies) {
            all.extend(pairs.triangles.iter().map(|&(s, t)| [pairs.body_a, pairs.body_b, s, t]));
        }
        all
    }

    /// All intersecting triangle pairs by a method, ascending, and the work it took. Queries every pair of bodies, without a
    /// broad phase.
    ///
    /// # Errors
    /// The method refuses meshes, options, weights or placements.
    pub fn answer(
        &self,
        method: MethodKind,
        options: &MethodOptions,
        wanted: Wanted,
    ) -> Result<(Vec<Touch>, QueryStats), AnswerError> {
        let of_bodies: Vec<usize> = self.bodies.iter().map(|(mesh, ..)| *mesh).collect();
        let mut method = method.set_up(&self.meshes, &of_bodies, options)?;
        for (body, (_, weights, place)) in self.bodies.iter().enumerate() {
            if let Some(joints) = self.joints_of(body) {
                method.set_joints(body, joints)?;
            }
            method.set_body(body, weights, place)?;
        }
        let (mut all, mut pairs) = (Vec::new(), Vec::new());
        for b in 0..self.bodies.len() {
            for a in 0..b {
                pairs.clear();
                method.collide(a, b, wanted, &mut pairs);
                all.extend(pairs.iter().map(|p| [a as u32, b as u32, p.triangle_a, p.triangle_b]));
            }
        }
        all.sort_unstable();
        Ok((all, method.work()))
    }
}

/// The paper's second experiment at one moment.
pub fn dolphins(frame: usize) -> Moment {
    use scenes::dolphins::{COUNT, FRAMES, placement, weights};
    Moment {
        name: format!("dolphins, frame {frame}"),
        meshes: vec![dolphin(0)],
        bodies: (0..COUNT)
            .map(|i| {
                (
                    0,
                    weights(i, frame, FRAMES).to_vec(),
                    placement(i, COUNT, frame, FRAMES),
                )
            })
            .collect(),
        joints: Vec::new(),
    }
}

/// The paper's first experiment at one moment.
pub fn pass_through(step: usize) -> Moment {
    use scenes::pass_through::{STEPS, placements, weights};
    let weights = weights(step, STEPS).to_vec();
    let bodies = placements(step, STEPS).map(|place| (weights.clone(), place));
    Moment::pair(&format!("pass-through, step {step}"), &pass_through_body(), bodies)
}

/// Sheared, mirrored, stretched and flattened placements that bring two models of the given radius together.
fn odd_places(radius: f32) -> Vec<(&'static str, Affine3A)> {
    let offset = Vec3::new(0.5, 0.2, -0.1) * radius;
    let turned = Mat3::from_quat(Quat::from_rotation_x(0.8) * Quat::from_rotation_z(1.9));
    let sheared = turned * Mat3::from_cols(Vec3::X, Vec3::new(0.9, 1.0, 0.0), Vec3::new(0.0, -0.4, 1.0));
    vec![
        ("turned", Affine3A::from_mat3_translation(turned, offset)),
        ("sheared", Affine3A::from_mat3_translation(sheared, offset)),
        (
            "mirrored and stretched",
            Affine3A::from_mat3_translation(turned * Mat3::from_diagonal(Vec3::new(-3.0, 0.2, 1.0)), offset),
        ),
        (
            "flattened",
            Affine3A::from_mat3_translation(turned * Mat3::from_diagonal(Vec3::new(1.0, 0.0, 1.0)), offset),
        ),
        (
            "a line",
            Affine3A::from_mat3_translation(turned * Mat3::from_diagonal(Vec3::X), offset),
        ),
        ("a point", Affine3A::from_mat3_translation(Mat3::ZERO, offset)),
    ]
}

/// Generated models with every kind of placement and weights.
pub fn generated() -> Vec<Moment> {
    let blob = random::random_blob(7, 2, 6, 0.5);
    let soup = random::triangle_soup(11, 120, 3);
    let mut all = vec![dolphins(60), dolphins(200)];
    for (name, place) in odd_places(1.0) {
        let weights = [vec![0.3, -0.2, 0.9, 0.0, 2.5, 0.1], vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0]];
        all.push(Moment::pair(
            &format!("blobs, {name}"),
            &blob,
            [(weights[0].clone(), Affine3A::IDENTITY), (weights[1].clone(), place)],
        ));
        all.push(Moment::pair(
            &format!("blobs both {name}"),
            &blob,
            [(weights[0].clone(), place), (weights[1].clone(), place)],
        ));
    }
    for (name, weights) in [
        ("negative", vec![-1.0, -0.5, 0.25]),
        ("sum of 12", vec![4.0; 3]),
        ("far beyond", vec![1e4, -1e4, 3.0]),
    ] {
        all.push(Moment::pair(
            &format!("soup, {name}"),
            &soup,
            [
                (weights.clone(), Affine3A::IDENTITY),
                (vec![0.5, 0.5, 0.0], Affine3A::IDENTITY),
            ],
        ));
    }
    let ill = [
        degenerate::slivers(1, 60),
        degenerate::zero_area(2, 60),
        degenerate::coplanar_sheets(3, 6),
        degenerate::duplicated_vertices(&dolphin(0)),
        degenerate::all_equal(20),
    ];
    for mesh in ill {
        let weights = vec![0.5; mesh.targets.len()];
        let bodies = [(weights.clone(), Affine3A::IDENTITY), (weights, Affine3A::IDENTITY)];
        all.push(Moment::pair(&format!("{} on itself", mesh.name), &mesh, bodies));
    }
    let mut mixed = Moment {
        name: "dolphin, blob and soup".to_owned(),
        meshes: vec![dolphin(0), blob, soup],
        bodies: Vec::new(),
        joints: Vec::new(),
    };
    mixed.bodies = vec![
        (0, vec![0.2, 0.3], Affine3A::from_scale(Vec3::splat(1.5))),
        (1, vec![0.1; 6], Affine3A::from_translation(Vec3::X)),
        (2, vec![0.0; 3], Affine3A::IDENTITY),
    ];
    all.push(mixed);
    all
}

/// Two copies of a mesh, apart and slightly rotated about its middle, each with its own weights: `weights(body, target)`.
pub fn of_two(mesh: &MorphMesh, weights: impl Fn(usize, usize) -> f32) -> Moment {
    let bounds = Aabb::from_points(mesh.positions.iter().copied());
    let (middle, radius) = (bounds.center(), 0.5 * bounds.size().length());
    let turned = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(0.1);
    let offset = Vec3::new(0.35, 0.05, 0.1) * radius;
    let place = Affine3A::from_rotation_translation(turned, middle + offset) * Affine3A::from_translation(-middle);
    let targets = mesh.targets.len();
    let weights = |body| (0..targets).map(|target| weights(body, target)).collect::<Vec<f32>>();
    let bodies = [(weights(0), Affine3A::IDENTITY), (weights(1), place)];
    Moment::pair(&mesh.name, mesh, bodies)
}

/// The path of a real model made by other people. Looks in `assets/`, which always has the head, and in the folder of models
/// beside the repository. Returns `None` and prints the reason if neither has it.
pub fn real_model(name: &str) -> Option<PathBuf> {
    let found = find_real_model(name);
    found.inspect_err(|missing| println!("skipped: {missing}")).ok()
}

/// Like [`real_model`], but prints nothing.
///
/// # Errors
/// Neither folder has it.
pub fn find_real_model(name: &str) -> Result<PathBuf, MissingModel> {
    let repository = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let paths = ["assets", "../shared/models"].map(|folder| repository.join(folder).join(name));
    if let Some(path) = paths.iter().find(|path| path.is_file()) {
        return Ok(path.clone());
    }
    let [_, beside] = paths;
    Err(MissingModel {
        name: name.to_owned(),
        beside,
    })
}

/// A model by other people that was not found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {name} in assets/, and no {}", beside.display())]
pub struct MissingModel {
    name: String,
    /// The other folder that was searched.
    beside: PathBuf,
}

/// [`of_two`] for the first mesh of a [`real_model`].
///
/// # Errors
/// The file exists but cannot be read.
pub fn from_real_model(name: &str, weights: impl Fn(usize, usize) -> f32) -> Result<Option<Moment>, Box<ReadError>> {
    let Some(path) = real_model(name) else {
        return Ok(None);
    };
    let meshes = read_meshes(&path).map_err(Box::new)?;
    Ok(meshes.first().map(|mesh| of_two(mesh, weights)))
}
