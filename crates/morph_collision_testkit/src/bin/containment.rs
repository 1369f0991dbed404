//! `containment [CHECKS]`: looks for a vertex outside its blended box, over every way to make boxes, with random weights of any size and sign. Exits with 1 if there is one.

use std::process::ExitCode;
use std::sync::Arc;

use morph_collision::{BuildOptions, ContainmentViolation, MorphBvh, MorphModel, Pose};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::{dolphin, pass_through_body, random};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Checks of a vertex and a box for each form, unless the command line says otherwise.
const CHECKS: u64 = 10_000_000;

fn main() -> ExitCode {
    let checks = match std::env::args().nth(1).map(|count| count.parse()) {
        None => CHECKS,
        Some(Ok(count)) => count,
        Some(Err(_)) => {
            eprintln!("containment: error: the number of checks must be a whole number");
            return ExitCode::from(2);
        }
    };
    match run(checks) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("containment: error: {error}");
            ExitCode::from(2)
        }
    }
}

/// The ways to make boxes.
fn forms() -> [(&'static str, BuildOptions); 3] {
    let default = BuildOptions::default;
    [
        ("blended", default()),
        ("leaves of 1", default().with_leaf_size(1)),
        ("anchored", default()),
    ]
}

/// Prints a row for each form; returns how many violations there were.
fn run(checks: u64) -> Result<u64, Box<dyn std::error::Error>> {
    let models: Vec<(String, Arc<MorphModel>)> = meshes()
        .iter()
        .map(|mesh| Ok((mesh.name.clone(), Arc::new(mesh.to_model()?))))
        .collect::<Result<_, Box<dyn std::error::Error>>>()?;
    println!("{:12} {:>12} {:>10}", "form", "checks", "outside");
    let mut outside = 0;
    for (form, options) in forms() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut poses = Vec::new();
        for (name, model) in &models {
            poses.push((name, Pose::new(Arc::new(MorphBvh::build(model.clone(), &options)?))));
        }
        let (mut done, mut violations, mut first) = (0, 0, None);
        while done < checks {
            for (name, pose) in &mut poses {
                let targets = pose.weights().len();
                pose.set_weights(&weights(&mut rng, targets))?;
                if form == "anchored" {
                    pose.take_anchor();
                    pose.set_weights(&weights(&mut rng, targets))?;
                }
                let report = pose.check_containment();
                done += report.checks;
                violations += report.violations;
                first = first.or(report.first.map(|violation| describe(name, pose, &violation)));
            }
        }
        println!("{form:12} {done:12} {violations:10}");
        if let Some(first) = first {
            println!("             {first}");
        }
        outside += violations;
    }
    Ok(outside)
}

fn meshes() -> [MorphMesh; 4] {
    [
        dolphin(0),
        pass_through_body(),
        random::random_blob(5, 3, 12, 0.7),
        random::triangle_soup(6, 300, 5),
    ]
}

/// Weights of every sort: one-hot, convex, signed, sums far above one, huge ones, and tiny ones as exporters leave them.
fn weights(rng: &mut Pcg64Mcg, targets: usize) -> Vec<f32> {
    let mut weights = vec![0.0; targets];
    match rng.random_range(0..6) {
        0 => weights[rng.random_range(0..targets)] = 1.0,
        1 => {
            weights.fill_with(|| rng.random_range(0.0..1.0));
            let sum: f32 = weights.iter().sum();
            weights.iter_mut().for_each(|w| *w /= sum);
        }
        2 => weights.fill_with(|| rng.random_range(-1.0..1.0)),
        3 => weights.fill_with(|| rng.random_range(0.0..4.0)),
        4 => weights.fill_with(|| rng.random_range(-1e6..1e6)),
        _ => {
            weights.fill_with(|| rng.random_range(-1e-7..1e-7));
            weights[rng.random_range(0..targets)] = rng.random_range(0.0..1.0);
        }
    }
    weights
}

fn describe(name: &str, pose: &Pose, violation: &ContainmentViolation) -> String {
    format!(
        "{name}: vertex {} at {} outside its box at depth {}, weights {:?}",
        violation.vertex,
        violation.position,
        violation.depth,
        pose.weights()
    )
}
