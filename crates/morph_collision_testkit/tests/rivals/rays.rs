//! Methods that cast rays hit what brute force hits.

use glam::DVec3;
use morph_collision::Aabb;
use morph_collision_testkit::moments;
use morph_collision_testkit::rivals::{CastRay, MethodKind, MethodOptions};

use crate::methods;

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

/// From many sides, at bodies with odd placements and in every pose.
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
