//! `morph-lab triangles [PAIRS] [SEED]`: compares the library with exact arithmetic on nearly degenerate pairs of triangles.
//!
//! Prints a row per family: the number of pairs, of pairs that intersect, and of answers that differ. If an answer differs, it
//! prints the first such pair of each family.

use clap::Args;
use morph_collision::{triangle_contact, triangles_intersect};
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_testkit::near_degenerate::{Family, Triangle};
use morph_collision_testkit::oracle;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::verdict;

/// Compare the library with exact arithmetic on nearly degenerate pairs of triangles.
#[derive(Debug, Args)]
pub(crate) struct TrianglesArgs {
    /// Number of pairs of all families.
    #[arg(default_value_t = 1_000_000)]
    pairs: u64,
    /// Random seed; the same seed gives the same pairs.
    #[arg(default_value_t = 1)]
    seed: u64,
}

/// The results of one family.
#[derive(Default)]
struct Row {
    intersecting: u64,
    differences: u64,
    first_difference: Option<[Triangle; 2]>,
}

pub(crate) fn triangles(&TrianglesArgs { pairs, seed }: &TrianglesArgs) -> Result<Verdict, AnyError> {
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
    Ok(verdict(differences == 0))
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
