//! `morph-lab steps beside 0.1 motion`: runs steps of two moving dolphins to count instructions. See `just instructions-motion`.
//!
//! The first dolphin swims in place. The second moves by a share of its length in each step, far away, close beside the first one, or
//! through it. `discrete` asks at the end of each step whether they intersect. `motion` asks whether they touch during the step, and
//! `first` asks when. The program reads no clock, because valgrind cannot run the stopwatch of the benchmarks.

use std::sync::Arc;

use clap::{Args, ValueEnum};
use glam::{Affine3A, Vec3};
use morph_collision::motion::{MotionQuery, MovingBody};
use morph_collision::{Body, BuildOptions, MorphBvh, PairQuery, Pose, QueryStats, WorldFromModel};
use morph_collision_cli::shared::{AnyError, Verdict};
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

    fn step(&mut self, phase: f32, at: Vec3) -> Result<(), AnyError> {
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

    fn moving(&mut self) -> Result<MovingBody<'_>, AnyError> {
        let [start, end] = &mut self.poses;
        Ok(MovingBody::new(
            Body::new(start, &self.places[0]),
            Body::new(end, &self.places[1]),
        )?)
    }
}

/// Run steps of two moving dolphins, to count instructions.
#[derive(Debug, Args)]
pub(crate) struct StepsArgs {
    /// Where the second dolphin moves.
    #[arg(value_enum)]
    place: Place,
    /// How far it moves in each step, in its lengths.
    speed: f32,
    /// What to ask.
    #[arg(value_enum)]
    question: Question,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Place {
    Apart,
    Beside,
    Through,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Question {
    /// At the end of each step, whether they intersect.
    Discrete,
    /// Whether they touch during the step.
    Motion,
    /// When they first touch.
    First,
}

pub(crate) fn steps(args: &StepsArgs) -> Result<Verdict, AnyError> {
    let question = args.question;
    let mesh = dolphin(LEVEL);
    let bvh = Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default()));
    let size = Pose::new(bvh.clone()).bounds().size();
    let beside = match args.place {
        Place::Apart => 5.0 * size.x.max(size.y).max(size.z),
        Place::Beside => 1.05 * size.y,
        Place::Through => 0.3 * size.y,
    };
    let length = size.max_element();
    let along = Vec3::AXES[size.max_position()] * length * args.speed;
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
    Ok(Verdict::Clean)
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
) -> Result<bool, AnyError> {
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
) -> Result<bool, AnyError> {
    a.step(0.3 * step as f32, Vec3::ZERO)?;
    b.step(0.2 * step as f32, at)?;
    Ok(match question {
        Question::Discrete => pairs.any(a.now(), b.now()),
        Question::Motion => motions.any(a.moving()?, b.moving()?)?,
        Question::First => motions.first(a.moving()?, b.moving()?, TOLERANCE)?.is_some(),
    })
}
