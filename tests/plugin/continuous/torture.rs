//! Bodies that collapse, become huge, turn inside out or slide over each other in one frame: the work of every update has a bound.

use std::ops::Range;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::make_continuous;
use crate::actors::{Actor, blobs, skinned_blob};
use crate::support::{Edits, add_mesh, app, diagnostics, seeds, settle, spawn};

/// Tests of features by exact arithmetic that a pair may take, and that all pairs of an update share (`narrow_phase/motion`).
const EXACT_PER_PAIR: u64 = 20;
const EXACT_SHARED: u64 = 300;
/// The features of a pair of triangles are compared as a whole.
const ONE_PAIR_OF_TRIANGLES: u64 = 15;

/// The largest number of exact tests that an update may take.
fn most_exact(swept_pairs: u64) -> u64 {
    swept_pairs * (EXACT_PER_PAIR + 2 * ONE_PAIR_OF_TRIANGLES) + EXACT_SHARED
}

/// The work of the last update, checked against its bound.
fn check(app: &App, context: &str) -> u64 {
    let MorphCollisionDiagnostics {
        swept_pairs,
        swept_stats,
        ..
    } = diagnostics(app);
    let exact = swept_stats.exact_feature_tests;
    assert!(
        exact <= most_exact(swept_pairs),
        "{context}: {swept_pairs} pairs, {swept_stats:?}"
    );
    let other = swept_stats.node_tests + swept_stats.triangle_tests + 64 * swept_stats.feature_tests;
    let most = 2 * (swept_pairs * 210_000 + 3_000_000);
    assert!(other <= most, "{context}: {swept_pairs} pairs, {swept_stats:?}");
    exact
}

/// One of the things that games and bugs do to a body in a frame.
fn torment(app: &mut App, actor: &Actor, rng: &mut Pcg64Mcg) {
    let targets = actor.mesh.targets.len();
    let entity = actor
        .skin
        .as_ref()
        .map_or(actor.entity, |(joints, _)| joints[rng.random_range(0..2)]);
    let mut place = app.world_mut().get_mut::<Transform>(entity).unwrap();
    let mut weights = None;
    let mut size = [0.0, 0.0, 0.05, 1.0, 1e-20, 1e6][rng.random_range(0..6)];
    if rng.random_bool(0.1) {
        size = [1e10, 1e20, 1e37][rng.random_range(0..3)];
    }
    match rng.random_range(0..16) {
        0 | 1 => place.scale = Vec3::splat(size),
        2 => place.scale = -place.scale,
        3 => place.scale = [Vec3::X, Vec3::new(1.0, 0.0, 1.0)][rng.random_range(0..2)] * size.clamp(0.1, 1.0),
        4 => place.translation = Vec3::ZERO,
        5 => place.translation = [Vec3::ONE * 1e4, Vec3::X * 1e20, Vec3::Y * -1e-20][rng.random_range(0..3)],
        6 => *place = Transform::from_xyz(0.0, 0.3, 0.0),
        7 => weights = Some(vec![[1e37, -1e37, 1e-37, 0.0, 100.0][rng.random_range(0..5)]; targets]),
        8 => place.rotate_local_x(std::f32::consts::PI),
        9 => *place = Transform::from_xyz(rng.random_range(-2.0..2.0), 0.0, 0.0).with_scale(place.scale),
        _ => {
            let at = Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
            *place = Transform::from_translation(at).with_scale(Vec3::splat(0.4));
            weights = Some(vec![0.2; targets]);
        }
    }
    if let Some(weights) = weights {
        let weights = MeshMorphWeights::Value { weights };
        app.insert(actor.entity, weights);
    }
}

/// Two blobs, a skinned one, and two sheets that slide over each other in one plane.
struct Rack {
    app: App,
    actors: Vec<Actor>,
    sheets: [Entity; 2],
}

impl Rack {
    fn new() -> Self {
        let mut app = app();
        let collider = MorphCollider::default().with_continuous(true);
        let mut actors = blobs(&mut app, 1, &[collider; 2]);
        actors.push(skinned_blob(&mut app, (7, 1), collider));
        let sheet = add_mesh(&mut app, &rigid::grid(2.0, 6));
        let sheets = [-1.5, 1.5].map(|x| {
            let sheet = spawn(&mut app, &sheet, x);
            make_continuous(&mut app, sheet, true);
            sheet
        });
        settle(&mut app);
        Self { app, actors, sheets }
    }

    fn step(&mut self, rng: &mut Pcg64Mcg) {
        let Self { app, actors, sheets } = self;
        let actor = &actors[rng.random_range(0..actors.len())];
        torment(app, actor, rng);
        if rng.random_bool(0.2) {
            let slide = rng.random_range(-3.0..3.0);
            let mut place = app.world_mut().get_mut::<Transform>(sheets[0]).unwrap();
            *place =
                Transform::from_xyz(slide, 0.0, 0.0).with_scale(Vec3::splat([1.0, 1.0, 0.0][rng.random_range(0..3)]));
        }
        app.update();
    }
}

/// Two hundred operations for each seed. Returns the number of pairs that were compared on their way.
fn torture(seeds: Range<u64>) -> u64 {
    let mut rack = Rack::new();
    let (mut worst, mut swept, mut limited) = (0, 0, 0);
    for seed in seeds {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        for operation in 0..200 {
            rack.step(&mut rng);
            worst = worst.max(check(&rack.app, &format!("seed {seed}, operation {operation}")));
            let diagnostics = diagnostics(&rack.app);
            swept += diagnostics.swept_pairs;
            limited += diagnostics.limited_pairs;
        }
    }
    println!("{swept} pairs on their way, {limited} cut short, at most {worst} exact tests in an update");
    swept
}

#[test]
fn no_update_takes_more_exact_tests_than_its_limit() {
    let half = seeds(10) / 2;
    assert!(torture(0..half) >= 60 * half);
}

// A second test, to use another thread.
#[test]
fn no_update_takes_more_exact_tests_than_its_limit_with_other_seeds() {
    let (half, all) = (seeds(10) / 2, seeds(10));
    assert!(torture(half..all) > 60 * (all - half));
}

/// Two continuous spheres of 1,620 triangles at x = -0.8 and 0.8 below one parent.
fn spheres() -> (App, Entity, [Entity; 2]) {
    let mut app = app();
    let sphere = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Sphere::new(0.5).mesh().ico(8).unwrap());
    let spheres = [-0.8, 0.8].map(|x| spawn(&mut app, &sphere, x));
    for sphere in spheres {
        make_continuous(&mut app, sphere, true);
    }
    let parent = app.world_mut().spawn(Transform::default()).add_children(&spheres).id();
    settle(&mut app);
    (app, parent, spheres)
}

#[test]
fn spheres_that_shrink_with_their_parent_cost_little_and_touch_at_the_end() {
    let (mut app, parent, [a, b]) = spheres();
    for frame in (0..20).rev() {
        let mut place = app.world_mut().get_mut::<Transform>(parent).unwrap();
        place.scale = Vec3::splat(frame as f32 / 20.0);
        app.update();
        check(&app, &format!("frame {frame}"));
    }
    let stats = diagnostics(&app).swept_stats;
    assert!(
        stats.exact_feature_tests < 20 && stats.feature_tests < 3000,
        "{stats:?}"
    );
    let collisions = app.world().resource::<MorphCollisions>();
    let impact = collisions.get(a, b).unwrap().impact.unwrap();
    assert_eq!(impact.latest, 1.0);
    assert_eq!(diagnostics(&app).limited_pairs, 0);
}

#[test]
fn spheres_that_become_extreme_in_one_frame_cost_little() {
    let (mut app, parent, spheres) = spheres();
    let (start, mut limited) = (Transform::default(), 0);
    let ends = [0.0, 1e-20, 1e6, 1e10, 1e20, -1.0].map(|scale| Transform::from_scale(Vec3::splat(scale)));
    for end in ends {
        // Both at one point, each at its own place, and through each other.
        for x in [0.0, 0.8, -0.8] {
            let mut put = |of_parent: Transform, of_sphere: Transform, x: f32| {
                *app.world_mut().get_mut::<Transform>(parent).unwrap() = of_parent;
                for (sphere, side) in spheres.into_iter().zip([-1.0, 1.0]) {
                    let place = of_sphere.with_translation(Vec3::X * (side * x));
                    *app.world_mut().get_mut::<Transform>(sphere).unwrap() = place;
                    app.remove::<MorphTeleported>(sphere);
                }
            };
            put(start, start, 0.8);
            for sphere in spheres {
                app.insert(sphere, MorphTeleported);
            }
            app.update();
            let mut place = |entity: Entity, to: Transform| *app.world_mut().get_mut::<Transform>(entity).unwrap() = to;
            for (sphere, side) in spheres.into_iter().zip([-1.0, 1.0]) {
                place(sphere, end.with_translation(Vec3::X * (side * x)));
            }
            app.update();
            check(&app, &format!("{end:?}, {x}"));
            limited += diagnostics(&app).limited_pairs;
        }
    }
    // Huge ones, and those that meet in a point on the way.
    assert!(limited <= 9, "{limited}");
}
