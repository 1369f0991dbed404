//! Triangles that touch only because their vertices are rounded, or that are one rounding apart.

use glam::Vec3;
use morph_collision::proof::WeightBox;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{open_pairs, prove, thorough, touching, tree};

/// A floor at height `z`, and a triangle above it whose lowest corner is at `start` and moved by `displacements` along z.
fn rig(z: f32, start: f32, displacements: &[f32]) -> std::sync::Arc<morph_collision::MorphBvh> {
    let floor = [
        Vec3::new(-2.0, -2.0, z),
        Vec3::new(3.0, -2.0, z),
        Vec3::new(-2.0, 3.0, z),
    ];
    let above = [
        Vec3::new(0.0, 0.0, start),
        Vec3::new(0.5, 0.0, start + 1.0),
        Vec3::new(0.0, 0.5, start + 1.0),
    ];
    let target = |&by: &f32| [[Vec3::ZERO; 3], [Vec3::Z * by; 3]].concat();
    let targets: Vec<Vec<Vec3>> = displacements.iter().map(target).collect();
    tree(&[floor, above].concat(), &[[0, 1, 2], [3, 4, 5]], &targets)
}

#[test]
fn what_touches_by_rounding_alone_is_never_proved_free() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let (mut by_rounding, mut proved) = (0, 0);
    for _ in 0..4000 {
        let targets = rng.random_range(1..6);
        let start = rng.random_range(0.5..1.5_f32);
        let displacements: Vec<f32> = (0..targets).map(|_| -rng.random_range(0.0..0.4_f32)).collect();
        let high: Vec<f32> = (0..targets).map(|_| rng.random_range(0.2..1.0_f32)).collect();
        // The lowest height that is reached, in exact arithmetic up to `f64`, and as it is rounded.
        let moved = displacements.iter().zip(&high);
        let exact = moved
            .clone()
            .fold(f64::from(start), |z, (&d, &w)| z + f64::from(d) * f64::from(w));
        let rounded = moved.fold(start, |z, (&d, &w)| z + d * w);
        let steps = rng.random_range(-1..200);
        let floor = (0..steps).fold(if steps < 0 { rounded.next_up() } else { rounded }, |z, _| {
            z.next_down()
        });
        let bvh = rig(floor, start, &displacements);
        for low in [vec![0.0; targets], high.clone()] {
            let outcome = prove(&bvh, &WeightBox::new(&low, &high).unwrap(), thorough(8));
            let touches = !touching(&bvh, &high).is_empty();
            assert!(
                !touches || !open_pairs(&outcome).is_empty(),
                "{start} {displacements:?} {high:?} {floor}"
            );
            by_rounding += usize::from(touches && exact > f64::from(floor));
            proved += usize::from(outcome.is_free());
        }
    }
    // Both sides of the boundary were tried.
    assert!(
        by_rounding > 20 && proved > 3000,
        "{by_rounding} touch by rounding, {proved} are proved free"
    );
}

#[test]
fn a_touch_at_one_weight_inside_the_box_is_not_missed() {
    // A bump: one target lowers the triangle and another lifts the floor's corner, so that they meet only where both weights are 1 - 2^-24.
    let last = 1.0_f32.next_down();
    let bvh = rig(0.0, last, &[-1.0]);
    let outcome = prove(&bvh, &WeightBox::unit(1), thorough(64));
    assert_eq!(outcome.touching, 1, "{outcome:?}");
    // Up to 1 - 2^-22, it is as far away as the rounding of the bound, so it stays undecided; at 0.999 it is free.
    for (high, is_free) in [(1.0 - 2.0_f32.powi(-22), false), (0.999, true)] {
        let outcome = prove(&bvh, &WeightBox::new(&[0.0], &[high]).unwrap(), thorough(64));
        assert_eq!(
            (outcome.touching, outcome.is_free()),
            (0, is_free),
            "{high}: {outcome:?}"
        );
    }
}
