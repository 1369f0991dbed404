//! Bodies for the tests, with their world-space triangles computed by the oracle.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Mat3, Quat, Vec3};
use morph_collision::{Body, BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_models::generated::{degenerate, dolphin, random};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle;

/// A posed mesh with a transform.
pub(crate) struct Placed {
    pub(crate) name: String,
    pub(crate) pose: Pose,
    pub(crate) place: WorldFromModel,
    pub(crate) triangles: Vec<[DVec3; 3]>,
}

impl Placed {
    pub(crate) fn new(name: &str, mesh: &MorphMesh, weights: &[f32], place: Affine3A, options: &BuildOptions) -> Self {
        let bvh = MorphBvh::build(Arc::new(mesh.to_model().unwrap()), options);
        let mut pose = Pose::new(Arc::new(bvh));
        pose.set_weights(weights).unwrap();
        let posed = oracle::posed_vertices(&mesh.positions, &mesh.targets, weights);
        let world = oracle::world_vertices(&posed, &place);
        Self {
            name: name.to_owned(),
            pose,
            place: WorldFromModel::new(place).unwrap(),
            triangles: mesh.triangles.iter().map(|t| t.map(|v| world[v as usize])).collect(),
        }
    }

    pub(crate) fn rigid(mesh: &MorphMesh, place: Affine3A) -> Self {
        Self::new(&mesh.name, mesh, &[], place, &BuildOptions::default())
    }

    pub(crate) fn body(&mut self) -> Body<'_> {
        Body::new(&mut self.pose, &self.place)
    }

    /// The largest absolute coordinate.
    pub(crate) fn reach(&self) -> f64 {
        let corners = self.triangles.iter().flatten();
        corners.fold(0.0, |reach, corner| reach.max(corner.abs().max_element()))
    }
}

pub(crate) fn at(x: f32, y: f32, z: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z))
}

/// Unusual transforms: rotated, sheared, mirrored and flattened.
pub(crate) fn odd_places() -> Vec<(&'static str, Affine3A)> {
    let offset = Vec3::new(0.5, 0.2, -0.1);
    let turned = Mat3::from_quat(Quat::from_rotation_x(0.8) * Quat::from_rotation_z(1.9));
    let sheared = turned * Mat3::from_cols(Vec3::X, Vec3::new(0.9, 1.0, 0.0), Vec3::new(0.0, -0.4, 1.0));
    let scaled = |x, y, z| turned * Mat3::from_diagonal(Vec3::new(x, y, z));
    [
        ("in place", Mat3::IDENTITY),
        ("turned", turned),
        ("sheared", sheared),
        ("mirrored and stretched", scaled(-3.0, 0.2, 1.0)),
        ("flattened", scaled(1.0, 0.0, 1.0)),
        ("a line", scaled(1.0, 0.0, 0.0)),
        ("a point", Mat3::ZERO),
    ]
    .map(|(name, linear)| (name, Affine3A::from_mat3_translation(linear, offset)))
    .to_vec()
}

/// Blobs, soups, dolphins and degenerate meshes with unusual transforms, in trees with several leaf sizes.
pub(crate) fn assorted() -> Vec<Placed> {
    let mut all = Vec::new();
    let mut leaf_sizes = [8, 1, 3, 20].into_iter().cycle();
    let mut add = |mesh: &MorphMesh, weights: &[f32]| {
        for (name, place) in odd_places() {
            let name = format!("{}, {name}", mesh.name);
            let options = BuildOptions::default()
                .with_leaf_size(leaf_sizes.next().unwrap())
                .unwrap();
            all.push(Placed::new(&name, mesh, weights, place, &options));
        }
    };
    add(&random::random_blob(7, 2, 6, 0.5), &[0.3, -0.2, 0.9, 0.0, 2.5, 0.1]);
    add(&random::triangle_soup(11, 120, 3), &[-1.0, 0.5, 0.25]);
    for mesh in [
        degenerate::slivers(1, 60),
        degenerate::zero_area(2, 60),
        degenerate::coplanar_sheets(3, 4),
        degenerate::all_equal(20),
    ] {
        add(&mesh, &[0.5]);
    }
    let options = BuildOptions::default();
    all.push(Placed::new(
        "dolphin",
        &dolphin(0),
        &[0.2, 0.6],
        Affine3A::IDENTITY,
        &options,
    ));
    all
}
