//! The velocity of the skin where a ray hits it, compared with brute force.

use bevy::ecs::system::RunSystemOnce;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::STEP;

use super::{Stage, extent};
use crate::models::{play, shared};

#[test]
fn a_hit_tells_how_fast_the_skin_of_a_character_that_walks_and_talks_is() {
    let Some(file) = shared("mh_character_low.glb") else {
        return;
    };
    let mut stage = Stage::new(&file, 0.3);
    let (_, clip) = stage
        .clips
        .iter()
        .find(|(name, _)| name == "walk_and_talk")
        .unwrap()
        .clone();
    play(&mut stage.app, &clip, &stage.roots, |index, _| 0.7 * index as f32);
    for _ in 0..3 {
        stage.app.update();
    }
    let all = |stage: &Stage| -> Vec<Vec<DVec3>> { stage.parts.iter().map(|part| stage.vertices(part)).collect() };
    let (mut hits, mut fastest) = (0, 0.0_f64);
    let mut before = all(&stage);
    for frame in 0..90 {
        // The whole character moves too.
        for &root in &stage.roots {
            let mut root = stage.app.world_mut().get_mut::<Transform>(root).unwrap();
            root.translation.z += 0.02;
            root.rotate_y(0.01);
        }
        stage.app.update();
        let now = all(&stage);
        let (min, max) = extent(now.iter().flatten());
        for ray in 0..4 {
            let part = (frame + ray) % stage.parts.len();
            let vertex = (frame * 97 + ray * 401) % now[part].len();
            let outside = DVec3::new((max.x - min.x) * 2.0, 3.0 * f64::from(ray as u32), 2.0 * max.z);
            let (from, to) = (outside.as_vec3(), now[part][vertex].as_vec3());
            let direction = Dir3::new(to - from).unwrap();
            let cast = move |spatial: MorphSpatialQuery| {
                let hit = spatial.cast_ray(from, direction, 1e3, &MorphQueryFilter::default());
                let hit = hit?;
                Some((hit, hit.velocity(&spatial)))
            };
            let Some((hit, velocity)) = stage.app.world_mut().run_system_once(cast).unwrap() else {
                continue;
            };
            let at = stage.parts.iter().position(|part| part.entity == hit.entity).unwrap();
            let corners = stage.parts[at].triangles[hit.triangle as usize];
            let shares = hit.barycentrics.as_dvec3().to_array();
            let place = |vertices: &[DVec3]| -> DVec3 {
                corners
                    .iter()
                    .zip(shares)
                    .map(|(&corner, share)| vertices[corner as usize] * share)
                    .sum()
            };
            let expected = (place(&now[at]) - place(&before[at])) / STEP.as_secs_f64();
            let velocity = velocity.expect("it was there before").as_dvec3();
            // Positions have errors of about 1e-6 of the size, twice, sixty times a second.
            let off = velocity.distance(expected);
            assert!(off < 5e-3, "frame {frame}: {velocity}, not {expected}");
            hits += 1;
            fastest = fastest.max(expected.length());
        }
        before = now;
    }
    println!("{hits} hits, up to {fastest} per second");
    assert!(hits > 200 && fastest > 10.0, "{hits} hits, up to {fastest}");
}
