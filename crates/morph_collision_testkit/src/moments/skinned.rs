//! Moments of skinned bodies.

use glam::{Affine3A, Vec3, Vec3A};

use super::Moment;
use morph_collision_models::generated::rigs::{self, PoseKind};
use morph_collision_models::mesh::MorphMesh;

/// Generated skinned models with joints of every kind. The two bodies are close enough to overlap.
pub fn skinned() -> Vec<Moment> {
    let meshes = [
        rigs::tube(31, 6, 4, 3),
        rigs::branching(32, 7, 8, 3),
        rigs::nearly_normalised(&rigs::rigid_pieces(33, 6, 3), 37),
        rigs::random_soup(34, 100, 40, 3, 2),
        rigs::unnormalised(&rigs::tube(35, 3, 3, 3), 36),
    ];
    let mut all = Vec::new();
    for mesh in &meshes {
        let Some(skin) = &mesh.skin else { continue };
        for kind in PoseKind::ALL {
            let joints = [kind.draw(&skin.skeleton, 1), kind.of_body(1).draw(&skin.skeleton, 2)];
            // Poses far from the origin start in different places.
            let origin = |joints: &[Affine3A]| joints.first().map_or(Vec3::ZERO, |joint| joint.translation.into());
            let shift = origin(&joints[0]) - origin(&joints[1]) + Vec3::new(0.1, 0.05, -0.1);
            let [first, mut second] = joints;
            if shift.length() > 100.0 {
                second
                    .iter_mut()
                    .for_each(|joint| joint.translation += Vec3A::from(shift));
            }
            let weights = [vec![0.5, -0.25, 1.5], vec![4.0, 4.0, -2.0]];
            let [of_first, of_second] = weights;
            let name = format!("{}, {kind:?}", mesh.name);
            all.push(pair(name, mesh, [(of_first, first), (of_second, second)]));
        }
    }
    all
}

/// Two bodies of a skinned mesh, with weights and joints.
fn pair(name: String, mesh: &MorphMesh, bodies: [(Vec<f32>, Vec<Affine3A>); 2]) -> Moment {
    let (weights, joints): (Vec<_>, Vec<_>) = bodies.into_iter().unzip();
    Moment {
        name,
        meshes: vec![mesh.clone()],
        bodies: weights
            .into_iter()
            .map(|weights| (0, weights, Affine3A::IDENTITY))
            .collect(),
        joints,
    }
}
