//! Measures in exact arithmetic how close the error of a posed vertex comes to its bound.

use glam::Vec3;
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::{Climb, is_as_known};
use rand::RngExt;

use super::{MorphModel, Weights};

/// The error of one posed coordinate, divided by its bound. `numbers` are the base, then the weight and displacement of each target.
fn ratio(numbers: &[f32]) -> Option<f64> {
    let (base, targets) = numbers.split_first()?;
    let pairs = || targets.chunks_exact(2).map(|pair| (pair[0], pair[1]));
    let displacements: Vec<[Vec3; 1]> = pairs().map(|(_, d)| [Vec3::X * d]).collect();
    let weights: Vec<f32> = pairs().map(|(w, _)| w).collect();
    let model = MorphModel::from_displacements(&[Vec3::X * *base], &[[0; 3]], &displacements).ok()?;
    if weights.iter().any(|w| !w.is_finite()) {
        return None;
    }
    let product = |w: f32, d: f32| Dyadic::from(w) * Dyadic::from(d);
    let exact = pairs().map(|(w, d)| product(w, d)).sum::<Dyadic>() + Dyadic::from(*base);
    let reach = pairs().map(|(w, d)| product(w, d).abs()).sum::<Dyadic>() + Dyadic::from(base.abs());
    if reach.to_f64() > 2e37 {
        return None;
    }
    // The bound is g_n R + m 2^-150 with g_n = n u / (1 - n u). Both sides are multiplied by 1 - n u.
    let active = weights.iter().filter(|w| **w != 0.0).count() as f64;
    let n_u = Dyadic::from(active + 1.0) * Dyadic::power_of_two(-24);
    let rest = Dyadic::from(1.0_f64) - n_u.clone();
    let bound = n_u * reach + Dyadic::from(active) * Dyadic::power_of_two(-150) * rest.clone();
    let error = (Dyadic::from(model.blend_vertex(0, &Weights::new(&weights)).x) - exact).abs() * rest;
    assert!(error <= bound, "{numbers:?}");
    Some(error.ratio(&bound))
}

#[test]
fn a_posed_vertex_is_off_by_nearly_its_bound_and_never_by_more() {
    for (targets, known) in [(1, 0.903), (2, 0.760), (8, 0.885), (64, 0.967)] {
        let climb = Climb {
            seed: 1,
            starts: 10,
            steps: 3000 / targets.max(8),
        };
        let (ratio, _) = climb.highest(
            |i, rng| {
                let scale = 2_f32.powi(rng.random_range(-140..100));
                let mut numbers: Vec<f32> = (0..=2 * targets).map(|_| rng.random_range(-1.0..1.0)).collect();
                if i % 2 == 0 {
                    // Products just above half a unit in the last place of the base: every sum rounds up.
                    numbers
                        .iter_mut()
                        .skip(1)
                        .step_by(2)
                        .for_each(|w| *w = 1.0 + w.abs() / 64.0);
                    numbers
                        .iter_mut()
                        .skip(2)
                        .step_by(2)
                        .for_each(|d| *d = 2_f32.powi(-24) * 1.01);
                    numbers[0] = 1.0;
                }
                numbers[0] *= scale;
                numbers.iter_mut().skip(2).step_by(2).for_each(|d| *d *= scale);
                numbers
            },
            ratio,
        );
        println!("posed vertex, {targets} targets: {ratio:.3} of the bound");
        assert!(
            is_as_known(ratio, known),
            "{ratio} of the bound with {targets} targets, known is {known}"
        );
    }
}
