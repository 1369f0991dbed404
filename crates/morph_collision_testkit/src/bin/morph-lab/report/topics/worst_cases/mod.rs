//! The worst cases of all queries: bodies that are collapsed, coincident, huge or tiny, and motions that lead there.

mod motions;
mod still;

use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{Body, BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_models::generated::random::random_blob;
use morph_collision_testkit::bench::{Stopwatch, median};
use morph_collision_testkit::report::{Store, Table};
use serde::{Deserialize, Serialize};

use super::Topic;
use crate::report::context::Context;
use crate::report::page::Page;

const NAME: &str = "worst_cases";
const STILL: &str = "worst_cases_still";
const ONE: &str = "worst_cases_one";
const MOTIONS: &str = "worst_cases_motions";

pub(super) const TOPIC: Topic = Topic::on_one_core(NAME, measure, page);

/// Blobs of 1,280 triangles.
const LEVEL: u32 = 3;
/// What a list holds at most, as in the plugin.
const MOST: usize = 8192;

/// A query in a situation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Case {
    situation: String,
    query: String,
    milliseconds: f64,
    answer: String,
    measured: String,
}

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let Context {
        origin, store, rounds, ..
    } = context;
    store.write(STILL, &still::measure(*rounds, origin)?)?;
    store.write(ONE, &still::measure_one(*rounds, origin)?)?;
    store.write(MOTIONS, &motions::measure(*rounds, origin)?)
}

/// Two meshes, each with two poses.
struct Subjects {
    poses: [[Pose; 2]; 2],
}

impl Subjects {
    fn new() -> Result<Self, Box<dyn Error>> {
        let poses = |seed: u64| -> Result<[Pose; 2], Box<dyn Error>> {
            let model = random_blob(seed, LEVEL, 0, 0.0).to_model()?;
            let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
            Ok([Pose::new(bvh.clone()), Pose::new(bvh)])
        };
        Ok(Self {
            poses: [poses(1)?, poses(2)?],
        })
    }
}

fn placed([a, b]: [Affine3A; 2]) -> Result<[WorldFromModel; 2], Box<dyn Error>> {
    Ok([WorldFromModel::new(a)?, WorldFromModel::new(b)?])
}

fn bodies<'a>([a, b]: [&'a mut Pose; 2], [place_a, place_b]: &'a [WorldFromModel; 2]) -> [Body<'a>; 2] {
    [Body::new(a, place_a), Body::new(b, place_b)]
}

/// The median time of some work, in milliseconds, without the first round.
fn milliseconds(rounds: usize, mut work: impl FnMut() -> String) -> (f64, String) {
    let mut answer = String::new();
    let times: Vec<f64> = (0..=rounds)
        .map(|_| {
            let watch = Stopwatch::start();
            answer = black_box(work());
            1e3 * watch.elapsed().as_secs_f64()
        })
        .collect();
    (median(times.into_iter().skip(1)), answer)
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let [still, one, motions]: [Vec<Case>; 3] = [store.rows(STILL)?, store.rows(ONE)?, store.rows(MOTIONS)?];
    let page = Page {
        name: NAME,
        title: "Worst cases",
        intro: "What queries cost when data is at its worst: two meshes of 1280 triangles each, in milliseconds, with the answer.\n",
        data: &[STILL, ONE, MOTIONS],
        body: format!(
            "## Bodies at rest\n\n\
             Lists end after 8192 entries, as in the plugin. NaN and infinite numbers are refused on entry and take no query.\n\n{}\n\
             ## One mesh with itself\n\n\
             `SelfQuery::up_to` of a mesh with a target that collapses it.\n\n{}\n\
             ## Motions\n\n\
             Bodies in one step from one extreme to another (`extremes` in the test kit), with the limit of work that the plugin gives to a single pair in a\n\
             frame. *limit* means that it was reached: the bodies count as touching, or as touching earlier than they do. *all* lists up to 8192 pairs of\n\
             features, *within* those of the first body with itself. *ball* is a ball with a radius of 0.3 that flies through the first body.\n\n{}",
            table(&still),
            table(&one),
            table(&motions),
        ),
        ..Page::default()
    };
    let rows = still.iter().chain(&one).chain(&motions);
    Ok(page.about(rows.map(|row| (row.measured.as_str(), row.situation.as_str()))))
}

/// A row for each situation, a column for each query.
fn table(cases: &[Case]) -> Table {
    let mut queries: Vec<&str> = Vec::new();
    for case in cases {
        if !queries.contains(&case.query.as_str()) {
            queries.push(&case.query);
        }
    }
    let mut table = Table::new([""].into_iter().chain(queries.iter().copied()));
    for of_one in cases.chunk_by(|a, b| a.situation == b.situation) {
        let cell = |query: &&str| {
            let case = of_one.iter().find(|case| case.query == *query);
            case.map_or_else(String::new, |case| format!("{:.2}, {}", case.milliseconds, case.answer))
        };
        let cells = queries.iter().map(cell);
        table.row([of_one[0].situation.clone()].into_iter().chain(cells));
    }
    table
}
