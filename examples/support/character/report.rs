//! What a run counts.

use std::fmt;
use std::time::Duration;

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use serde::Serialize;

use super::{Dart, HandOnFace, Tally};

/// The result of a run.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// Number of frames.
    pub frames: u32,
    /// Rays cast at the character.
    pub rays: u32,
    /// Rays that hit it.
    pub hits: u32,
    /// The largest distance of a dart from its triangle.
    pub darts_off_by: f32,
    /// Crates that it kicked.
    pub kicks: u32,
    /// Frames in which a hand touched the face.
    pub frames_hand_on_face: u32,
    /// The most pairs of triangles between hand and face in a frame.
    pub most_pairs: usize,
    /// The largest number of parts of the skin near crates.
    pub most_parts: u32,
    /// Time of whole frames, in microseconds.
    pub frame_us: Times,
    #[serde(skip)]
    times: Vec<f64>,
}

#[derive(Clone, Debug, Default, Serialize)]
pub struct Times {
    /// Half of the frames took less.
    pub median: f64,
    /// The longest frame.
    pub worst: f64,
}

impl Report {
    /// Adds the frame that the app has just run, and its time.
    pub fn look(&mut self, app: &mut App, took: Duration) {
        self.times.push(took.as_secs_f64() * 1e6);
        self.frames += 1;
        let tally = app.world().resource::<Tally>().clone();
        (self.rays, self.hits, self.kicks) = (tally.rays, tally.hits, tally.kicks);
        let parts = app.world().resource::<MorphPhysicsDiagnostics>().parts;
        self.most_parts = self.most_parts.max(parts);
        let look = |darts: Query<(&MorphSurfaceAnchor, &GlobalTransform), With<Dart>>,
                    touching: Query<&HandOnFace>,
                    spatial: MorphSpatialQuery| {
            let mut off = 0.0_f32;
            for (anchor, place) in &darts {
                if let Some([a, b, c]) = spatial.posed_triangle(anchor.collider, anchor.triangle) {
                    let [u, v, w] = anchor.barycentrics.to_array();
                    off = off.max(place.translation().distance(a * u + b * v + c * w));
                }
            }
            (off, touching.iter().map(|HandOnFace(pairs)| pairs.len()).sum::<usize>())
        };
        let (off, pairs) = app.world_mut().run_system_once(look).unwrap_or_default();
        self.darts_off_by = self.darts_off_by.max(off);
        self.frames_hand_on_face += u32::from(pairs > 0);
        self.most_pairs = self.most_pairs.max(pairs);
    }
    /// Computes the times from those of all frames.
    pub fn finish(&mut self) {
        self.times.sort_by(f64::total_cmp);
        let tenths = |us: f64| (us * 10.0).round() / 10.0;
        let at = |place: usize| self.times.get(place).copied().map_or(0.0, tenths);
        self.frame_us = Times {
            median: at(self.times.len() / 2),
            worst: at(self.times.len().saturating_sub(1)),
        };
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} frames", self.frames)?;
        writeln!(f, "  rays that hit    {} of {}", self.hits, self.rays)?;
        writeln!(f, "  darts off by     {:.1e}", self.darts_off_by)?;
        writeln!(f, "  crates kicked    {}", self.kicks)?;
        writeln!(
            f,
            "  hand on face     in {} frames, up to {} pairs of triangles",
            self.frames_hand_on_face, self.most_pairs
        )?;
        writeln!(f, "  parts of skin    up to {} near crates", self.most_parts)?;
        let Times { median, worst } = self.frame_us;
        write!(f, "  per frame        {median:.0} us median, {worst:.0} us worst")
    }
}
