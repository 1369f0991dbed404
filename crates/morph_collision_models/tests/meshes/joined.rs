//! Two meshes as one.

use glam::Vec3;
use morph_collision_models::generated::random::random_blob;
use morph_collision_models::generated::rigs::tube;

#[test]
fn a_joined_mesh_moves_like_its_parts() {
    let mut one = random_blob(1, 1, 3, 0.5);
    let mut other = random_blob(2, 1, 3, 0.5);
    one.target_names = ["a", "b", "c"].map(str::to_owned).to_vec();
    other.target_names = ["c", "d", "a"].map(str::to_owned).to_vec();
    one.targets[2] = Vec::new();
    other.targets[1] = Vec::new();
    other.default_weights = vec![0.1, 0.2, 0.3];
    let joined = one.joined(&other).expect("both have no joints");
    assert_eq!(joined.target_names, ["a", "b", "c", "d"]);
    assert_eq!(joined.default_weights, [0.0, 0.0, 0.0, 0.2]);
    let posed = joined.posed(&[0.5, 0.25, 0.75, 1.0]);
    let (first, second) = posed.split_at(one.positions.len());
    assert_eq!(first, one.posed(&[0.5, 0.25, 0.75]));
    // In the order of the joined targets.
    let expected = other.positions.iter().zip(&other.targets[2]).zip(&other.targets[0]);
    let expected: Vec<Vec3> = expected.map(|((&p, &a), &c)| p + a * 0.5 + c * 0.75).collect();
    assert_eq!(second, expected);
    let count = one.triangles.len() + other.triangles.len();
    assert_eq!(joined.triangles.len(), count);
    assert_eq!(joined.primitives.last().map(|range| range.end), Some(count as u32));
    assert!(joined.to_model().is_ok());
}

#[test]
fn joints_are_found_by_name() {
    let one = tube(3, 6, 2, 1);
    let mut other = tube(3, 6, 6, 2);
    let joined = one.joined(&other).expect("the joints are the same");
    let (skin, own) = (joined.skin.as_ref(), one.skin.as_ref());
    let [Some(skin), Some(own)] = [skin, own] else {
        panic!("both have a skin");
    };
    let joints = own.joint_count();
    assert_eq!(skin.joint_count(), 2 * joints);
    let matrices = skin.skeleton.at_rest();
    assert_eq!(matrices[..joints], matrices[joints..]);
    assert!(joined.to_model().is_ok());
    if let Some(skin) = &mut other.skin {
        skin.skeleton.nodes[1].name += "_x";
    }
    let error = one.joined(&other).map_err(|error| error.to_string());
    assert!(error.is_err_and(|error| error.contains("does not have; did you mean")));
    other.skin = None;
    let error = one.joined(&other).map_err(|error| error.to_string());
    assert!(error.is_err_and(|error| error.contains("is moved by joints, ")));
}
