//! Meshes without the vertices that no joint moves.

use morph_collision_models::generated::rigs::tube;

#[test]
fn triangles_of_vertices_without_weights_are_left_out_and_others_keep_their_numbers() {
    let whole = tube(3, 6, 6, 1);
    assert_eq!(whole.clone().leave_out_unweighted(), None);
    let mut mesh = whole.clone();
    let count = mesh.triangles.len() as u32;
    mesh.primitives = vec![0..10, 10..count];
    let lost = mesh.triangles[4][0];
    if let Some(skin) = &mut mesh.skin {
        for set in &mut skin.sets {
            set.weights[lost as usize] = [0.0; 4];
        }
    }
    let left_out = mesh.leave_out_unweighted().expect("a vertex has no weights");
    let has_lost = |triangle: &u32| whole.triangles[*triangle as usize].contains(&lost);
    let expected: Vec<u32> = (0..count).filter(|triangle| !has_lost(triangle)).collect();
    assert_eq!((left_out.vertices, &left_out.kept), (1, &expected));
    assert_eq!(left_out.triangles + mesh.triangles.len(), whole.triangles.len());
    for (triangle, &former) in mesh.triangles.iter().zip(&expected) {
        assert_eq!(*triangle, whole.triangles[former as usize]);
    }
    let first = expected.iter().filter(|triangle| **triangle < 10).count() as u32;
    assert_eq!(mesh.primitives, [0..first, first..expected.len() as u32]);
    let text = left_out.to_string();
    assert!(
        text.starts_with("1 vertex has no joint weights") && text.contains(" triangles with such"),
        "{text}"
    );
    assert_eq!(mesh.leave_out_unweighted(), None);
}
