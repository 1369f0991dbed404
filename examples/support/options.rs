//! How to show an example: in a window, as pictures, or as numbers.

use std::path::PathBuf;

use clap::Args;

use crate::error::ExampleError;

/// The options that all drawn examples share.
#[derive(Args, Clone, Debug)]
pub struct ViewOptions {
    /// Draw off-screen and write pictures into this folder. Works without a window, and without a
    /// GPU.
    #[arg(long, value_name = "DIR")]
    pub screenshots: Option<PathBuf>,
    /// The frames to take pictures of, at 60 per second [default: the example's own].
    #[arg(long, value_name = "FRAME,..", value_delimiter = ',', requires = "screenshots")]
    pub at: Vec<u32>,
    /// Width and height of pictures, or of the window.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Also write an animated picture of these frames: first, last, and step.
    #[arg(long, value_name = "FIRST..LAST:STEP", requires = "screenshots", value_parser = parse_animation)]
    pub animate: Option<Animation>,
    /// Draw the bounding volumes at this depth below the root.
    #[arg(long, value_name = "LEVEL")]
    pub volumes: Option<usize>,
    /// Hide the panel.
    #[arg(long, requires = "screenshots")]
    pub bare: bool,
}

/// What the examples that can also print numbers share.
#[derive(Args, Clone, Debug)]
pub struct OutputOptions {
    /// Print numbers instead of drawing. Always on without the feature `render`.
    #[arg(long)]
    pub headless: bool,
    /// How it is drawn.
    #[command(flatten)]
    pub view: ViewOptions,
    /// Print only the result, as one JSON object.
    #[arg(long)]
    pub json: bool,
}

impl OutputOptions {
    /// Whether to draw `example`: yes if drawing is built in, unless only numbers are requested.
    ///
    /// # Errors
    /// Pictures are requested, but drawing is not built in.
    pub fn is_drawn(&self, example: &'static str) -> Result<bool, ExampleError> {
        match (cfg!(feature = "render"), self.view.screenshots.is_some()) {
            (false, true) => Err(ExampleError::NotDrawn(example)),
            (false, false) => Ok(false),
            (true, pictures) => Ok(pictures || !(self.headless || self.json)),
        }
    }
}

/// The frames of an animated picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Animation {
    /// The first.
    pub first: u32,
    /// No frame comes after this one.
    pub last: u32,
    /// The distance from one frame to the next.
    pub step: u32,
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    const SIDES: std::ops::RangeInclusive<u32> = 16..=8192;
    let sides = text.split_once('x').map(|(w, h)| (w.parse(), h.parse()));
    match sides {
        Some((Ok(width), Ok(height))) if SIDES.contains(&width) && SIDES.contains(&height) => Ok((width, height)),
        _ => Err("two numbers from 16 to 8192 with an x between them, such as 1280x720".into()),
    }
}

fn parse_animation(text: &str) -> Result<Animation, String> {
    let parse = || {
        let (frames, step) = text.split_once(':')?;
        let (first, last) = frames.split_once("..")?;
        let (first, last, step) = (first.parse().ok()?, last.parse().ok()?, step.parse().ok()?);
        let frames = |first, last| u32::checked_div(last - first, step);
        (first <= last && frames(first, last).is_some_and(|count| count < 10_000)).then_some(Animation {
            first,
            last,
            step,
        })
    };
    parse().ok_or_else(|| "frames and a step, such as 0..400:8".into())
}

/// A percentage that is finite and not negative.
#[allow(clippy::missing_errors_doc)]
pub fn percentage(text: &str) -> Result<f32, String> {
    let percent: f32 = text.parse().map_err(|error| format!("{error}"))?;
    let is_good = (0.0..1e6).contains(&percent);
    is_good
        .then_some(percent)
        .ok_or_else(|| "it must be from 0 to 1000000".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_animations_are_read_or_refused() {
        assert_eq!(parse_size("640x360"), Ok((640, 360)));
        for bad in ["640", "640x", "x360", "0x10", "9000x100", "-640x360"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
        let animation = Animation {
            first: 8,
            last: 20,
            step: 4,
        };
        assert_eq!(parse_animation("8..20:4"), Ok(animation));
        for bad in ["8..20", "20..8:4", "8..20:0", "a..b:c", "8:4", "0..4000000000:1"] {
            assert!(parse_animation(bad).is_err(), "{bad}");
        }
    }
}
