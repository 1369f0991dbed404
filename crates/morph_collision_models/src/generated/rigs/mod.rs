//! Generated skinned meshes with targets, and poses for any skeleton.
//!
//! - [`tube`], [`branching`]: closed surfaces around a chain or a tree of joints, with smooth weights.
//! - [`rigid_pieces`]: boxes that follow one joint each. [`random_soup`]: separate triangles with random influences.
//! - [`unnormalised`], [`nearly_normalised`]: the same mesh with weights that do not sum to 1, or not quite.
//! - [`PoseKind`]: joint matrices at random, from the rest pose to collapsed joints.
//!
//! Everything is made of sums, products, quotients and square roots, so it is the same to the last bit on every machine.

mod body;
mod loose;
mod poses;

use glam::{DVec3, Mat4, Vec3};

use super::grid;
use crate::skeleton::{Joint, LocalTransform, Skeleton, SkeletonNode};

pub use self::body::{branching, tube};
pub use self::loose::{nearly_normalised, random_soup, rigid_pieces, unnormalised};
pub use self::poses::PoseKind;

/// The most joints that a GPU's uniform buffer holds in common engines. Generators accept more.
pub const MOST_JOINTS: usize = 256;

/// Joints and their parents, which come before them. They are bound in the rest pose.
struct Bones {
    parents: Vec<Option<usize>>,
    positions: Vec<Vec3>,
}

impl Bones {
    fn new(parents: Vec<Option<usize>>, positions: impl IntoIterator<Item = DVec3>) -> Self {
        let positions = positions.into_iter().map(grid::snap).collect();
        Self { parents, positions }
    }

    fn skeleton(&self) -> Skeleton {
        let node = |(joint, (&parent, &position)): (usize, (&Option<usize>, &Vec3))| SkeletonNode {
            name: format!("joint_{joint}"),
            parent: parent.map(|parent| parent as u32),
            rest: LocalTransform {
                translation: position - parent.map_or(Vec3::ZERO, |parent| self.positions[parent]),
                ..LocalTransform::default()
            },
        };
        let joint = |(node, &position): (usize, &Vec3)| Joint {
            node: node as u32,
            inverse_bind: Mat4::from_translation(-position),
        };
        let both = self.parents.iter().zip(&self.positions);
        Skeleton {
            nodes: both.enumerate().map(node).collect(),
            joints: self.positions.iter().enumerate().map(joint).collect(),
            ..Skeleton::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use morph_collision::JointMatrices;

    use super::*;
    use crate::generated::topology;
    use crate::mesh::MorphMesh;

    fn all() -> Vec<MorphMesh> {
        let loose = [rigid_pieces(3, 7, 2), random_soup(4, 50, 40, 3, 2)];
        let bodies = [
            tube(1, 6, 4, 2),
            branching(2, 20, 8, 3),
            branching(5, MOST_JOINTS, 3, 0),
            tube(6, 20, 12, 0),
        ];
        bodies.into_iter().chain(loose).collect()
    }

    #[test]
    fn every_rig_is_accepted_with_its_influences() -> Result<(), morph_collision::ModelError> {
        for mesh in all() {
            let model = mesh.to_model()?;
            let skin = mesh.skin.as_ref().expect("a rig has a skin");
            assert_eq!(model.joint_count(), Some(skin.joint_count()), "{}", mesh.name);
            let influences = |vertex: usize| {
                let weights = skin.sets.iter().flat_map(move |set| set.weights[vertex]);
                weights.filter(|weight| *weight > 0.0).count()
            };
            let most = (0..mesh.positions.len()).map(influences).max();
            let expected = match &*mesh.name {
                "tube_1" => 4,
                "branching_2" | "soup_rig_4" => 8,
                "branching_5" => 3,
                "tube_6" => 12,
                _ => 1,
            };
            assert_eq!(most, Some(expected), "{}", mesh.name);
        }
        Ok(())
    }

    #[test]
    fn bodies_are_closed_and_their_weights_sum_to_one() {
        for mesh in [tube(1, 6, 4, 2), branching(2, 20, 8, 3)] {
            assert_eq!(topology::open_edge(&mesh.triangles), None, "{}", mesh.name);
            let skin = mesh.skin.as_ref().expect("a rig has a skin");
            for vertex in 0..mesh.positions.len() {
                let sum: f32 = skin.sets.iter().flat_map(|set| set.weights[vertex]).sum();
                assert!((sum - 1.0).abs() < 1e-6, "vertex {vertex}: {sum}");
            }
        }
    }

    #[test]
    fn poses_of_every_kind_are_accepted_and_those_of_the_seed() -> Result<(), morph_collision::InputError> {
        for mesh in all() {
            let skeleton = &mesh.skin.as_ref().expect("a rig has a skin").skeleton;
            for kind in PoseKind::ALL {
                let pose = kind.draw(skeleton, 7);
                assert_eq!(JointMatrices::new(&pose)?.len(), skeleton.joints.len());
                assert_eq!(pose, kind.draw(skeleton, 7));

                assert_eq!(pose == kind.draw(skeleton, 8), kind == PoseKind::Rest, "{kind:?}");
            }
        }
        Ok(())
    }

    #[test]
    fn poses_are_what_their_kind_says() {
        let mesh = branching(2, 60, 4, 0);
        let skeleton = &mesh.skin.as_ref().expect("a rig has a skin").skeleton;
        let of = |kind: PoseKind| kind.draw(skeleton, 3);
        let determinants = |kind| -> Vec<f32> { of(kind).iter().map(|m| m.matrix3.determinant()).collect() };
        assert!(determinants(PoseKind::Turned).iter().all(|d| (d - 1.0).abs() < 1e-4));
        let mirrored = determinants(PoseKind::Mirrored);
        assert!(mirrored.iter().any(|d| (d + 1.0).abs() < 1e-4) && mirrored.iter().any(|d| (d - 1.0).abs() < 1e-4));
        let scaled = determinants(PoseKind::Scaled);
        assert!(scaled.iter().all(|d| (-1e-4..8.001).contains(d)) && scaled.iter().any(|d| *d > 1.5));
        let collapsed = determinants(PoseKind::Collapsed);
        let points = collapsed.iter().filter(|d| **d == 0.0).count();
        assert!(points > 3 && points < 57, "{points}");
        let one = of(PoseKind::OnePoint);
        assert!(one.iter().all(|m| *m == one[0] && m.matrix3 == glam::Mat3A::ZERO));
        for (kind, far) in [(PoseKind::Far, 1e3), (PoseKind::VeryFar, 1e5)] {
            assert!(
                of(kind)
                    .iter()
                    .all(|m| (m.translation.length() / far - 1.0).abs() < 0.1),
                "{kind:?}"
            );
        }
    }

    #[test]
    fn unnormalised_weights_sum_to_anything_from_zero_to_three() {
        let mesh = unnormalised(&tube(1, 6, 4, 2), 9);
        let skin = mesh.skin.as_ref().expect("a rig has a skin");
        let sum = |vertex: usize| skin.sets.iter().flat_map(|set| set.weights[vertex]).sum::<f32>();
        let sums: Vec<f32> = (0..mesh.positions.len()).map(sum).collect();
        assert!(sums.iter().all(|sum| (0.0..3.001).contains(sum)));
        let share = |test: &dyn Fn(f32) -> bool| sums.iter().filter(|sum| test(**sum)).count() * 100 / sums.len();
        assert!(share(&|sum| sum == 0.0) >= 3 && share(&|sum| sum > 1.5) >= 20 && share(&|sum| sum < 0.9) >= 15);
        assert!(mesh.to_model().is_ok());
    }

    #[test]
    fn nearly_normalised_weights_are_off_by_roundings_to_both_sides() {
        let mesh = nearly_normalised(&rigid_pieces(3, 7, 0), 9);
        let skin = mesh.skin.as_ref().expect("a rig has a skin");
        let weights = skin.sets[0].weights.iter().map(|weights| weights[0]);
        let off: Vec<f32> = weights.map(|weight| (weight - 1.0) / f32::EPSILON).collect();
        assert!(off.iter().all(|off| off.abs() <= 2.0), "{off:?}");
        assert!(
            off.iter().any(|off| *off > 0.9) && off.iter().any(|off| *off < -0.9),
            "{off:?}"
        );
    }
}
