//! Every method gives the oracle's pairs, on everything that there is to try it on.

use std::collections::BTreeSet;

use glam::DVec3;
use morph_collision::{Aabb, QueryStats};
use morph_collision_testkit::moments::{self, Moment};
use morph_collision_testkit::rivals::{CastRay, MethodKind, MethodOptions, PaperOptions, Wanted};

/// All but the oracle itself, the paper's with every kind of volume, with and without in-betweens.
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
    for step in [45, 200] {
        assert!(all_agree(&moments::pass_through(step), &MethodOptions::default()) > 0);
    }
}

#[test]
fn all_methods_agree_on_real_faces_with_large_and_negative_sums_of_weights() {
    const HEAD: &str = "mh_head_eyes_teeth_arkit52.glb";
    let weights: [fn(usize, usize) -> f32; 3] = [
        |body, target| ((body + target) % 5) as f32 * 0.1,
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

/// What was made with other joints must not show.
#[test]
fn methods_for_skins_agree_pose_after_pose() {
    let moments: Vec<Moment> = moments::skinned();
    for of_mesh in moments.chunk_by(|a, b| a.meshes[0].name == b.meshes[0].name) {
        for kind in methods().filter(|kind| kind.supports_skins()) {
            let mut method = kind
                .set_up(&of_mesh[0].meshes, &[0, 0], &MethodOptions::default())
                .unwrap();
            for moment in of_mesh {
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
                assert!(
                    found == moment.truth(),
                    "{}: {kind:?} finds {}",
                    moment.name,
                    found.len()
                );
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

fn rays_around(bounds: Aabb) -> impl Iterator<Item = CastRay> {
    let (center, radius) = (bounds.center().as_dvec3(), f64::from(bounds.size().max_element()));
    (1..41).map(move |ray| {
        let share = |stride: f64| (f64::from(ray) * stride).fract() - 0.5;
        let side = DVec3::new(share(0.618), share(0.755), share(0.570)).normalize();
        let off = DVec3::new(share(0.325), share(0.414), share(0.732)) * (0.6 * radius);
        let origin = center + side * (2.0 * radius);
        let direction = center + off - origin;
        CastRay { origin, direction }
    })
}

/// From many sides, at bodies in odd places and in every pose.
#[test]
fn methods_that_cast_rays_hit_the_same() {
    let mut hits = 0;
    for moment in moments::generated().into_iter().chain(moments::skinned()) {
        let is_skinned = moment.meshes.iter().any(|mesh| mesh.skin.is_some());
        let of_bodies: Vec<usize> = moment.bodies.iter().map(|(mesh, ..)| *mesh).collect();
        let (mut rays, mut all) = (Vec::new(), Vec::new());
        let kinds = [MethodKind::BruteForce].into_iter().chain(methods());
        for kind in kinds.filter(|kind| kind.casts_rays() && (!is_skinned || kind.supports_skins())) {
            let mut method = kind
                .set_up(&moment.meshes, &of_bodies, &MethodOptions::default())
                .unwrap();
            for (body, (_, weights, place)) in moment.bodies.iter().enumerate() {
                if let Some(joints) = moment.joints_of(body) {
                    method.set_joints(body, joints).unwrap();
                }
                method.set_body(body, weights, place).unwrap();
            }
            if rays.is_empty() {
                let around = |body: usize| rays_around(method.world_bounds(body)).map(move |ray| (body, ray));
                rays = (0..moment.bodies.len()).flat_map(around).collect();
            }
            let found: Vec<_> = rays.iter().map(|(body, ray)| method.cast(*body, ray)).collect();
            all.push((kind, found));
        }
        let (_, expected) = &all[0];
        hits += expected.iter().flatten().count();
        for (kind, found) in &all[1..] {
            for (ray, (expected, found)) in expected.iter().zip(found).enumerate() {
                let is_same = match (expected, found) {
                    (Some(expected), Some(found)) => (expected.t - found.t).abs() <= 1e-6,
                    (expected, found) => expected == found,
                };
                assert!(
                    is_same,
                    "{}: {kind:?}, ray {ray}: {found:?}, not {expected:?}",
                    moment.name
                );
            }
        }
    }
    assert!(hits > 500, "only {hits} hits");
}

#[test]
fn the_brute_force_method_is_the_oracle() {
    let moment = &moments::generated()[0];
    let (found, work) = answer(moment, MethodKind::BruteForce, &MethodOptions::default());
    assert_eq!(found, moment.truth());
    assert!(work.triangle_tests > 0);
}

/// Frames one after the other on the same bodies: what a stamp or a cache forgets shows only here.
#[test]
fn all_methods_agree_frame_after_frame_with_one_body_at_rest_now_and_then() {
    let frames: Vec<Moment> = [150, 155, 155, 160, 210].map(moments::dolphins).into();
    let (first, of_bodies) = (&frames[0], vec![0; frames[0].bodies.len()]);
    for kind in methods() {
        let mut method = kind
            .set_up(&first.meshes, &of_bodies, &MethodOptions::default())
            .unwrap();
        for frame in &frames {
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
            assert_eq!(found, frame.truth(), "{kind:?} in {}", frame.name);
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
fn the_work_is_what_each_method_is_known_for() {
    let moment = moments::pass_through(42);
    let work = |kind| answer(&moment, kind, &MethodOptions::default()).1;
    let (morph, bottom_up, hybrid) = (
        work(MethodKind::Morph),
        work(MethodKind::BottomUp),
        work(MethodKind::Hybrid),
    );
    assert_eq!(bottom_up.vertices_blended, 2 * 10242, "all vertices of both bodies");
    assert_eq!(hybrid.vertices_blended, bottom_up.vertices_blended);
    assert!(morph.vertices_blended * 20 < bottom_up.vertices_blended);
    assert!(hybrid.nodes_blended * 4 < bottom_up.nodes_blended);
    assert!(morph.nodes_blended < hybrid.nodes_blended * 4);
    for options in PaperOptions::all() {
        let paper = work(MethodKind::Paper(options));
        assert!(
            paper.vertices_blended * 20 < bottom_up.vertices_blended,
            "{options:?}: {paper:?}"
        );
        // Its trees have more nodes than triangles.
        assert!(paper.nodes_blended * 10 < 2 * 20480, "{options:?}: {paper:?}");
    }
}

/// The floor is the same tree over a mesh that never moved: it visits what has to be visited, with tight boxes.
#[test]
fn blended_boxes_visit_little_more_than_tight_ones() {
    for (moment, most) in [
        (moments::pass_through(42), 1.55),
        // The weights are those of a target alone: its boxes are tight.
        (moments::pass_through(200), 1.0),
        (moments::dolphins(100), 1.02),
        (moments::dolphins(200), 1.05),
    ] {
        let work = |kind| answer(&moment, kind, &MethodOptions::default()).1;
        let (morph, floor) = (work(MethodKind::Morph), work(MethodKind::RigidFloor));
        for (what, of) in [
            ("node tests", (|work| work.node_tests) as fn(QueryStats) -> u64),
            ("nodes blended", |work| work.nodes_blended),
            ("vertices blended", |work| work.vertices_blended),
            ("triangle tests", |work| work.triangle_tests),
        ] {
            let (ours, least) = (of(morph), of(floor));
            let ratio = ours as f64 / least as f64;
            assert!(
                least > 0 && ratio <= most,
                "{}: {what}, {ours} for {least}, {ratio} times",
                moment.name
            );
        }
    }
}

#[test]
fn a_body_with_the_weights_that_it_had_costs_nothing_again() {
    let moment = moments::dolphins(100);
    for kind in [MethodKind::BottomUp, MethodKind::Hybrid, MethodKind::ParryBvh] {
        let mut method = kind.set_up(&moment.meshes, &[0], &MethodOptions::default()).unwrap();
        let (_, weights, place) = &moment.bodies[0];
        method.set_body(0, weights, place).unwrap();
        let before = method.work();
        assert!(before.nodes_blended > 0);
        method.set_body(0, weights, place).unwrap();
        assert_eq!(method.work(), before, "{kind}");
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
            // Not compared as values: NaN is not NaN.
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
    let error = "octre".parse::<MethodKind>().unwrap_err().to_string();
    assert!(
        error.contains("'octre'") && error.contains("octree, parry-trimesh"),
        "{error}"
    );
}
