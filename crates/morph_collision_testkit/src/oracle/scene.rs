//! Every intersecting pair of triangles of a whole scene.

use glam::{Affine3A, DVec3};

use super::{intersecting_pairs, posed_vertices, skinned_vertices, world_vertices};
use morph_collision_models::mesh::MorphMesh;

/// One body of a scene: a mesh, its weights and its placement.
#[derive(Clone, Copy, Debug)]
pub struct BodyPose<'a> {
    /// The mesh, in model space.
    pub mesh: &'a MorphMesh,
    /// One weight per target.
    pub weights: &'a [f32],
    /// Any finite affine; a skinned mesh is placed by its joints instead.
    pub world_from_model: Affine3A,
    /// The matrix of each joint of a skinned mesh, from mesh space to world space; `None` means the identity for each.
    pub joints: Option<&'a [Affine3A]>,
}

impl BodyPose<'_> {
    /// All vertices in world space.
    ///
    /// # Panics
    /// See [`scene_pairs`].
    pub fn world_vertices(&self) -> Vec<DVec3> {
        let posed = posed_vertices(&self.mesh.positions, &self.mesh.targets, self.weights);
        match &self.mesh.skin {
            None => world_vertices(&posed, &self.world_from_model),
            Some(skin) => match self.joints {
                Some(joints) => skinned_vertices(&posed, &skin.sets, joints),
                None => skinned_vertices(&posed, &skin.sets, &vec![Affine3A::IDENTITY; skin.joint_count()]),
            },
        }
    }
}

/// Two bodies that touch, `body_a < body_b`, and their intersecting triangles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyPairs {
    /// Index of the first body.
    pub body_a: u32,
    /// Index of the second body.
    pub body_b: u32,
    /// `(triangle of the first, triangle of the second)`, ascending and never empty.
    pub triangles: Vec<(u32, u32)>,
}

/// All pairs of bodies that touch, in ascending order, with all their intersecting triangles.
///
/// # Panics
///
/// If a body does not have one weight per target, or its mesh names a vertex or a joint that does not exist.
pub fn scene_pairs(bodies: &[BodyPose<'_>]) -> Vec<BodyPairs> {
    let world: Vec<_> = bodies.iter().map(BodyPose::world_vertices).collect();
    let mut touching = Vec::new();
    for b in 0..bodies.len() {
        for a in 0..b {
            let triangles = intersecting_pairs(
                &world[a],
                &bodies[a].mesh.triangles,
                &world[b],
                &bodies[b].mesh.triangles,
            );
            if !triangles.is_empty() {
                touching.push(BodyPairs {
                    body_a: a as u32,
                    body_b: b as u32,
                    triangles,
                });
            }
        }
    }
    touching.sort_by_key(|pairs| (pairs.body_a, pairs.body_b));
    touching
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn lifted_triangle() -> MorphMesh {
        MorphMesh {
            name: "triangle".into(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            target_names: vec!["up".into()],
            targets: vec![vec![Vec3::Z; 3]],
            ..MorphMesh::default()
        }
    }

    #[test]
    fn bodies_touch_where_weights_and_placement_bring_them_together() {
        let mesh = lifted_triangle();
        let body = |weights, height| BodyPose {
            mesh: &mesh,
            weights,
            world_from_model: Affine3A::from_translation(Vec3::Z * height),
            joints: None,
        };
        let bodies = [
            body(&[0.0], 3.0),
            body(&[0.0], 1.0),
            body(&[0.5], 0.5),
            body(&[2.0], 1.0),
        ];
        let pair = |body_a, body_b| BodyPairs {
            body_a,
            body_b,
            triangles: vec![(0, 0)],
        };
        assert_eq!(scene_pairs(&bodies), [pair(0, 3), pair(1, 2)]);
        assert_eq!(scene_pairs(&bodies[..2]), []);
    }
}
