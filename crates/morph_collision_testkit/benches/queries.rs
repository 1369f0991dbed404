//! Times the queries: `just bench`, or `cargo bench -p morph_collision_testkit --bench queries -- NAME` for some of
//! them.
//!
//! Names that end in `anew` measure queries for which everything has to be blended, names that end in `again` those
//! for which nothing has.
#![allow(missing_docs, reason = "what criterion's macros make")]

mod two;

use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use morph_collision::{BuildOptions, ContactQuery, DistanceQuery, MorphBvh, PairQuery, RayQuery};
use morph_collision_models::generated::{dolphin, pass_through_body};

use two::{Scene, Two};

const TOUCHING: [(&str, Scene); 5] = [
    ("pass-through-20480-deep", Scene::PassThroughDeep),
    ("pass-through-20480-shallow", Scene::PassThroughShallow),
    ("dolphins-9024-deep", Scene::DolphinsDeep),
    ("dolphins-9024-shallow", Scene::DolphinsShallow),
    ("heads-cheek", Scene::HeadsCheek),
];

/// Benchmarks a query about two bodies, with everything to be blended and with nothing.
fn answer<T>(criterion: &mut Criterion, name: &str, scene: Scene, mut question: impl FnMut(&mut Two) -> T) {
    let mut two = Two::new(scene);
    criterion.bench_function(&format!("{name}/anew"), |bencher| {
        bencher.iter(|| {
            two.forget();
            question(&mut two)
        });
    });
    criterion.bench_function(&format!("{name}/again"), |bencher| bencher.iter(|| question(&mut two)));
}

fn pairs(criterion: &mut Criterion) {
    for (name, scene) in TOUCHING {
        let (mut query, mut pairs) = (PairQuery::new(), Vec::new());
        answer(criterion, &format!("pairs/all/{name}"), scene, |two| {
            pairs.clear();
            let (a, b) = two.bodies();
            query.all(a, b, &mut pairs);
            pairs.len()
        });
        let mut query = PairQuery::new();
        answer(criterion, &format!("pairs/first/{name}"), scene, |two| {
            let (a, b) = two.bodies();
            query.first(a, b)
        });
    }
}

fn contacts(criterion: &mut Criterion) {
    for (name, scene) in TOUCHING {
        let mut query = ContactQuery::new();
        answer(criterion, &format!("contacts/manifold/{name}"), scene, |two| {
            let (a, b) = two.bodies();
            query.manifold(a, b).is_some()
        });
    }
}

fn distance(criterion: &mut Criterion) {
    let mut query = DistanceQuery::new();
    answer(criterion, "distance/apart", Scene::Apart, |two| {
        let (a, b) = two.bodies();
        query.closest(a, b, f64::INFINITY)
    });
}

fn ray(criterion: &mut Criterion) {
    let mut query = RayQuery::new();
    let ray = Two::new(Scene::Apart).ray();
    answer(criterion, "ray/closest", Scene::Apart, |two| {
        query.closest(two.bodies().0, &ray)
    });
}

fn pose(criterion: &mut Criterion) {
    let mut two = Two::new(Scene::PassThroughDeep);
    // Twice for each of the two bodies.
    criterion.bench_function("pose/set_weights, four times", |bencher| bencher.iter(|| two.forget()));
    criterion.bench_function("pose/world_bounds/anew", |bencher| {
        bencher.iter(|| {
            two.forget();
            two.poses[0].world_bounds(&two.places[0])
        });
    });
}

fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    group.sample_size(10);
    for (name, mesh) in [
        ("pass-through-20480", pass_through_body()),
        ("dolphin-9024", dolphin(2)),
    ] {
        group.bench_function(format!("model/{name}"), |bencher| bencher.iter(|| mesh.to_model()));
        let model = Arc::new(mesh.to_model().expect("a generated mesh"));
        group.bench_function(format!("tree/{name}"), |bencher| {
            bencher.iter(|| MorphBvh::build(Arc::clone(&model), &BuildOptions::default()));
        });
    }
}

criterion_group!(benches, pairs, contacts, distance, ray, pose, build);
criterion_main!(benches);
