//! Vertices are where the oracle puts them.

use glam::{Affine3A, Vec3};
use morph_collision_models::generated::rigs::{MOST_JOINTS, branching, rigid_pieces, tube};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle;

#[test]
fn an_empty_target_moves_nothing() {
    let mut mesh = MorphMesh::rigid("m", vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    mesh.targets = vec![Vec::new(), vec![Vec3::Z; 3]];
    let posed = oracle::posed_vertices(&mesh.positions, &mesh.targets, &[5.0, 1.0]);
    assert_eq!(posed, mesh.reference(1));
}

#[test]
fn at_rest_a_rig_is_where_its_mesh_is() {
    let bodies = [
        tube(1, 6, 4, 2),
        tube(6, 20, 12, 0),
        branching(2, 20, 8, 3),
        branching(5, MOST_JOINTS, 3, 0),
    ];
    for mesh in bodies.into_iter().chain([rigid_pieces(3, 7, 2)]) {
        let skin = mesh.skin.as_ref().expect("a rig has a skin");
        let rest = skin.skeleton.at_rest();
        assert!(rest.iter().all(|matrix| *matrix == Affine3A::IDENTITY), "{}", mesh.name);
        let world = oracle::skinned_vertices(&mesh.positions, &skin.sets, &rest);
        for (position, world) in mesh.positions.iter().zip(world) {
            assert!(position.as_dvec3().distance(world) < 1e-6, "{}", mesh.name);
        }
    }
}
