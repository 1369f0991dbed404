//! Runs steps of two moving dolphins to count instructions: `steps beside 0.1 motion`. See `just instructions-motion`.
//!
//! The first dolphin swims in place. The second moves by a share of its length in each step, far away, close beside the first one, or
//! through it. `discrete` asks at the end of each step whether they intersect. `motion` asks whether they touch during the step, and
//! `first` asks when. The program reads no clock, because valgrind cannot run the stopwatch of the benchmarks.

use std::error::Error;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use morph_collision::motion::{MotionQuery, MovingBody};
use morph_collision::{Body, BuildOptions, MorphBvh, PairQuery, Pose, QueryStats, WorldFromModel};
use morph_collision_models::generated::dolphin;

const STEPS: usize = 40;
/// Refines the dolphin to 9024 triangles.
const LEVEL: u32 = 2;
const TOLERANCE: f64 = 1e-3;

/// A body at the end of the last step and of the one before.
struct Swimmer {
    poses: [Pose; 2],
    places: [WorldFromModel; 2],
}

impl Swimmer {
    fn new(bvh: &Arc<MorphBvh>) -> Self {
        Self {
            poses: [0, 1].map(|_| Pose::new(bvh.clone())),
            places: [WorldFromModel::IDENTITY; 2],
        }
    }

    fn step(&mut self, phase: f32, at: Vec3) -> Result<(), Box<dyn Error>> {
        self.poses.swap(0, 1);
        self.places.swap(0, 1);
        let (left, right) = (phase.sin().max(0.0), (-phase.sin()).max(0.0));
        self.poses[1].set_weights(&[left, right])?;
        self.places[1] = WorldFromModel::new(Affine3A::from_translation(at))?;
        Ok(())
    }

    fn now(&mut self) -> Body<'_> {
        Body::new(&mut self.poses[1], &self.places[1])
    }

    fn moving(&mut self) -> Result<MovingBody<'_>, Box<dyn Error>> {
        let [start, end] = &mut self.poses;
        Ok(MovingBody::new(
            Body::new(start, &self.places[0]),
            Body::new(end, &self.places[1]),
        )?)
    }
}

#[derive(Clone, Copy)]
enum Question {
    Discrete,
    Motion,
    First,
}

fn main() -> Result<(), Box<dyn Error>> {
    const USAGE: &str = "usage: steps apart|beside|through LENGTHS discrete|motion|first";
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [place, speed, question] = arguments.as_slice() else {
        return Err(USAGE.into());
    };
    let mesh = dolphin(LEVEL);
    let bvh = Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default()));
    let size = Pose::new(bvh.clone()).bounds().size();
    let beside = match place.as_str() {
        "apart" => 5.0 * size.x.max(size.y).max(size.z),
        "beside" => 1.05 * size.y,
        "through" => 0.3 * size.y,
        _ => return Err(USAGE.into()),
    };
    let question = match question.as_str() {
        "discrete" => Question::Discrete,
        "motion" => Question::Motion,
        "first" => Question::First,
        _ => return Err(USAGE.into()),
    };
    let length = size.max_element();
    let along = Vec3::AXES[size.max_position()] * length * speed.parse::<f32>()?;
    let mut bodies = [Swimmer::new(&bvh), Swimmer::new(&bvh)];
    let path = |step: usize| along * (step as f32 - STEPS as f32 / 2.0) + Vec3::Y * beside;
    let (mut pairs, mut motions) = (PairQuery::new(), MotionQuery::new());
    let (mut touching, mut work) = (0, QueryStats::default());
    // The first pass fills caches and is not counted.
    for counted in [false, true] {
        (touching, work) = (0, QueryStats::default());
        for body in &mut bodies {
            body.step(0.0, Vec3::ZERO)?;
        }
        bodies[1].step(0.0, path(0))?;
        for step in 1..=STEPS {
            let step_of = if counted { counted_step } else { one_step };
            let touch = step_of(&mut bodies, step, path(step), question, &mut pairs, &mut motions)?;
            touching += usize::from(touch);
            work += match question {
                Question::Discrete => pairs.stats(),
                Question::Motion | Question::First => motions.stats(),
            };
        }
    }
    println!(
        "touch in {touching} of {STEPS} steps; {} node tests, {} triangle tests, {} feature tests, {} of them exact",
        work.node_tests, work.triangle_tests, work.feature_tests, work.exact_feature_tests
    );
    Ok(())
}

/// Callgrind is told to collect only in here.
#[inline(never)]
fn counted_step(
    bodies: &mut [Swimmer; 2],
    step: usize,
    at: Vec3,
    question: Question,
    pairs: &mut PairQuery,
    motions: &mut MotionQuery,
) -> Result<bool, Box<dyn Error>> {
    one_step(bodies, step, at, question, pairs, motions)
}

#[inline(never)]
fn one_step(
    [a, b]: &mut [Swimmer; 2],
    step: usize,
    at: Vec3,
    question: Question,
    pairs: &mut PairQuery,
    motions: &mut MotionQuery,
) -> Result<bool, Box<dyn Error>> {
    a.step(0.3 * step as f32, Vec3::ZERO)?;
    b.step(0.2 * step as f32, at)?;
    Ok(match question {
        Question::Discrete => pairs.any(a.now(), b.now()),
        Question::Motion => motions.any(a.moving()?, b.moving()?)?,
        Question::First => motions.first(a.moving()?, b.moving()?, TOLERANCE)?.is_some(),
    })
}
