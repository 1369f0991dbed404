//! Fig. 8: dolphins of growing resolution.

use std::error::Error;

use morph_collision_testkit::bench::Experiment;
use morph_collision_testkit::report::{Axis, Figure, Panel, Series, Store, Table, exponent};

use super::methods;
use crate::report::context::Context;
use crate::report::race::records;
use crate::report::record::{ALL, FIRST, Record, Scene, scenes};

const SCENE: &str = "dolphins";

pub(super) fn measure(context: &Context) -> Result<Vec<Record>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for level in 0..4 {
        let mut experiment = Experiment::dolphins(level, context.every);
        eprintln!("paper: {}", experiment.title);
        let size = experiment.mesh.triangles.len();
        experiment.name = SCENE.to_owned();
        "Twelve dolphins".clone_into(&mut experiment.title);
        let of_size = records(context, &experiment, &methods(), context.rounds)?;
        rows.extend(of_size.into_iter().map(|row| Record {
            size: Some(size),
            ..row
        }));
    }
    Ok(rows)
}

/// The scenes, by their number of triangles.
pub(super) fn sizes(rows: &[Record]) -> impl Iterator<Item = Scene<'_>> + Clone {
    scenes(rows).filter(|scene| scene.name() == SCENE)
}

/// Triangles, and microseconds of a method.
fn times(rows: &[Record], method: &str, wanted: &str) -> Vec<(f64, f64)> {
    let time = |scene: Scene<'_>| Some((scene.size()? as f64, scene.row(method, wanted)?.microseconds));
    sizes(rows).filter_map(time).collect()
}

pub(super) fn show(store: &Store, rows: &[Record]) -> Result<String, Box<dyn Error>> {
    let (mut tables, mut panels) = (String::new(), Vec::new());
    for (wanted, title) in [(ALL, "all pairs"), (FIRST, "first pair")] {
        let head = sizes(rows).filter_map(Scene::size).map(|size| size.to_string());
        let head = [format!("{title}, us a frame")].into_iter().chain(head);
        let mut table = Table::new(head.chain(["power".to_owned()]));
        let methods = sizes(rows)
            .next()
            .map(|scene| scene.asked(wanted).map(|row| row.method.as_str()));
        let mut series = Vec::new();
        for method in methods.into_iter().flatten() {
            let points = times(rows, method, wanted);
            let cell = |scene: Scene<'_>| {
                let row = scene.row(method, wanted)?;
                Some(format!("{:.0} ({:.2})", row.microseconds, row.ratio))
            };
            let cells = sizes(rows)
                .filter_map(cell)
                .chain([format!("{:.2}", exponent(&points))]);
            table.row([method.to_owned()].into_iter().chain(cells));
            series.push(Series {
                name: format!("{method}: {:.2}", exponent(&points)),
                points,
                marked: true,
            });
        }
        tables += &format!("\n{table}");
        panels.push(Panel {
            title: format!("Twelve dolphins, {title}"),
            x: Axis {
                label: "triangles of a dolphin",
                log: true,
            },
            y: Axis {
                label: "time of a frame, us",
                log: true,
            },
            series,
        });
    }
    let figure = Figure {
        name: "resolution".to_owned(),
        panels,
    };
    let plot = store.plot(&figure, "Time against the number of triangles, twelve dolphins")?;
    Ok(format!(
        "{plot}\nTwelve dolphins of the same shape at four resolutions. Both axes are logarithmic, so a line's slope is the power with which time grows\n\
         (behind the names, fitted by least squares); 1 is linear. In the tables, times in microseconds, and in brackets their ratio to ours.\n{tables}"
    ))
}
