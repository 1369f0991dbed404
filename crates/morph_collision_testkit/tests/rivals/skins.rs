//! Methods that support joints, on skinned models.

use morph_collision::batch::Wanted;
use morph_collision_testkit::moments::{self, Moment};
use morph_collision_testkit::rivals::{MethodKind, MethodOptions};

use crate::agree;
use crate::methods;

#[test]
fn methods_for_skins_agree_on_skinned_models_in_every_pose() {
    let mut pairs = 0;
    for moment in moments::skinned() {
        pairs += agree(&moment, &MethodOptions::default(), MethodKind::supports_skins);
        for kind in methods().filter(|kind| !kind.supports_skins()) {
            let refused = moment.answer(kind, &MethodOptions::default(), Wanted::All);
            let told = refused.map(|_| ()).map_err(|error| error.to_string());
            assert_eq!(told, Err(format!("mesh 0 is skinned, which {kind} does not support")));
        }
    }
    assert!(pairs > 1000, "only {pairs} pairs to find");
}

/// Data computed for other joints must not be reused.
#[test]
fn methods_for_skins_agree_pose_after_pose() {
    let moments: Vec<Moment> = moments::skinned();
    for of_mesh in moments.chunk_by(|a, b| a.meshes[0].name == b.meshes[0].name) {
        let truths: Vec<_> = of_mesh.iter().map(Moment::truth).collect();
        for kind in methods().filter(|kind| kind.supports_skins()) {
            let mut method = kind
                .set_up(&of_mesh[0].meshes, &[0, 0], &MethodOptions::default())
                .unwrap();
            for (moment, truth) in of_mesh.iter().zip(&truths) {
                for (body, (_, weights, place)) in moment.bodies.iter().enumerate() {
                    method.set_joints(body, moment.joints_of(body).unwrap()).unwrap();
                    method.set_body(body, weights, place).unwrap();
                }
                let mut pairs = Vec::new();
                method.collide(0, 1, Wanted::All, &mut pairs);
                let mut found: Vec<_> = pairs
                    .iter()
                    .map(|pair| [0, 1, pair.triangle_a, pair.triangle_b])
                    .collect();
                found.sort_unstable();
                assert!(found == *truth, "{}: {kind:?} finds {}", moment.name, found.len());
            }
        }
    }
}

#[test]
fn joints_of_a_wrong_number_or_not_finite_are_refused() {
    let moment = &moments::skinned()[2];
    for kind in methods()
        .chain([MethodKind::BruteForce])
        .filter(|kind| kind.supports_skins())
    {
        let mut method = kind.set_up(&moment.meshes, &[0], &MethodOptions::default()).unwrap();
        let joints = moment.joints_of(0).unwrap();
        let fewer = method.set_joints(0, &joints[1..]).map_err(|error| error.to_string());
        let (given, needed) = (joints.len() - 1, joints.len());
        assert_eq!(
            fewer,
            Err(format!("{given} joints were given, {needed} are needed")),
            "{kind:?}"
        );
        let mut bad = joints.to_vec();
        bad[2].translation.y = f32::NAN;
        let told = method.set_joints(0, &bad).unwrap_err().to_string();
        assert!(told.contains("joint 2") && told.contains("NaN"), "{kind:?}: {told}");
        let unskinned = &moments::generated()[0];
        let mut method = kind.set_up(&unskinned.meshes, &[0], &MethodOptions::default()).unwrap();
        assert!(method.set_joints(0, joints).is_err());
    }
}
