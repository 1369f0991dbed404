//! Every method gives the oracle's pairs, on everything there is to test.

mod rays;
mod skins;
mod work;

use std::collections::BTreeSet;

use morph_collision::QueryStats;
use morph_collision::batch::Wanted;
use morph_collision_testkit::moments::{self, Moment};
use morph_collision_testkit::rivals::{MethodKind, MethodOptions, PaperOptions};

/// All methods except the oracle; the paper's with every kind of volume, with and without
/// in-betweens.
fn methods() -> impl Iterator<Item = MethodKind> {
    let others = |kind: &MethodKind| !matches!(kind, MethodKind::BruteForce | MethodKind::Paper(_));
    let paper = PaperOptions::all().map(MethodKind::Paper);
    MethodKind::ALL.into_iter().filter(others).chain(paper)
}

fn answer(moment: &Moment, kind: MethodKind, options: &MethodOptions) -> (Vec<[u32; 4]>, QueryStats) {
    moment.answer(kind, options, Wanted::All).unwrap()
}

fn all_agree(moment: &Moment, options: &MethodOptions) -> usize {
    agree(moment, options, |_| true)
}

fn agree(moment: &Moment, options: &MethodOptions, wanted: impl Fn(MethodKind) -> bool) -> usize {
    let truth = moment.truth();
    for kind in methods().filter(|kind| wanted(*kind)) {
        let (found, _) = answer(moment, kind, options);
        let missed = truth.iter().find(|pair| found.binary_search(pair).is_err());
        let spurious = found.iter().find(|pair| truth.binary_search(pair).is_err());
        assert!(
            missed.is_none() && spurious.is_none() && found.len() == truth.len(),
            "{}: {kind:?} finds {} of {}, missed {missed:?}, spurious {spurious:?}",
            moment.name,
            found.len(),
            truth.len(),
        );
        let (first, _) = moment.answer(kind, options, Wanted::First).unwrap();
        let mut touching: Vec<_> = truth.iter().map(|pair| [pair[0], pair[1]]).collect();
        touching.dedup();
        let firsts: Vec<_> = first.iter().map(|pair| [pair[0], pair[1]]).collect();
        assert_eq!(firsts, touching, "{}: {kind:?}, first pairs", moment.name);
        assert!(
            first.iter().all(|pair| truth.binary_search(pair).is_ok()),
            "{}: {kind:?}",
            moment.name
        );
    }
    truth.len()
}

#[test]
fn all_methods_agree_on_generated_models_in_odd_places() {
    let pairs: usize = moments::generated()
        .iter()
        .map(|moment| all_agree(moment, &MethodOptions::default()))
        .sum();
    assert!(pairs > 1000, "only {pairs} pairs to find");
}

#[test]
fn all_methods_agree_whatever_the_arity_and_the_leaf_size() {
    let moment = &moments::generated()[3];
    for arity in [2, 4, 8] {
        for leaf_size in [1, 3, 40, 255] {
            let options = MethodOptions {
                arity,
                ..MethodOptions::default().with_leaf_size(leaf_size).unwrap()
            };
            assert!(all_agree(moment, &options) > 0);
        }
    }
}

#[test]
fn all_methods_agree_in_the_pass_through() {
    assert!(all_agree(&moments::pass_through(200), &MethodOptions::default()) > 0);
}

#[test]
fn all_methods_agree_on_real_faces_with_large_and_negative_sums_of_weights() {
    const HEAD: &str = "mh_head_eyes_teeth_arkit52.glb";
    let weights: [fn(usize, usize) -> f32; 2] = [
        |_, target| if target % 4 == 0 { 0.9 } else { 0.01 },
        |body, target| ((3 * body + 7 * target) % 11) as f32 * 0.2 - 0.9,
    ];
    let mut judged = 0;
    for name in ["MorphStressTest.gltf", HEAD] {
        for weights in weights {
            if let Some(moment) = moments::from_real_model(name, weights).unwrap() {
                assert!(all_agree(&moment, &MethodOptions::default()) > 0, "{name}");
                judged += usize::from(name == HEAD);
            }
        }
    }
    assert_eq!(judged, weights.len(), "the head is in assets/");
}

#[test]
fn the_brute_force_method_is_the_oracle() {
    let moment = &moments::generated()[0];
    let (found, work) = answer(moment, MethodKind::BruteForce, &MethodOptions::default());
    assert_eq!(found, moment.truth());
    assert!(work.triangle_tests > 0);
}

/// Runs consecutive frames on the same bodies, because only this reveals stale stamps and caches.
#[test]
fn all_methods_agree_frame_after_frame_with_one_body_at_rest_now_and_then() {
    let frames: Vec<Moment> = [150, 155, 155, 160, 210].map(moments::dolphins).into();
    let truths: Vec<_> = frames.iter().map(Moment::truth).collect();
    let (first, of_bodies) = (&frames[0], vec![0; frames[0].bodies.len()]);
    for kind in methods() {
        let mut method = kind
            .set_up(&first.meshes, &of_bodies, &MethodOptions::default())
            .unwrap();
        for (frame, truth) in frames.iter().zip(&truths) {
            let mut found = Vec::new();
            for (body, (_, weights, place)) in frame.bodies.iter().enumerate() {
                method.set_body(body, weights, place).unwrap();
            }
            for b in 0..of_bodies.len() {
                for a in 0..b {
                    let mut pairs = Vec::new();
                    method.collide(a, b, Wanted::All, &mut pairs);
                    found.extend(pairs.iter().map(|p| [a as u32, b as u32, p.triangle_a, p.triangle_b]));
                }
            }
            found.sort_unstable();
            assert_eq!(&found, truth, "{kind:?} in {}", frame.name);
        }
    }
}

#[test]
fn boxes_for_the_broad_phase_hold_every_vertex() {
    use morph_collision_testkit::oracle::{posed_vertices, world_vertices};

    for moment in moments::generated() {
        let of_bodies: Vec<usize> = moment.bodies.iter().map(|(mesh, ..)| *mesh).collect();
        for kind in methods().chain([MethodKind::BruteForce]) {
            let mut method = kind
                .set_up(&moment.meshes, &of_bodies, &MethodOptions::default())
                .unwrap();
            for (body, (mesh, weights, place)) in moment.bodies.iter().enumerate() {
                method.set_body(body, weights, place).unwrap();
                let bounds = method.world_bounds(body);
                let mesh = &moment.meshes[*mesh];
                let posed = posed_vertices(&mesh.positions, &mesh.targets, weights);
                let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
                for vertex in world_vertices(&posed, place) {
                    assert!(
                        min.cmple(vertex).all() && vertex.cmple(max).all(),
                        "{}: {kind:?}, {vertex}",
                        moment.name
                    );
                }
            }
        }
    }
}

#[test]
fn bad_weights_and_places_are_refused_by_all_and_leave_the_pose_as_it_was() {
    let moment = moments::dolphins(200);
    let truth = moment.truth();
    let mut messages = BTreeSet::new();
    for kind in methods() {
        let of_bodies = vec![0; moment.bodies.len()];
        let mut method = kind
            .set_up(&moment.meshes, &of_bodies, &MethodOptions::default())
            .unwrap();
        for (body, (_, weights, place)) in moment.bodies.iter().enumerate() {
            method.set_body(body, weights, place).unwrap();
            let errors = [
                method.set_body(body, &[0.0], place),
                method.set_body(body, &[0.0, f32::NAN], place),
                method.set_body(body, &[0.0, f32::MAX], place),
                method.set_body(body, &[0.1, 0.2], &glam::Affine3A::from_scale(glam::Vec3::INFINITY)),
            ];
            assert!(errors.iter().all(Result::is_err), "{kind:?}: {errors:?}");
            // Compared as text, because NaN is not equal to NaN.
            messages.insert(format!("{errors:?}"));
        }
        let mut found = Vec::new();
        for b in 0..of_bodies.len() {
            for a in 0..b {
                let mut pairs = Vec::new();
                method.collide(a, b, Wanted::All, &mut pairs);
                found.extend(pairs.iter().map(|p| [a as u32, b as u32, p.triangle_a, p.triangle_b]));
            }
        }
        found.sort_unstable();
        assert_eq!(found, truth, "{kind:?}");
    }
    assert_eq!(messages.len(), 1, "all refuse in the same words: {messages:?}");
}

#[test]
fn names_lead_back_to_their_methods() {
    for kind in MethodKind::ALL {
        assert_eq!(kind.to_string().parse(), Ok(kind));
    }
    let error = "hybri".parse::<MethodKind>().unwrap_err().to_string();
    assert!(
        error.contains("'hybri'") && error.contains("hybrid, bottom-up"),
        "{error}"
    );
}
