//! Many rays at a crowd that plays a clip: the first ones after a run pose what they look at, and find it posed when they are cast again.

use bevy::ecs::system::SystemState;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::bench::{Stopwatch, median};
use morph_collision_testkit::report::Table;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::run::{Crowd, With};
use crate::characters::Stage;

const RAYS: usize = 1000;

/// Rays from all sides at random places in the boxes of the characters, in turn. The unit of the model is the decimetre.
fn rays(stage: &Stage, random: &mut impl Rng) -> Vec<Ray3d> {
    let places: Vec<Vec3> = stage.roots.iter().filter_map(|&root| place(&stage.app, root)).collect();
    let ray = |&place: &Vec3| {
        let mut any = |half: f32| random.random_range(-half..half);
        let at = place + Vec3::new(any(3.0), 8.0 + any(8.0), any(3.0));
        let towards = Dir3::new(Vec3::new(any(1.0), any(0.2), any(1.0))).unwrap_or(Dir3::X);
        Ray3d::new(at - towards * 30.0, towards)
    };
    places.iter().cycle().take(RAYS).map(ray).collect()
}

fn place(app: &App, root: Entity) -> Option<Vec3> {
    app.world().get::<Transform>(root).map(|place| place.translation)
}

/// Casts all rays.
type Ask = fn(&MorphSpatialQuery, &[Ray3d], &mut Vec<Option<MorphRayHit>>);

/// Times of `ask`, in microseconds for each ray, right after a frame and again.
fn time(stage: &mut Stage, frames: usize, ask: Ask) -> [f64; 2] {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut spatial = SystemState::<MorphSpatialQuery>::new(stage.app.world_mut());
    let mut times = [Vec::new(), Vec::new()];
    let mut hits = Vec::new();
    for _ in 0..frames {
        stage.app.update();
        let rays = rays(stage, &mut random);
        let Ok(query) = spatial.get(stage.app.world_mut()) else {
            continue;
        };
        for times in &mut times {
            let watch = Stopwatch::start();
            ask(&query, &rays, &mut hits);
            times.push(watch.elapsed().as_secs_f64() * 1e6 / RAYS as f64);
        }
    }
    times.map(|times| median(times.into_iter()))
}

fn one_by_one(spatial: &MorphSpatialQuery, rays: &[Ray3d], hits: &mut Vec<Option<MorphRayHit>>) {
    let filter = MorphQueryFilter::default();
    hits.clear();
    hits.extend(
        rays.iter()
            .map(|ray| spatial.cast_ray(ray.origin, ray.direction, 60.0, &filter)),
    );
}

fn together(spatial: &MorphSpatialQuery, rays: &[Ray3d], hits: &mut Vec<Option<MorphRayHit>>) {
    spatial.cast_rays(rays, 60.0, &MorphQueryFilter::default(), hits);
}

/// The time of a ray.
pub(super) fn times(quick: bool) -> Result<String, String> {
    let frames = if quick { 5 } else { 60 };
    let mut stage = Crowd::Clip.stage(With::Collisions)?;
    let mut table = Table::new(["", "after a frame, µs", "cast again, µs"]);
    let ways: [(&str, Ask); 2] = [
        ("`cast_ray`, one by one", one_by_one),
        ("`cast_rays`, together", together),
    ];
    for (name, ask) in ways {
        let times = time(&mut stage, frames, ask).map(|time| format!("{time:.2}"));
        table.row([name.to_owned()].into_iter().chain(times));
    }
    Ok(table.to_string())
}
