//! The scenes of models by other people are what they are there for.

use morph_collision_testkit::bench::{Entrant, Experiment, NoExperiment};
use morph_collision_testkit::rivals::{BroadPhase, MethodOptions, Wanted};

type TestResult = Result<(), Box<dyn std::error::Error>>;

/// What one frame comes to.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    /// Pairs of bodies whose boxes overlap.
    candidates: usize,
    /// Pairs of bodies that touch.
    touching: usize,
    /// Pairs of triangles that intersect.
    pairs: usize,
    /// Pairs of triangles that were compared.
    tests: u64,
}

/// A scene, or `None` with a printed reason where its model is not at hand.
fn scene(name: &str, every: usize) -> Result<Option<Experiment>, NoExperiment> {
    match Experiment::named(name, every) {
        Err(NoExperiment::Missing { scene, missing }) => {
            println!("skipped: {scene}: {missing}");
            Ok(None)
        }
        other => other.map(Some),
    }
}

fn count(experiment: &Experiment) -> Result<Vec<Counts>, Box<dyn std::error::Error>> {
    let mut method = Entrant::ALL[0].set_up(experiment, &MethodOptions::default())?.method;
    let (mut broad_phase, mut pairs) = (BroadPhase::default(), Vec::new());
    let mut all = Vec::new();
    for frame in &experiment.frames {
        let before = method.work().triangle_tests;
        let mut counts = Counts::default();
        for (body, (weights, place)) in frame.iter().enumerate() {
            method.set_body(body, weights, place)?;
        }
        for &(a, b) in broad_phase.pairs(method.as_mut(), frame.len()) {
            pairs.clear();
            method.collide(a as usize, b as usize, Wanted::All, &mut pairs);
            counts.candidates += 1;
            counts.touching += usize::from(!pairs.is_empty());
            counts.pairs += pairs.len();
        }
        counts.tests = method.work().triangle_tests - before;
        all.push(counts);
    }
    Ok(all)
}

/// Counts of every frame, and a line about them.
fn told(experiment: &Experiment) -> Result<Vec<Counts>, Box<dyn std::error::Error>> {
    let all = count(experiment)?;
    let mean = |of: &dyn Fn(&Counts) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    let bodies = || experiment.frames.iter().flatten();
    let active = bodies().flat_map(|(weights, _)| weights).filter(|weight| **weight != 0.0);
    let sums = bodies().map(|(weights, _)| f64::from(weights.iter().sum::<f32>()));
    println!(
        "{}: {} frames, {} with contact; a frame has {:.1} pairs of bodies with overlapping boxes, {:.2} that touch, {:.0} pairs of \
         triangles compared, {:.1} that intersect; a body has {:.1} active targets, with a sum of weights of {:.2} at most",
        experiment.title,
        all.len(),
        all.iter().filter(|counts| counts.pairs > 0).count(),
        mean(&|counts| counts.candidates as f64),
        mean(&|counts| counts.touching as f64),
        mean(&|counts| counts.tests as f64),
        mean(&|counts| counts.pairs as f64),
        active.count() as f64 / bodies().count() as f64,
        sums.fold(0.0, f64::max),
    );
    Ok(all)
}

#[test]
fn counts() -> TestResult {
    for name in Experiment::character_names() {
        for every in [20, 5] {
        if let Some(e) = scene(name, every)? {
            let all = told(&e)?;
            println!("{:?}", all.iter().map(|c| (c.touching, c.pairs)).collect::<Vec<_>>());
        }
        }
    }
    Ok(())
}
