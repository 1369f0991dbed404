//! Counts the instructions of the queries, which do not depend on other load on the machine: `just bench-instructions`.
//!
//! Needs valgrind, and gungraun-runner in the version of the crate `gungraun` (CONTRIBUTING.md). Every query starts with nothing
//! blended.
#![allow(missing_docs, unused_qualifications, reason = "what gungraun's macros make")]

mod two;

use std::hint::black_box;
use std::sync::Arc;

use gungraun::prelude::*;
use morph_collision::{BuildOptions, ContactQuery, DistanceQuery, MorphBvh, PairQuery, Ray, RayQuery};

use two::{Scene, Two};

fn with_ray() -> (Two, Ray) {
    let mut two = Two::new(Scene::Apart);
    let ray = two.ray();
    two.forget();
    (two, ray)
}

#[library_benchmark(setup = Two::new)]
#[bench::pass_through_deep(Scene::PassThroughDeep)]
#[bench::pass_through_shallow(Scene::PassThroughShallow)]
#[bench::dolphins_deep(Scene::DolphinsDeep)]
#[bench::dolphins_shallow(Scene::DolphinsShallow)]
#[bench::heads_cheek(Scene::HeadsCheek)]
fn all_pairs(mut two: Two) -> (Two, usize) {
    let mut pairs = Vec::with_capacity(4096);
    let (a, b) = two.bodies();
    PairQuery::new().all(a, b, &mut pairs);
    (two, black_box(pairs).len())
}

#[library_benchmark(setup = Two::new)]
#[bench::pass_through_deep(Scene::PassThroughDeep)]
#[bench::pass_through_shallow(Scene::PassThroughShallow)]
#[bench::dolphins_deep(Scene::DolphinsDeep)]
#[bench::dolphins_shallow(Scene::DolphinsShallow)]
#[bench::heads_cheek(Scene::HeadsCheek)]
fn first_pair(mut two: Two) -> (Two, bool) {
    let (a, b) = two.bodies();
    let found = PairQuery::new().first(a, b).is_some();
    (two, black_box(found))
}

#[library_benchmark(setup = Two::new)]
#[bench::pass_through_shallow(Scene::PassThroughShallow)]
#[bench::dolphins_deep(Scene::DolphinsDeep)]
fn contacts(mut two: Two) -> (Two, bool) {
    let (a, b) = two.bodies();
    let found = ContactQuery::new().manifold(a, b).is_some();
    (two, black_box(found))
}

#[library_benchmark(setup = Two::new)]
#[bench::apart(Scene::Apart)]
fn distance(mut two: Two) -> (Two, bool) {
    let (a, b) = two.bodies();
    let found = DistanceQuery::new()
        .closest(a, b, f64::INFINITY)
        .is_ok_and(|pair| pair.is_some());
    (two, black_box(found))
}

#[library_benchmark]
#[bench::closest(with_ray())]
fn ray((mut two, ray): (Two, Ray)) -> (Two, bool) {
    let found = RayQuery::new().closest(two.bodies().0, &ray).is_some();
    (two, black_box(found))
}

#[library_benchmark(setup = Two::new)]
#[bench::four_times(Scene::PassThroughDeep)]
fn set_weights(mut two: Two) -> Two {
    two.forget();
    two
}

#[library_benchmark(setup = Two::new)]
#[bench::pass_through(Scene::PassThroughDeep)]
fn world_bounds(mut two: Two) -> (Two, f32) {
    let bounds = two.poses[0].world_bounds(&two.places[0]);
    (two, black_box(bounds).size().x)
}

#[library_benchmark(setup = Two::new)]
#[bench::dolphin(Scene::DolphinsDeep)]
fn build(two: Two) -> (Two, usize) {
    let built = MorphBvh::build(Arc::clone(two.poses[0].bvh().model()), &BuildOptions::default());
    (two, black_box(built).node_count())
}

library_benchmark_group!(
    name = queries,
    benchmarks = [
        all_pairs,
        first_pair,
        contacts,
        distance,
        ray,
        set_weights,
        world_bounds,
        build
    ]
);

main!(library_benchmark_groups = queries);
