//! The result of a replay, as JSON and as a readable summary.

use std::fmt::Write;
use std::time::Duration;

use serde::Serialize;

use super::Mode;
use super::picture::PictureReport;
use super::replay::Replay;

/// The JSON of `run`.
#[derive(Debug, Serialize)]
pub(crate) struct RunReport {
    frames: usize,
    bodies: usize,
    method: String,
    mode: &'static str,
    /// Per frame: pairs of triangles, or with `first` and `any` one per pair of bodies that touch.
    pairs: Vec<u64>,
    /// Per frame: pairs of bodies that touch.
    body_pairs: Vec<u64>,
    node_tests: u64,
    triangle_tests: u64,
    nodes_blended: u64,
    vertices_blended: u64,
    us_per_frame: Spread,
    /// Present only if a picture was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<PictureReport>,
}

/// The spread of a list of times, in microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Spread {
    median: f64,
    mean: f64,
    worst: f64,
}

impl RunReport {
    pub(crate) fn new(
        replay: &Replay,
        bodies: usize,
        mode: Mode,
        method: &str,
        picture: Option<PictureReport>,
    ) -> Self {
        let stats = replay.stats;
        Self {
            frames: replay.frames.len(),
            bodies,
            method: method.to_owned(),
            mode: mode.name(),
            pairs: replay.frames.iter().map(|frame| frame.pairs).collect(),
            body_pairs: replay.frames.iter().map(|frame| frame.body_pairs).collect(),
            node_tests: stats.node_tests,
            triangle_tests: stats.triangle_tests,
            nodes_blended: stats.nodes_blended,
            vertices_blended: stats.vertices_blended,
            us_per_frame: Spread::of(replay.frames.iter().map(|frame| frame.time)),
            picture,
        }
    }

    /// A few lines for the terminal.
    pub(crate) fn summary(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_summary(&mut text);
        text
    }

    fn write_summary(&self, text: &mut String) -> std::fmt::Result {
        let of_all_frames = |counts: &[u64]| counts.iter().sum::<u64>();
        let touching: Vec<usize> = self
            .body_pairs
            .iter()
            .enumerate()
            .filter(|(_, count)| **count > 0)
            .map(|(frame, _)| frame)
            .collect();
        let Spread { median, mean, worst } = self.us_per_frame;
        writeln!(text, "frames              {}", self.frames)?;
        writeln!(text, "bodies              {}", self.bodies)?;
        writeln!(text, "method              {}", self.method)?;
        write!(text, "frames touching     {}", touching.len())?;
        if let (Some(first), Some(last)) = (touching.first(), touching.last()) {
            write!(text, ", from {first} to {last}")?;
        }
        writeln!(text)?;
        writeln!(
            text,
            "body pairs          {} over all frames",
            of_all_frames(&self.body_pairs)
        )?;
        if self.mode == "all" {
            writeln!(
                text,
                "triangle pairs      {} over all frames",
                of_all_frames(&self.pairs)
            )?;
        }
        writeln!(text, "node tests          {}", self.node_tests)?;
        writeln!(text, "triangle tests      {}", self.triangle_tests)?;
        writeln!(text, "nodes blended       {}", self.nodes_blended)?;
        writeln!(text, "vertices blended    {}", self.vertices_blended)?;
        writeln!(
            text,
            "time per frame      median {median:.1} us, mean {mean:.1} us, worst {worst:.1} us"
        )?;
        if let Some(PictureReport {
            file,
            frame,
            touching_triangles,
        }) = &self.picture
        {
            let file = file.display();
            writeln!(
                text,
                "picture             {file}: frame {frame}, {touching_triangles} touching triangles in red"
            )?;
        }
        Ok(())
    }
}

impl Spread {
    /// All zeros if there are no times.
    fn of(times: impl Iterator<Item = Duration>) -> Self {
        let mut sorted: Vec<f64> = times.map(|time| time.as_secs_f64() * 1e6).collect();
        sorted.sort_by(f64::total_cmp);
        let count = sorted.len();
        let (Some(&low), Some(&high), Some(&worst)) = (
            sorted.get(count.saturating_sub(1) / 2),
            sorted.get(count / 2),
            sorted.last(),
        ) else {
            return Self {
                median: 0.0,
                mean: 0.0,
                worst: 0.0,
            };
        };
        Self {
            median: (low + high) / 2.0,
            mean: sorted.iter().sum::<f64>() / count as f64,
            worst,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(micros: &[u64]) -> (f64, f64, f64) {
        let Spread { median, mean, worst } = Spread::of(micros.iter().map(|&us| Duration::from_micros(us)));
        (median.round(), mean.round(), worst.round())
    }

    #[test]
    fn the_median_of_an_even_count_lies_between_the_middle_two() {
        assert_eq!(spread(&[9, 1, 2, 4]), (3.0, 4.0, 9.0));
        assert_eq!(spread(&[7, 1, 4]), (4.0, 4.0, 7.0));
        assert_eq!(spread(&[5]), (5.0, 5.0, 5.0));
    }

    #[test]
    fn no_frames_take_no_time() {
        assert_eq!(spread(&[]), (0.0, 0.0, 0.0));
    }
}
