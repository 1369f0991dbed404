//! Other numbers that the paper reports, next to ours.

use std::error::Error;

use morph_collision_testkit::bench::{Experiment, Plan, measure as time};
use morph_collision_testkit::report::{NOTHING, Table, percent, range, short};
use morph_collision_testkit::rivals::{MethodKind, PaperOptions, Wanted};

use super::resolution::sizes;
use super::{BINARY, ours, theirs};
use crate::report::candidates::{Candidate, rival};
use crate::report::context::Context;
use crate::report::race::race;
use crate::report::record::{ALL, FIRST, Record, Scene, scene};

const IN_BETWEENS: &str = "in-betweens";
const BEST_STEP: &str = "all, the step that gains most";
const NEIGHBOURS: &str = "neighbours";
const A_VOLUME: &str = "a volume";

pub(super) fn measure(context: &Context) -> Result<Vec<Record>, Box<dyn Error>> {
    let mut rows = in_betweens(context)?;
    for candidate in [ours(), theirs()] {
        rows.push(price_of_a_volume(context, &candidate)?);
    }
    Ok(rows)
}

/// The paper's method without and with volumes between references.
fn in_betweens(context: &Context) -> Result<Vec<Record>, Box<dyn Error>> {
    eprintln!("paper: in-betweens");
    let mut experiment = Experiment::pass_through(5, context.every);
    experiment.name = IN_BETWEENS.to_owned();
    let options = PaperOptions {
        in_betweens: true,
        ..PaperOptions::BOXES
    };
    let candidates = [theirs(), rival(IN_BETWEENS, MethodKind::Paper(options))];
    let rows = race(&experiment, &candidates, Wanted::All, context.rounds)?;
    let measured = context.timed(context.every, context.rounds);
    let mut records: Vec<_> = rows
        .iter()
        .map(|row| Record::new(&experiment, ALL, row, measured.clone()))
        .collect();
    let steps = rows[1].frame_times.iter().zip(&rows[0].frame_times);
    let best = steps
        .map(|(with, without)| with / without)
        .fold(f64::INFINITY, f64::min);
    records.push(Record {
        wanted: BEST_STEP.to_owned(),
        ratio: short(best),
        ..records[1].clone()
    });
    Ok(records)
}

/// The time for a volume, from two neighbours that blend volumes and no vertices.
fn price_of_a_volume(context: &Context, candidate: &Candidate) -> Result<Record, Box<dyn Error>> {
    let mut neighbours = Experiment::neighbours(2);
    neighbours.frames.truncate(100);
    let plan = Plan {
        wanted: Wanted::All,
        rounds: context.rounds,
        split_rounds: context.rounds,
    };
    let rows = time(&neighbours, vec![candidate.set_up(&neighbours)?], plan, || ())?;
    let refit = rows[0].parts.map_or(0.0, |parts| parts.refit) * 1e6;
    let mut record = Record::new(&neighbours, A_VOLUME, &rows[0], context.timed(1, context.rounds));
    record.microseconds = short(refit / record.volumes.max(1.0));
    record.scene = NEIGHBOURS.to_owned();
    Ok(record)
}

pub(super) fn show(rows: &[Record]) -> String {
    let mut table = Table::new(["", "the paper", "here, the method `paper`", "here, `morph`"]);
    for (wanted, title, reported) in [(ALL, "all pairs", "1.5 to 9"), (FIRST, "first pair", "2 to 58")] {
        let over = |method: &str| {
            let ratios = |hybrid: &str| {
                let ratio = |scene: Scene<'_>| Some(scene.ratio(hybrid, wanted)? / scene.ratio(method, wanted)?);
                range(sizes(rows).filter_map(ratio))
            };
            format!(
                "{} (plain code: {}, binary: {})",
                ratios("hybrid"),
                ratios("hybrid-scalar"),
                ratios(BINARY)
            )
        };
        table.row([
            format!("dolphins, {title}: hybrid's time over it"),
            reported.to_owned(),
            over("paper"),
            over("morph"),
        ]);
    }
    let scenes = [
        ("pass-through, all pairs", "15 %", scene(rows, "pass-through-20480")),
        ("largest dolphins, all pairs", "10 %", sizes(rows).last()),
    ];
    for (title, reported, scene) in scenes {
        let saved = |method| scene.and_then(|scene| saved_by_stamps(rows, scene, method));
        let cell = |method| saved(method).unwrap_or(NOTHING.to_owned());
        table.row([
            format!("{title}: saved by stamps"),
            reported.to_owned(),
            cell("paper"),
            cell("morph"),
        ]);
    }
    for (wanted, title, reported) in [
        (ALL, "faster with in-betweens", "+5 %"),
        (BEST_STEP, "the same in the step that gains most", "up to +40 %"),
    ] {
        let ratio = scene(rows, IN_BETWEENS).and_then(|scene| scene.ratio(IN_BETWEENS, wanted));
        let gain = ratio.map_or(NOTHING.to_owned(), |ratio| {
            format!("{:+.0} %", 100.0 * (1.0 / ratio - 1.0))
        });
        table.row([
            format!("pass-through, all pairs: {title}"),
            reported.to_owned(),
            gain,
            String::new(),
        ]);
    }
    format!(
        "{table}\n*Stamps* keep a node from being refitted again in a frame. Neither method has a switch to turn them off, so this is not a measurement: without\n\
         stamps every tested node would be refitted, so the counts with and without are those of volumes blended and of node tests. The time is\n\
         estimated from them at the price of a volume, which two neighbours give that blend volumes and no vertices.\n"
    )
}

/// How many refits, and about how much time, the stamps save.
fn saved_by_stamps(rows: &[Record], of: Scene<'_>, method: &str) -> Option<String> {
    let row = of.row(method, ALL)?;
    let price = scene(rows, NEIGHBOURS)?.row(method, A_VOLUME)?.microseconds;
    let saved = (row.node_tests - row.volumes) * price;
    Some(format!(
        "{:.1} times fewer refits, about {} of time",
        row.node_tests / row.volumes,
        percent(saved / (row.microseconds + saved)),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_save_the_price_of_the_tests_without_a_refit() {
        let row = |scene: &str, wanted: &str, volumes, node_tests, microseconds| Record {
            scene: scene.to_owned(),
            wanted: wanted.to_owned(),
            method: "paper".to_owned(),
            volumes,
            node_tests,
            microseconds,
            ..Record::default()
        };
        let rows = [
            row("a", ALL, 100.0, 400.0, 270.0),
            row(NEIGHBOURS, A_VOLUME, 1.0, 1.0, 0.1),
        ];
        let of = scene(&rows, "a").expect("it is there");
        let saved = saved_by_stamps(&rows, of, "paper");
        assert_eq!(saved.as_deref(), Some("4.0 times fewer refits, about 10 % of time"));
        assert_eq!(saved_by_stamps(&rows, of, "morph"), None);
    }
}
