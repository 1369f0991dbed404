//! The scenes with models by other people show what they were made for.

use morph_collision::batch::Wanted;
use morph_collision::{Aabb, QueryStats};
use morph_collision_testkit::bench::{Entrant, Experiment, NoExperiment};
use morph_collision_testkit::rivals::{BroadPhase, CastHit, MethodOptions};

type TestResult = Result<(), Box<dyn std::error::Error>>;

/// The counts of one frame.
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

/// A scene. If its model is missing, prints the reason and returns `None`.
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
    for (index, frame) in experiment.frames.iter().enumerate() {
        let before = method.work().triangle_tests;
        let mut counts = Counts::default();
        experiment.set_bodies(method.as_mut(), index)?;
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

/// Counts of every frame; also prints a summary line.
fn told(experiment: &Experiment) -> Result<Vec<Counts>, Box<dyn std::error::Error>> {
    let all = count(experiment)?;
    let mean = |of: &dyn Fn(&Counts) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    let bodies = || experiment.frames.iter().flatten();
    let active = bodies()
        .flat_map(|(weights, _)| weights)
        .filter(|weight| **weight != 0.0);
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

/// Checks that numbers of frames and pairs are within ranges.
fn within(name: &str, frames: [usize; 2], touching: [usize; 2], active: [f64; 2]) -> TestResult {
    let Some(experiment) = scene(name, 10)? else {
        return Ok(());
    };
    let counts = told(&experiment)?;
    let with_contact = counts.iter().filter(|counts| counts.pairs > 0).count();
    let most = counts.iter().map(|counts| counts.touching).max().unwrap_or(0);
    let bodies = experiment.frames.iter().flatten().map(|(weights, _)| weights);
    let of_body = bodies.map(|weights| weights.iter().filter(|weight| **weight != 0.0).count() as f64);
    let mean = of_body.sum::<f64>() / (experiment.frames.len() * experiment.bodies) as f64;
    assert_eq!(counts.len(), 40, "{name}");
    assert!(
        (frames[0]..=frames[1]).contains(&with_contact),
        "{name}: {with_contact} frames with contact"
    );
    assert!(
        (touching[0]..=touching[1]).contains(&most),
        "{name}: {most} pairs of bodies touch at most"
    );
    assert!((active[0]..=active[1]).contains(&mean), "{name}: {mean} active targets");
    Ok(())
}

#[test]
fn two_heads_touch_half_of_the_time() -> TestResult {
    within("heads-cheek", [16, 30], [1, 1], [37.0, 43.0])
}

#[test]
fn a_few_neighbours_of_a_crowd_touch_and_sometimes_none() -> TestResult {
    within("heads-crowd", [25, 38], [3, 8], [37.0, 43.0])
}

#[test]
fn horses_and_dancers_meet_and_part_again() -> TestResult {
    within("horse-gallop", [12, 30], [1, 1], [1.8, 2.0])?;
    within("samba", [12, 30], [1, 1], [1.8, 2.0])
}

#[test]
fn walkers_touch_now_and_then_or_always() -> TestResult {
    within("walkers-hands", [8, 32], [1, 1], [37.0, 43.0])?;
    within("walkers-deep", [40, 40], [1, 1], [37.0, 43.0])?;
    within("walkers-crowd", [30, 40], [3, 16], [37.0, 43.0])
}

/// The heads' contacts are between cheek and temple, in front of the ears, on the left of each.
#[test]
fn heads_touch_at_the_cheek() -> TestResult {
    let Some(experiment) = scene("heads-cheek", 100)? else {
        return Err("the head is in assets/".into());
    };
    let mut method = Entrant::ALL[0].set_up(&experiment, &MethodOptions::default())?.method;
    for (body, (weights, place)) in experiment.frames[1].iter().enumerate() {
        method.set_body(body, weights, place)?;
    }
    let (mesh, mut pairs) = (&experiment.mesh, Vec::new());
    method.collide(0, 1, Wanted::All, &mut pairs);
    assert!(pairs.len() > 50, "{} pairs", pairs.len());
    let bounds = Aabb::from_points(mesh.positions.iter().copied());
    for triangle in pairs.iter().flat_map(|pair| [pair.triangle_a, pair.triangle_b]) {
        for corner in mesh.triangles[triangle as usize] {
            let at = (mesh.positions[corner as usize] - bounds.min) / bounds.size();
            let of_cheek = at.x > 0.7 && (0.25..0.65).contains(&at.y) && (0.5..0.9).contains(&at.z);
            assert!(of_cheek, "triangle {triangle} is at {at}");
        }
    }
    Ok(())
}

#[test]
fn weights_are_those_of_faces_and_of_flip_books() -> TestResult {
    for (name, _) in Experiment::characters() {
        let Some(experiment) = scene(name, 13)? else { continue };
        let is_flip_book = !name.starts_with("heads") && !name.starts_with("walkers");
        for (weights, _) in experiment.frames.iter().flatten() {
            assert_eq!(weights.len(), experiment.mesh.targets.len());
            assert!(
                weights.iter().all(|weight| (0.0..=1.0).contains(weight)),
                "{name}: {weights:?}"
            );
            if is_flip_book {
                let active: Vec<usize> = (0..weights.len()).filter(|&target| weights[target] != 0.0).collect();
                assert!(
                    active.len() <= 2 && active.windows(2).all(|two| two[1] == two[0] + 1),
                    "{name}: {active:?}"
                );
                let sum: f32 = weights.iter().sum();
                // Between the base and the first target, the remaining weight is the base's.
                assert!(
                    sum <= 1.000_001 && (sum >= 0.999_999 || active.iter().all(|target| *target == 0)),
                    "{name}: {sum}"
                );
            }
        }
    }
    Ok(())
}

#[test]
fn every_target_of_the_head_moves_when_it_talks() -> TestResult {
    let Some(experiment) = scene("heads-cheek", 1)? else {
        return Err("the head is in assets/".into());
    };
    for (target, name) in experiment.mesh.target_names.iter().enumerate() {
        let moves = |(weights, _): &(Vec<f32>, _)| weights[target] > 0.01;
        assert!(experiment.frames.iter().flatten().any(moves), "{name}");
    }
    Ok(())
}

/// Every pair of triangles of every frame: `[frame, body a, body b, triangle a, triangle b]`, sorted.
fn all_pairs(experiment: &Experiment, entrant: &Entrant) -> Result<Vec<[u32; 5]>, Box<dyn std::error::Error>> {
    let mut method = entrant.set_up(experiment, &MethodOptions::default())?.method;
    let (mut broad_phase, mut pairs, mut all) = (BroadPhase::default(), Vec::new(), Vec::new());
    for (index, frame) in experiment.frames.iter().enumerate() {
        let step = index as u32;
        for (body, (weights, _)) in frame.iter().enumerate() {
            method.prepare(body, weights, experiment.joints_of(index, body))?;
        }
        experiment.set_bodies(method.as_mut(), index)?;
        for &(a, b) in broad_phase.pairs(method.as_mut(), frame.len()) {
            pairs.clear();
            method.collide(a as usize, b as usize, Wanted::All, &mut pairs);
            all.extend(pairs.iter().map(|pair| [step, a, b, pair.triangle_a, pair.triangle_b]));
        }
    }
    all.sort_unstable();
    Ok(all)
}

#[test]
fn all_entrants_find_the_same_pairs() -> TestResult {
    for (name, _) in Experiment::characters() {
        let Some(experiment) = scene(name, 100)? else { continue };
        let ours = all_pairs(&experiment, &Entrant::ALL[0])?;
        assert!(!ours.is_empty(), "{name}");
        for entrant in Entrant::ALL[1..].iter().filter(|entrant| entrant.supports(&experiment)) {
            let theirs = all_pairs(&experiment, entrant)?;
            assert!(
                theirs == ours,
                "{name}: {} finds {}, morph {}",
                entrant.name,
                theirs.len(),
                ours.len()
            );
        }
    }
    Ok(())
}

/// The hit of each ray, and the work that it took.
type Hits = (Vec<Option<CastHit>>, QueryStats);

/// The hit of every ray in every frame.
fn all_hits(experiment: &Experiment, entrant: &Entrant) -> Result<Hits, Box<dyn std::error::Error>> {
    let mut method = entrant.set_up(experiment, &MethodOptions::default())?.method;
    let mut hits = Vec::new();
    for (index, rays) in experiment.rays.iter().enumerate() {
        experiment.set_bodies(method.as_mut(), index)?;
        hits.extend(rays.iter().map(|ray| method.cast(0, ray)));
    }
    Ok((hits, method.work()))
}

#[test]
fn all_entrants_hit_the_same_triangles_and_boxes_are_nearly_as_good_as_tight_ones() -> TestResult {
    for (name, _) in Experiment::with_rays() {
        let Some(experiment) = scene(name, 40)? else { continue };
        let (ours, work) = all_hits(&experiment, &Entrant::ALL[0])?;
        let hits = ours.iter().flatten().count();
        assert!(
            hits * 10 > ours.len() * 5 && hits < ours.len() + 1,
            "{name}: {hits} of {}",
            ours.len()
        );
        for entrant in Entrant::ALL[1..].iter().filter(|entrant| entrant.supports(&experiment)) {
            let (theirs, tight) = all_hits(&experiment, entrant)?;
            for (ours, theirs) in ours.iter().zip(&theirs) {
                let is_same = match (ours, theirs) {
                    (Some(ours), Some(theirs)) => ours.triangle == theirs.triangle && (ours.t - theirs.t).abs() < 1e-9,
                    (ours, theirs) => ours == theirs,
                };
                assert!(is_same, "{name}: {} hits {theirs:?}, morph {ours:?}", entrant.name);
            }
            if entrant.name == "bottom-up" {
                let ratio = work.node_tests as f64 / tight.node_tests as f64;
                assert!((1.0..=1.4).contains(&ratio), "{name}: {ratio} of the tests");
            }
        }
    }
    Ok(())
}

#[test]
fn names_are_known_and_others_are_told_what_there_is() -> TestResult {
    for name in Experiment::names() {
        let Some(experiment) = scene(name, 200)? else { continue };
        assert_eq!((experiment.name.as_str(), &experiment.steps[..]), (name, &[0, 200][..]));
        assert!(experiment.frames.iter().all(|frame| frame.len() == experiment.bodies));
    }
    let error = Experiment::named("heads", 20).err().ok_or("there is no such scene")?;
    let told = error.to_string();
    assert!(
        told.contains("'heads'") && told.contains("dolphins-564") && told.contains("heads-crowd"),
        "{told}"
    );
    Ok(())
}
