//! Rays, shapes and points, as a game asks about them in every frame.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::digest::Digest;

/// Asks a few random questions about what is on the stage.
pub(crate) fn ask(In(seed): In<u64>, spatial: MorphSpatialQuery) -> Digest {
    let (mut rng, mut digest) = (Pcg64Mcg::seed_from_u64(seed), Digest::default());
    let filter = MorphQueryFilter::default();
    for _ in 0..3 {
        let (from, direction) = aim(&mut rng);
        let hit = spatial.cast_ray(from, direction, 20.0, &filter);
        add(&mut digest, hit.as_ref(), &spatial);
    }
    let (from, direction) = aim(&mut rng);
    for hit in spatial.ray_hits(from, direction, 20.0, &filter.clone().with_only_front()) {
        add(&mut digest, Some(&hit), &spatial);
    }
    for shape in [
        MorphShape::Ball { radius: 0.2 },
        MorphShape::Capsule {
            half_length: 0.3,
            radius: 0.1,
        },
    ] {
        let (from, direction) = aim(&mut rng);
        let rotation = Quat::from_rotation_z(rng.random_range(-3.0..3.0));
        if let Some(hit) = spatial.cast_shape(&shape, from, rotation, direction, 20.0, &filter) {
            digest.entity(hit.entity);
            digest.float(hit.distance);
            digest.vector(hit.point);
            digest.vector(hit.normal);
            digest.add(hit.triangle.into());
        }
        let inside = from + 5.0 * *direction;
        for entity in spatial.shape_intersections(&shape, inside, rotation, &filter) {
            digest.entity(entity);
        }
    }
    let (from, direction) = aim(&mut rng);
    if let Some(closest) = spatial.project_point(from + 4.0 * *direction, 3.0, &filter) {
        digest.entity(closest.entity);
        digest.float(closest.distance);
        digest.vector(closest.point);
        digest.add(closest.triangle.into());
    }
    digest
}

/// From somewhere around the stage to somewhere near its middle.
fn aim(rng: &mut Pcg64Mcg) -> (Vec3, Dir3) {
    let mut along = |reach: f32| rng.random_range(-reach..reach);
    let from = Vec3::new(along(5.0), 4.0 + along(1.0), along(5.0));
    let to = Vec3::new(along(2.0), 0.8 + along(0.8), along(2.0));
    // `from` is always above `to`.
    (from, Dir3::new(to - from).unwrap_or(Dir3::NEG_Y))
}

fn add(digest: &mut Digest, hit: Option<&MorphRayHit>, spatial: &MorphSpatialQuery) {
    digest.add(u64::from(hit.is_some()));
    let Some(hit) = hit else { return };
    digest.entity(hit.entity);
    digest.add(hit.triangle.into());
    digest.float(hit.distance);
    digest.vector(hit.point);
    digest.vector(hit.normal);
    digest.vector(hit.velocity(spatial).unwrap_or_default());
}
