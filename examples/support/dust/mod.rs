//! Grains of dust. The example itself lets them fall; this spreads them out, and counts. The `stage` draws.

#[cfg(feature = "render")]
pub mod stage;

use std::fmt;
use std::time::Duration;

use bevy::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

/// Grains begin to fall within this distance of the axis, in metres.
const ASIDE: f32 = 0.35;
/// And between these heights.
const ABOVE: std::ops::Range<f32> = 1.9..2.3;
/// Where the first ones are, so that they arrive one after the other.
const FIRST: std::ops::Range<f32> = 1.9..6.0;

/// Grains of dust, in metres and metres per second.
#[derive(Resource, Clone, Debug)]
pub struct Dust {
    /// Where they are.
    pub places: Vec<Vec3>,
    /// How they move.
    pub velocities: Vec<Vec3>,
    /// Which of them touched the skin in this frame.
    pub on_skin: Vec<u32>,
    random: Pcg64Mcg,
}

impl Default for Dust {
    fn default() -> Self {
        Self::new(0)
    }
}

impl Dust {
    /// Dust in the air above a character.
    #[must_use]
    pub fn new(grains: u32) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(7);
        Self {
            places: (0..grains).map(|_| above(&mut random, FIRST)).collect(),
            velocities: vec![Vec3::ZERO; grains as usize],
            on_skin: Vec::new(),
            random,
        }
    }

    /// Grains on the ground fall again from above.
    pub fn lift_fallen(&mut self) {
        for (place, velocity) in self.places.iter_mut().zip(&mut self.velocities) {
            if place.y < 0.0 {
                *place = above(&mut self.random, ABOVE);
                *velocity = Vec3::ZERO;
            }
        }
    }
}

/// A random place at one of these heights.
fn above(random: &mut Pcg64Mcg, heights: std::ops::Range<f32>) -> Vec3 {
    let aside = ASIDE * random.random_range(0.0_f32..1.0).sqrt();
    let around = Quat::from_rotation_y(random.random_range(0.0..std::f32::consts::TAU));
    around * Vec3::new(aside, random.random_range(heights), 0.0)
}

/// The result of a run.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// Grains of dust.
    pub grains: usize,
    /// The largest number of them on the skin in a frame.
    pub most_on_skin: usize,
    /// The mean of that number.
    pub mean_on_skin: f64,
    /// The median and the longest time of a frame, in milliseconds.
    pub frame_ms: [f64; 2],
    #[serde(skip)]
    frames: Vec<Duration>,
}

impl Report {
    /// Counts a frame.
    pub fn look(&mut self, dust: &Dust, took: Duration) {
        let before = self.frames.len() as f64;
        self.frames.push(took);
        self.frames.sort_unstable();
        self.grains = dust.places.len();
        self.most_on_skin = self.most_on_skin.max(dust.on_skin.len());
        self.mean_on_skin = (self.mean_on_skin * before + dust.on_skin.len() as f64) / (before + 1.0);
        let frames = &self.frames;
        self.frame_ms = [frames.len() / 2, frames.len() - 1].map(|index| 1e3 * frames[index].as_secs_f64());
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [median, longest] = self.frame_ms;
        writeln!(f, "{} grains", self.grains)?;
        writeln!(
            f,
            "on the skin: {:.0} on average, {} at most",
            self.mean_on_skin, self.most_on_skin
        )?;
        write!(f, "a frame: {median:.2} ms, {longest:.2} ms at most")
    }
}
