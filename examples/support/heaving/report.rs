//! What a run of the game without a window counts.

use std::fmt;

use bevy::prelude::*;
use bevy_rapier3d::prelude::Velocity;
use serde::Serialize;

use super::{Falling, Tally};

/// The result of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Balls and boxes.
    pub bodies: usize,
    /// Number of frames.
    pub frames: u32,
    /// Bodies whose centre went through the hill.
    pub fell_through: usize,
    /// Bodies that hardly move at the end.
    pub resting: usize,
    /// Steps since the player first stood on something.
    pub player_steps: u32,
    /// The share of these steps after which it was on the ground, according to Rapier's controller.
    pub player_grounded: f64,
    /// The share of these steps after which the hill was below its feet.
    pub player_on_hill: f64,
    /// How far it walked, seen from above.
    pub player_walked: f64,
    /// Time of whole frames, in microseconds.
    pub frame_us: Times,
}

#[derive(Clone, Debug, Serialize)]
pub struct Times {
    /// Half of the frames took less.
    pub median: f64,
    /// The longest frame.
    pub worst: f64,
}

impl Report {
    /// Reports on a game whose frames took these times, in microseconds.
    pub fn of(app: &mut App, mut times: Vec<f64>) -> Self {
        let frames = times.len() as u32;
        times.sort_by(f64::total_cmp);
        let tenths = |us: f64| (us * 10.0).round() / 10.0;
        let at = |place: usize| times.get(place).copied().map_or(0.0, tenths);
        let frame_us = Times {
            median: at(times.len() / 2),
            worst: at(times.len().saturating_sub(1)),
        };
        let mut bodies = app.world_mut().query::<(&Falling, &Velocity)>();
        let (mut count, mut fell_through, mut resting) = (0, 0, 0);
        for (falling, velocity) in bodies.iter(app.world()) {
            count += 1;
            fell_through += usize::from(falling.through);
            resting += usize::from(velocity.linear.length() < 0.2);
        }
        let tally = *app.world().resource::<Tally>();
        let thousandths = |x: f32| (f64::from(x) * 1e3).round() / 1e3;
        Self {
            bodies: count,
            frames,
            fell_through,
            resting,
            player_steps: tally.steps,
            player_grounded: thousandths(tally.share(tally.grounded)),
            player_on_hill: thousandths(tally.share(tally.on_hill)),
            player_walked: thousandths(tally.walked),
            frame_us,
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            bodies,
            frames,
            fell_through,
            resting,
            player_steps,
            player_grounded,
            player_on_hill,
            player_walked,
            frame_us: Times { median, worst },
        } = self;
        writeln!(f, "{bodies} bodies, {frames} frames")?;
        writeln!(f, "  fell through   {fell_through}")?;
        writeln!(f, "  resting        {resting}")?;
        writeln!(
            f,
            "  player         {:.1} % of {player_steps} steps on its feet, {:.1} % on the hill, walked {player_walked:.1}",
            100.0 * player_grounded,
            100.0 * player_on_hill
        )?;
        write!(f, "  per frame      {median:.0} us median, {worst:.0} us worst")
    }
}
