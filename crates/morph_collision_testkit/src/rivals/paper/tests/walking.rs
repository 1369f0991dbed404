//! What queries blend.

use glam::{Affine3A, Vec3};

use super::super::{PaperOptions, PaperVolume};
use crate::rivals::{Method, MethodKind};
use morph_collision::batch::Wanted;
use morph_collision_models::generated::dolphin;

/// Two dolphins, the second moved along x.
fn two(options: PaperOptions, weights: [f32; 2], x: f32, method: &mut Option<Box<dyn Method>>) -> usize {
    let method = method.get_or_insert_with(|| {
        MethodKind::Paper(options)
            .set_up(&[dolphin(1)], &[0, 0], &Default::default())
            .unwrap()
    });
    method.set_body(0, &weights, &Affine3A::IDENTITY).unwrap();
    let place = Affine3A::from_translation(Vec3::new(x, 0.0, 0.1));
    method.set_body(1, &weights, &place).unwrap();
    let mut pairs = Vec::new();
    method.collide(0, 1, Wanted::All, &mut pairs);
    pairs.len()
}

#[test]
fn volumes_and_vertices_are_blended_once_for_the_same_weights_and_only_where_a_query_looks() {
    for options in PaperOptions::all() {
        let mut method = None;
        assert_eq!(two(options, [0.3, 0.2], 100.0, &mut method), 0);
        let work = |method: &Option<Box<dyn Method>>| method.as_ref().map(|method| method.work()).unwrap_or_default();
        let apart = work(&method);
        assert_eq!(
            (apart.node_tests, apart.nodes_blended, apart.vertices_blended),
            (1, 2, 0),
            "{options:?}"
        );

        assert!(two(options, [0.3, 0.2], 0.05, &mut method) > 0);
        let close = work(&method);
        let nodes = 2 * 2256;
        assert!(close.nodes_blended > 2 && close.vertices_blended > 0, "{close:?}");
        assert!(
            close.vertices_blended < nodes && close.node_tests > 2 * close.nodes_blended,
            "{close:?}"
        );

        assert!(two(options, [0.3, 0.2], 0.05, &mut method) > 0);
        let again = work(&method);
        assert_eq!(again.node_tests, 2 * close.node_tests - apart.node_tests, "{options:?}");
        assert_eq!(again.nodes_blended, close.nodes_blended, "{options:?}");
        assert_eq!(again.vertices_blended, close.vertices_blended, "{options:?}");

        assert!(two(options, [0.3, 0.25], 0.05, &mut method) > 0);
        assert!(work(&method).nodes_blended > again.nodes_blended + 2, "{options:?}");
    }
}

#[test]
fn tighter_volumes_take_fewer_tests() {
    let tests = |volume| {
        let mut method = None;
        let options = PaperOptions {
            volume,
            in_betweens: false,
        };
        assert!(two(options, [0.3, 0.2], 0.05, &mut method) > 0);
        method.map(|method| method.work().node_tests)
    };
    let [aabb, kdop14, kdop18, kdop26, sphere] = PaperVolume::ALL.map(tests);
    assert!(kdop26 < kdop18 && kdop26 < kdop14 && kdop14 < aabb && kdop18 < aabb && aabb < sphere);
}
