//! Goals that are not about another method's time.

use std::error::Error;

use super::super::bytes::{self, Bytes};
use super::super::{kernels, paper, scale, threads};
use super::place;
use crate::record::{ALL, Record};
use crate::store::Store;
use crate::table::{NOTHING, Table, range, ratio};

pub(super) fn table(store: &Store) -> Result<Table, Box<dyn Error>> {
    let (paper, scale): (Vec<Record>, Vec<Record>) = (store.rows(paper::NAME)?, store.rows(scale::NAME)?);
    let bytes: Vec<Bytes> = store.rows(bytes::NAME)?;
    let threads = threads::speeds(&store.rows::<Record>(threads::NAME)?);
    let mut table = Table::new(["", "goal", "reached"]);
    let mut row = |title: &str, goal: &str, reached: Option<String>| {
        table.row([title, goal, reached.as_deref().unwrap_or(NOTHING)]);
    };
    let (dolphins, pass_through) = (paper::powers(&paper), scale::powers(&scale, scale::TRIANGLES));
    let powers = |index: usize| {
        let (dolphins, pass_through) = (dolphins?[index], pass_through?[index]);
        Some(format!(
            "{dolphins:.2} on the dolphins, {pass_through:.2} in the pass-through"
        ))
    };
    row("growth of first pairs with the triangles, as a power", "0.1", powers(1));
    row("growth of all pairs", "", powers(0));
    let baseline = range(kernels::baseline(&store.rows::<Record>(kernels::NAME)?).into_iter());
    row(
        "time with the baseline instruction set, over that with the best one",
        "at most 2",
        Some(baseline),
    );
    let build = range(scale::build_over_parry(&scale));
    row("building, time relative to Parry's, with two targets", "2", Some(build));
    let large = threads
        .iter()
        .find(|run| run.title.starts_with("Pass-through") && run.wanted == ALL);
    let two = large.and_then(|run| run.speeds.iter().find(|(count, _)| *count == 2));
    let two = two.map(|(_, [batch, copies])| format!("{} (two independent copies: {})", ratio(*batch), ratio(*copies)));
    row("two threads in large pairs, throughput relative to one", "1.7", two);
    let tree = |scene: &str| {
        let bytes = bytes.iter().find(|bytes| bytes.scene == scene)?;
        Some(bytes.each(bytes.tree).to_string())
    };
    row(
        "bytes of the tree for each triangle, horse",
        "409",
        tree("horse-gallop"),
    );
    row("bytes of the tree for each triangle, samba", "615", tree("samba"));
    Ok(table)
}

/// Where the rows are from, and what they are about.
pub(super) fn origins(store: &Store) -> Result<Vec<(String, &'static str)>, Box<dyn Error>> {
    let mut origins = Vec::new();
    for (name, title) in [
        (paper::NAME, "dolphins"),
        (scale::NAME, "scale"),
        (kernels::NAME, "instruction sets"),
        (threads::NAME, "threads"),
    ] {
        let rows: Vec<Record> = store.rows(name)?;
        origins.extend(rows.iter().map(|row| (place(&row.measured), title)));
    }
    let bytes: Vec<Bytes> = store.rows(bytes::NAME)?;
    origins.extend(bytes.iter().map(|row| (place(&row.measured), "bytes")));
    Ok(origins)
}
