//! Compares the library with exact arithmetic on nearly degenerate pairs of triangles: `triangles [PAIRS] [SEED]`.
//!
//! Prints a row per family: the number of pairs, of pairs that intersect, and of answers that differ. If an answer differs, it
//! prints the first such pair of each family and exits with 1.

use std::process::ExitCode;

use morph_collision::{triangle_contact, triangles_intersect};
use morph_collision_testkit::near_degenerate::{Family, Triangle};
use morph_collision_testkit::oracle;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

const PAIRS: u64 = 1_000_000;

/// The results of one family.
#[derive(Default)]
struct Row {
    intersecting: u64,
    differences: u64,
    first_difference: Option<[Triangle; 2]>,
}

fn main() -> ExitCode {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let (Ok(pairs), Ok(seed)) = (numbers.next().unwrap_or(Ok(PAIRS)), numbers.next().unwrap_or(Ok(1))) else {
        eprintln!("usage: triangles [PAIRS] [SEED], both whole numbers");
        return ExitCode::from(2);
    };
    let each = pairs.div_ceil(Family::ALL.len() as u64);
    println!("| family | pairs | intersecting | differences |");
    println!("|---|--:|--:|--:|");
    let mut differences = 0;
    for (family, stream) in Family::ALL.into_iter().zip(0..) {
        let row = judge(
            family,
            each,
            &mut Pcg64Mcg::seed_from_u64(seed.wrapping_mul(0x9e37_79b9) + stream),
        );
        println!(
            "| {} | {each} | {} | {} |",
            family.name(),
            row.intersecting,
            row.differences
        );
        if let Some([a, b]) = row.first_difference {
            println!("\nfirst difference:\na = {a:?}\nb = {b:?}\n");
        }
        differences += row.differences;
    }
    if differences == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn judge(family: Family, pairs: u64, rng: &mut Pcg64Mcg) -> Row {
    let mut row = Row::default();
    for _ in 0..pairs {
        let [a, b] = family.pair(rng);
        let truth = oracle::triangles_intersect(&a, &b);
        row.intersecting += u64::from(truth);
        let agree = triangles_intersect(&a, &b) == truth
            && triangles_intersect(&b, &a) == truth
            && triangle_contact(&a, &b).is_some() == truth;
        if !agree {
            row.differences += 1;
            row.first_difference.get_or_insert([a, b]);
        }
    }
    row
}
