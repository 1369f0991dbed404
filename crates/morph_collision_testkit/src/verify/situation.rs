use glam::{Affine3A, DVec3, Vec3};

use crate::oracle::{BodyPose, intersecting_pairs, triangles_intersect};
use morph_collision_models::mesh::MorphMesh;

/// The meshes of the two bodies.
pub type Meshes<'a> = [&'a MorphMesh; 2];

/// The shapes and placements of two bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Situation {
    /// One weight per target, of each body.
    pub weights: [Vec<f32>; 2],
    /// `world_from_model` of each body. For a skinned mesh it applies on top of all its joints.
    pub places: [Affine3A; 2],
    /// For each body with a skinned mesh, one matrix per joint, applied before its placement. An empty list means the
    /// identity for all.
    pub joints: [Vec<Affine3A>; 2],
}

impl Situation {
    /// The matrices of a body's joints, from mesh space to world space; empty like [`Situation::joints`].
    #[must_use]
    pub fn world_joints(&self, body: usize) -> Vec<Affine3A> {
        let place = self.places[body];
        self.joints[body].iter().map(|&joint| place * joint).collect()
    }

    /// All vertices of a body in world space.
    ///
    /// # Panics
    /// If there is not one weight per target and one matrix per joint.
    #[must_use]
    pub fn world_vertices(&self, meshes: Meshes<'_>, body: usize) -> Vec<DVec3> {
        self.world_of(meshes[body], body)
    }

    /// The vertices of a mesh in the pose of a body.
    fn world_of(&self, mesh: &MorphMesh, body: usize) -> Vec<DVec3> {
        let joints = self.world_joints(body);
        let pose = BodyPose {
            mesh,
            weights: &self.weights[body],
            world_from_model: self.places[body],
            joints: (!joints.is_empty()).then_some(&joints),
        };
        pose.world_vertices()
    }

    /// All intersecting pairs of triangles by brute force, ascending.
    ///
    /// # Panics
    /// If there is not one weight per target.
    pub fn truth(&self, meshes: Meshes<'_>) -> Vec<(u32, u32)> {
        let [a, b] = [0, 1].map(|body| self.world_vertices(meshes, body));
        intersecting_pairs(&a, &meshes[0].triangles, &b, &meshes[1].triangles)
    }

    /// Whether two triangles intersect, in integers.
    ///
    /// # Panics
    /// If there is not one weight per target, or no such triangle.
    pub fn truth_of(&self, meshes: Meshes<'_>, (triangle_a, triangle_b): (u32, u32)) -> bool {
        let a = self.world_triangle(meshes, 0, triangle_a);
        let b = self.world_triangle(meshes, 1, triangle_b);
        triangles_intersect(&a, &b)
    }

    /// The corners of a body's triangle in world space.
    ///
    /// # Panics
    /// If there is not one weight per target, or no such triangle.
    pub fn world_triangle(&self, meshes: Meshes<'_>, body: usize, triangle: u32) -> [DVec3; 3] {
        let mesh = meshes[body];
        let corners = mesh.triangles[triangle as usize];
        let of = |values: &[Vec3]| corners.map(|vertex| values[vertex as usize]).to_vec();
        // An empty target moves nothing.
        let of_target = |target: &Vec<Vec3>| if target.is_empty() { Vec::new() } else { of(target) };
        let alone = MorphMesh {
            positions: of(&mesh.positions),
            triangles: vec![[0, 1, 2]],
            targets: mesh.targets.iter().map(of_target).collect(),
            skin: mesh.skin.as_ref().map(|skin| skin.renumbered(corners.iter())),
            ..MorphMesh::default()
        };
        let world = self.world_of(&alone, body);
        [world[0], world[1], world[2]]
    }

    /// The world-space box around the vertices that a body's triangles use: its minimum and maximum.
    ///
    /// # Panics
    /// If there is not one weight per target.
    pub fn world_box(&self, meshes: Meshes<'_>, body: usize) -> (DVec3, DVec3) {
        let mesh = meshes[body];
        let world = self.world_vertices(meshes, body);
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let used = mesh.triangles.iter().flatten().filter_map(|&v| world.get(v as usize));
        used.fold(empty, |(min, max), &p| (min.min(p), max.max(p)))
    }

    /// The sum of the radii of the bounding spheres of both bodies' world-space boxes.
    ///
    /// # Panics
    /// If there is not one weight per target.
    pub fn sizes(&self, meshes: Meshes<'_>) -> f64 {
        let radius = |body| {
            let (min, max) = self.world_box(meshes, body);
            (max - min).length() * 0.5
        };
        radius(0) + radius(1)
    }

    /// Moves the second body so that the middle of its box is `apart` from the first one's, in units of [`Situation::sizes`],
    /// up to the rounding of the translation to `f32`.
    ///
    /// # Panics
    /// If there is not one weight per target.
    pub fn bring_together(&mut self, meshes: Meshes<'_>, apart: DVec3) {
        let [middle_a, middle_b] = [0, 1].map(|body| {
            let (min, max) = self.world_box(meshes, body);
            (min + max) * 0.5
        });
        let translation = self.places[1].translation.as_dvec3() + (middle_a - middle_b) + apart * self.sizes(meshes);
        self.places[1].translation = translation.as_vec3().into();
    }
}
