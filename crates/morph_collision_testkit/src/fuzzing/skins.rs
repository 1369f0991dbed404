use std::sync::Arc;

use glam::{Affine3A, DVec3};
use morph_collision::{BuildOptions, JointMatrices, MorphBvh, PairMemory, PairQuery, Pose, WorldFromModel};

use super::draw::Draw;
use super::one_body::{assert_closest_pair, assert_closest_point, assert_rays};
use super::pairs::assert_pairs;
use crate::oracle::{self, BodyPose};
use crate::verify::{check_containment, check_refitted_containment, check_skinned_containment};
use morph_collision_models::mesh::{MeshSkin, MorphMesh};

/// Poses two small meshes a few times; at least one of them is skinned. Checks every way to ask for their pairs, rays and
/// distances against brute force, and every vertex against the boxes above it.
///
/// # Panics
/// If an answer is wrong.
pub fn skins(data: &[u8]) {
    let mut draw = Draw::new(data);
    let options = [draw.options(), draw.options()];
    let mesh = draw.skinned_mesh();
    let other = match draw.byte() % 4 {
        0 => mesh.clone(),
        1 => draw.mesh(),
        _ => draw.skinned_mesh(),
    };
    let [Some(mut a), Some(mut b)] = [Posed::new(mesh, &options[0]), Posed::new(other, &options[1])] else {
        return;
    };
    let mut memory = PairMemory::new();
    let mut query = PairQuery::new();
    for _ in 0..draw.among(1, 4) {
        a.change(&mut draw);
        b.change(&mut draw);
        a.assert_containment();
        b.assert_containment();
        let [of_a, of_b] = [a.world_vertices(), b.world_vertices()];
        let truth = oracle::intersecting_pairs(&of_a, &a.mesh.triangles, &of_b, &b.mesh.triangles);
        let corners = |mesh: &MorphMesh, world: &[DVec3]| -> Vec<[DVec3; 3]> {
            let triangles = mesh.triangles.iter();
            triangles.map(|corners| corners.map(|v| world[v as usize])).collect()
        };
        let (triangles_a, triangles_b) = (corners(&a.mesh, &of_a), corners(&b.mesh, &of_b));
        assert_rays(&mut draw, a.body(), &triangles_a);
        assert_pairs(&mut query, &mut memory, [a.placed(), b.placed()], &truth);
        assert_closest_pair([a.body(), b.body()], [&triangles_a, &triangles_b], !truth.is_empty());
        assert_closest_point(&mut draw, b.body(), &triangles_b);
    }
}

/// A body and its state.
struct Posed {
    mesh: MorphMesh,
    pose: Pose,
    /// Empty for a mesh without a skin.
    joints: Vec<Affine3A>,
    place: Affine3A,
    world_from_model: WorldFromModel,
    is_refitted: bool,
}

impl Posed {
    /// A body at rest; `None` for a mesh that is refused.
    fn new(mesh: MorphMesh, options: &BuildOptions) -> Option<Self> {
        let model = mesh.to_model().ok()?;
        Some(Self {
            pose: Pose::new(Arc::new(MorphBvh::build(Arc::new(model), options))),
            joints: vec![Affine3A::IDENTITY; mesh.skin.as_ref().map_or(0, MeshSkin::joint_count)],
            mesh,
            place: Affine3A::IDENTITY,
            world_from_model: WorldFromModel::IDENTITY,
            is_refitted: false,
        })
    }

    /// Changes weights, joints and placement. If something is refused, the pose and its boxes stay as they are.
    fn change(&mut self, draw: &mut Draw<'_>) {
        if draw.flag() {
            let weights = draw.weights(self.mesh.targets.len());
            self.is_refitted &= !self.pose.set_weights(&weights).unwrap_or(false);
        }
        if !self.joints.is_empty() {
            let mut joints = self.joints.clone();
            draw.joints(&mut joints);
            if let Ok(matrices) = JointMatrices::new(&joints) {
                let changed = self.pose.set_joints(&matrices).expect("a matrix per joint");
                self.joints = joints;
                self.is_refitted &= !changed;
            }
        }
        // A skinned mesh follows its joints and ignores its placement.
        let place = draw.place();
        if let Ok(world_from_model) = WorldFromModel::new(place) {
            (self.place, self.world_from_model) = (place, world_from_model);
        }
        if draw.byte().is_multiple_of(4) {
            self.pose.refit();
            self.is_refitted = true;
        }
    }

    fn placed(&mut self) -> (&mut Pose, &WorldFromModel) {
        (&mut self.pose, &self.world_from_model)
    }

    fn body(&mut self) -> morph_collision::Body<'_> {
        morph_collision::Body::new(&mut self.pose, &self.world_from_model)
    }

    fn world_vertices(&self) -> Vec<DVec3> {
        let pose = BodyPose {
            mesh: &self.mesh,
            weights: self.pose.weights(),
            world_from_model: self.place,
            joints: (!self.joints.is_empty()).then_some(&self.joints),
        };
        pose.world_vertices()
    }

    fn assert_containment(&mut self) {
        let (mesh, pose) = (&self.mesh, &mut self.pose);
        let report = match (&mesh.skin, self.is_refitted) {
            (Some(_), _) => check_skinned_containment(mesh, &self.joints, pose),
            (None, true) => check_refitted_containment(mesh, pose),
            (None, false) => check_containment(mesh, pose),
        };
        assert_eq!(
            report.first,
            None,
            "weights {:?}, joints {:?}",
            pose.weights(),
            self.joints
        );
    }
}
