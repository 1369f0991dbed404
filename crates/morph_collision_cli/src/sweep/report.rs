//! The rows as JSON, as CSV and as a table.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write};

use morph_collision_models::text::Grouped;
use morph_collision_models::text::Printable;
use serde::Serialize;

use super::rows::Row;
use crate::messages::counted;
use crate::output::csv_field;
use crate::touching::depth::ThresholdArgs;

/// If there are more rows, the table shows only the worst ones.
const MOST_ROWS: usize = 40;

/// The JSON of `sweep`.
#[derive(Debug, Serialize)]
pub(super) struct SweepReport {
    bodies: Vec<String>,
    frames: usize,
    /// Frames in which anything touches.
    frames_touching: usize,
    /// Whether pairs that touch at rest are left out.
    ignore_rest: bool,
    #[serde(skip)]
    thresholds: ThresholdArgs,
    rows: Vec<Row>,
}

impl SweepReport {
    pub(super) fn new(
        bodies: Vec<String>,
        frames: usize,
        ignore_rest: bool,
        thresholds: ThresholdArgs,
        rows: Vec<Row>,
    ) -> Self {
        let mut touching: Vec<usize> = rows.iter().map(|row| row.frame).collect();
        touching.dedup();
        Self {
            bodies,
            frames,
            frames_touching: touching.len(),
            ignore_rest,
            thresholds,
            rows,
        }
    }

    pub(super) fn anything_touches(&self) -> bool {
        !self.rows.is_empty()
    }

    pub(super) fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "frame,clip,seconds,body_a,body_b,name_a,name_b,pairs,new,depth,targets,joints"
        )?;
        for row in &self.rows {
            writeln!(
                out,
                "{},{},{},{},{},{},{},{},{},{},{},{}",
                row.frame,
                csv_field(row.clip.as_deref().unwrap_or_default()),
                row.seconds.map(|seconds| seconds.to_string()).unwrap_or_default(),
                row.body_a,
                row.body_b,
                csv_field(&self.bodies[row.body_a]),
                csv_field(&self.bodies[row.body_b]),
                row.pairs,
                row.new,
                row.depth,
                csv_field(&row.targets.join("; ")),
                csv_field(&row.joints.join("; "))
            )?;
        }
        Ok(())
    }

    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, text: &mut String) -> std::fmt::Result {
        let (frames, bodies) = (self.frames, self.bodies.len());
        writeln!(
            text,
            "{}, {}",
            counted(frames, "frame", "frames"),
            counted(bodies, "body", "bodies")
        )?;
        for (index, name) in self.bodies.iter().enumerate() {
            writeln!(text, "  body {index}: {}", Printable(name))?;
        }
        if self.rows.len() > MOST_ROWS {
            let rows = Grouped(self.rows.len() as u64);
            writeln!(
                text,
                "The worst frame of each body or pair of bodies; --csv and --json have all {rows} rows."
            )?;
            write_rows(text, self.worst())?;
        } else {
            write_rows(text, self.rows.iter())?;
        }
        self.write_verdict(text)
    }

    /// The row with the most new pairs of each body that intersects itself, and of each pair of bodies that touch.
    fn worst(&self) -> impl Iterator<Item = &Row> {
        let mut worst: BTreeMap<[usize; 2], &Row> = BTreeMap::new();
        for row in &self.rows {
            let known = worst.entry([row.body_a, row.body_b]).or_insert(row);
            if (row.new, row.pairs) > (known.new, known.pairs) {
                *known = row;
            }
        }
        worst.into_values()
    }

    fn write_verdict(&self, text: &mut String) -> std::fmt::Result {
        // What is left out because it is so at rest.
        let [not_at_rest, all_not_at_rest] = match (self.ignore_rest, self.thresholds.gap) {
            (false, _) => [""; 2],
            (true, None) => ["that does not touch at rest ", "that do not touch at rest "],
            (true, Some(_)) => ["that is farther apart at rest ", "that are farther apart at rest "],
        };
        let Some(worst) = self.rows.iter().rev().max_by_key(|row| (row.new, row.pairs)) else {
            let touches = self.thresholds.one();
            return match self.frames {
                0 => writeln!(text, "There are no frames."),
                1 => writeln!(text, "Nothing {not_at_rest}{touches}."),
                frames => writeln!(
                    text,
                    "Nothing {not_at_rest}{touches} in any of {} frames.",
                    Grouped(frames as u64)
                ),
            };
        };
        let place = match (&worst.clip, worst.seconds) {
            (Some(clip), Some(seconds)) => format!(", {} at {seconds:.3} s", Printable(clip)),
            _ => String::new(),
        };
        writeln!(
            text,
            "Triangles {all_not_at_rest}{} in {} of {} frames. The most new pairs are in frame {}{place}: {} of {}.",
            self.thresholds.many(),
            Grouped(self.frames_touching as u64),
            Grouped(self.frames as u64),
            worst.frame,
            Grouped(worst.new as u64),
            Grouped(worst.pairs as u64)
        )
    }
}

fn write_rows<'a>(text: &mut String, rows: impl Iterator<Item = &'a Row>) -> std::fmt::Result {
    for (index, row) in rows.enumerate() {
        if index == 0 {
            writeln!(
                text,
                "{:>6}  {:20} {:>8}  {:>8} {:>8} {:>8} {:>12}  moved by",
                "frame", "clip", "seconds", "bodies", "pairs", "new", "depth"
            )?;
        }
        let bodies = match row.body_a == row.body_b {
            true => row.body_a.to_string(),
            false => format!("{}, {}", row.body_a, row.body_b),
        };
        let moved_by = [row.targets.as_slice(), &row.joints].concat().join(", ");
        writeln!(
            text,
            "{:6}  {:20} {:>8}  {bodies:>8} {:>8} {:>8} {:12.6}  {}",
            row.frame,
            Printable(row.clip.as_deref().unwrap_or_default()).to_string(),
            row.seconds.map(|seconds| format!("{seconds:.3}")).unwrap_or_default(),
            Grouped(row.pairs as u64),
            Grouped(row.new as u64),
            row.depth,
            Printable(&moved_by)
        )?;
    }
    Ok(())
}
