//! How time, memory and build time grow with bodies, triangles and targets.

mod growths;
mod sizes;

use std::error::Error;

use morph_collision_testkit::report::{Axis, Figure, Panel, Series, Store, Table, exponent, range, short};
use morph_collision_testkit::rivals::{MethodKind, MethodOptions};

use super::{Measure, Topic};
use crate::report::candidates::{morph, rival};
use crate::report::comparison::AS_USUALLY_WRITTEN;
use crate::report::context::Context;
use crate::report::losses::{Loss, losses};
use crate::report::page::Page;
use crate::report::race::records;
use crate::report::record::{ALL, FIRST, Record, Scene, scenes};

use growths::{GROWTHS, Growth};
use sizes::Bytes;

const NAME: &str = "scale";
const BYTES: &str = "scale_bytes";

const SCALAR: &str = "hybrid-scalar";
const BUILD: &str = "build";
const PARRYS_BUILD: &str = "Parry's binned build";

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::OneCore(measure),
    page,
    losses: |store| {
        let rows: Vec<Record> = store.rows(NAME)?;
        let mut lost = losses(&rows);
        let builds = builds(&rows).filter(|ratio| *ratio < 1.0);
        if builds.clone().next().is_some() {
            lost.push(Loss::new(
                "Building a tree, all sizes",
                BUILD,
                PARRYS_BUILD,
                range(builds),
            ));
        }
        Ok(lost)
    },
};

/// Times of Parry's build over ours.
fn builds(rows: &[Record]) -> impl Iterator<Item = f64> + Clone {
    scenes(rows).filter_map(|scene| scene.ratio(PARRYS_BUILD, BUILD))
}

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let candidates = [
        morph("morph", MethodOptions::default()),
        rival("hybrid", MethodKind::Hybrid),
        rival("bottom-up", MethodKind::BottomUp),
        rival(SCALAR, MethodKind::HybridScalar),
    ];
    let rounds = context.rounds.min(3);
    let (mut rows, mut bytes) = (Vec::new(), Vec::new());
    for growth in GROWTHS {
        for size in growth.sizes(context.quick) {
            eprintln!("{NAME}: {}, {size}", growth.title);
            let experiment = growth.experiment(context, size);
            let mut of_size = records(context, &experiment, &candidates, rounds)?;
            let times = sizes::build_times(&experiment.mesh, rounds)?;
            for (time, method) in times.iter().zip(["morph", PARRYS_BUILD]) {
                of_size.push(Record {
                    scene: growth.scene.to_owned(),
                    title: growth.title.to_owned(),
                    wanted: BUILD.to_owned(),
                    method: method.to_owned(),
                    microseconds: short(time * 1e6),
                    ratio: short(time / times[0]),
                    measured: of_size[0].measured.clone(),
                    ..Record::default()
                });
            }
            rows.extend(of_size.into_iter().map(|row| Record {
                size: Some(size),
                ..row
            }));
            bytes.push(Bytes {
                size: Some(size),
                ..sizes::bytes(&experiment, context.origin.clone())?
            });
        }
    }
    context.store.write(BYTES, &bytes)?;
    context.store.write(NAME, &rows)
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let (rows, bytes): (Vec<Record>, Vec<Bytes>) = (store.rows(NAME)?, store.rows(BYTES)?);
    let (mut tables, mut panels) = (String::new(), Vec::new());
    for growth in GROWTHS {
        tables += &format!("\n**{}.**\n\n{}", growth.title, table(&growth, &rows, &bytes));
        panels.push(panel(&growth, &rows));
    }
    let figure = Figure {
        name: NAME.to_owned(),
        panels,
    };
    let plot = store.plot(&figure, "Time against bodies, triangles and targets")?;
    let page = Page {
        name: NAME,
        title: "Scale",
        intro: "Time of a frame while one number grows, next to the hybrid and the full refit (`bottom-up`), both with our code, and to the hybrid as it is\n\
            usually written, in plain code.\n\
            \n\
            - The columns after our times are multiples of them; *as usually written* is the hybrid.\n\
            - *Power* is the exponent of growth, fitted by least squares over all sizes but a single body.\n\
            - Memory is that of the mesh (base and displacements), of the tree that all bodies share, and of one body's pose after it was asked for all pairs.\n\
            - Building is our default tree with its tables, next to Parry's binned tree over the same triangles at rest, in turns.\n\
            - All targets are active, at weights of both signs. Sizes of 16 of them sum to about 4. They stay there with more targets, or grow along where\n  \
              that is said, to about 70. Our boxes grow looser with the sum of weights, and boxes fitted to the vertices do not; `Pose::refit` makes ours\n  \
              tight while weights stay the same.\n",
        data: &[NAME, BYTES],
        body: format!("{plot}\nBoth axes are logarithmic.\n{tables}"),
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(Record::origin)))
}

fn table(growth: &Growth, rows: &[Record], bytes: &[Bytes]) -> Table {
    let mut table = Table::new([
        growth.axis,
        "all pairs, us",
        "hybrid",
        "full refit",
        AS_USUALLY_WRITTEN,
        "first pair, us",
        "hybrid",
        "full refit",
        AS_USUALLY_WRITTEN,
        "mesh, kB",
        "tree, kB",
        "pose, kB",
        "build, ms",
        "Parry's build, ms",
    ]);
    let of_size = |size| {
        bytes
            .iter()
            .find(move |bytes| bytes.scene == growth.scene && bytes.size == size)
    };
    type Column<'a> = Box<dyn Fn(Scene<'_>) -> Option<f64> + 'a>;
    let time = |method, wanted, unit: f64| -> Column<'_> {
        Box::new(move |scene: Scene<'_>| Some(scene.row(method, wanted)?.microseconds / unit))
    };
    let over = |method, wanted| -> Column<'_> { Box::new(move |scene: Scene<'_>| scene.ratio(method, wanted)) };
    let kilobytes = |of: fn(&Bytes) -> usize| -> Column<'_> {
        Box::new(move |scene: Scene<'_>| Some(of(of_size(scene.size())?) as f64 / 1e3))
    };
    // Digits after the point, and whether a power says anything.
    let columns = [
        (time("morph", ALL, 1.0), 1, true),
        (over("hybrid", ALL), 2, false),
        (over("bottom-up", ALL), 2, false),
        (over(SCALAR, ALL), 2, false),
        (time("morph", FIRST, 1.0), 1, true),
        (over("hybrid", FIRST), 2, false),
        (over("bottom-up", FIRST), 2, false),
        (over(SCALAR, FIRST), 2, false),
        (kilobytes(|bytes| bytes.model), 0, true),
        (kilobytes(|bytes| bytes.tree), 0, true),
        (kilobytes(|bytes| bytes.pose), 1, true),
        (time("morph", BUILD, 1e3), 2, true),
        (time(PARRYS_BUILD, BUILD, 1e3), 2, true),
    ];
    for scene in scenes(rows).filter(|scene| scene.name() == growth.scene) {
        let number = |(column, digits, _): &(Column<'_>, usize, bool)| {
            column(scene).map_or(String::new(), |number| format!("{number:.digits$}"))
        };
        let size = scene.size().map_or(String::new(), |size| size.to_string());
        table.row([size].into_iter().chain(columns.iter().map(number)));
    }
    let power = |(column, _, grows): &(Column<'_>, usize, bool)| {
        let points = points(rows, growth.scene, column);
        if *grows && points.len() > 1 {
            format!("{:.2}", exponent(&points))
        } else {
            String::new()
        }
    };
    table.row(["power".to_owned()].into_iter().chain(columns.iter().map(power)));
    table
}

/// Sizes above 1, and numbers.
fn points(rows: &[Record], series: &str, of: &dyn Fn(Scene<'_>) -> Option<f64>) -> Vec<(f64, f64)> {
    let met = scenes(rows).filter(|scene| scene.name() == series && scene.size() > Some(1));
    met.filter_map(|scene| Some((scene.size()? as f64, of(scene)?)))
        .collect()
}

fn panel(growth: &Growth, rows: &[Record]) -> Panel {
    let lines = [("morph", ALL), ("hybrid", ALL), ("morph", FIRST), ("hybrid", FIRST)];
    let series = lines.into_iter().map(|(method, wanted)| {
        let points = points(rows, growth.scene, &|scene| {
            Some(scene.row(method, wanted)?.microseconds)
        });
        Series {
            name: format!("{method}, {wanted}: {:.2}", exponent(&points)),
            points,
            marked: true,
        }
    });
    Panel {
        title: growth.title.to_owned(),
        x: Axis {
            label: growth.axis,
            log: true,
        },
        y: Axis {
            label: "time of a frame, us",
            log: true,
        },
        series: series.filter(|line| line.points.len() > 1).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A series in which our time grows with this power, and Parry builds in half of our time.
    fn series(scene: &str, power: f64) -> Vec<Record> {
        let row = |size: usize, wanted: &str, method: &str, ratio: f64| Record {
            scene: scene.to_owned(),
            size: Some(size),
            wanted: wanted.to_owned(),
            method: method.to_owned(),
            microseconds: ratio * (size as f64).powf(power),
            ratio,
            ..Record::default()
        };
        let of_size = |size| {
            [
                row(size, ALL, "morph", 1.0),
                row(size, FIRST, "morph", 1.0),
                row(size, BUILD, "morph", 1.0),
                row(size, BUILD, PARRYS_BUILD, 0.5),
            ]
        };
        [1, 10, 100].into_iter().flat_map(of_size).collect()
    }

    #[test]
    fn a_table_has_a_row_for_each_size_and_one_for_powers() {
        let table = table(&GROWTHS[1], &series(GROWTHS[1].scene, 1.0), &[]).to_string();
        assert!(
            table.contains("| 10 | 10.0 | | | | 10.0 | | | | | | | 0.01 | 0.01 |"),
            "{table}"
        );
        assert!(
            table.ends_with("| power | 1.00 | | | | 1.00 | | | | | | | 1.00 | 1.00 |\n"),
            "{table}"
        );
    }
}
