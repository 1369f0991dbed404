//! Rapier's modes of time steps.

use bevy::prelude::*;
use bevy_rapier3d::plugin::TimestepMode;

use bevy_morph_physics::time::Span;

/// How much time Rapier will simulate. If Rapier interpolates bodies between steps, also the time span of the drawn poses that
/// the steps use.
pub(crate) fn time_ahead(mode: &TimestepMode, time: &Time, behind: f32) -> (f32, Option<Span>) {
    let dt = match *mode {
        TimestepMode::Fixed { dt, substeps } if substeps > 0 => dt,
        TimestepMode::Variable {
            max_dt,
            time_scale,
            substeps,
        } if substeps > 0 => (time.delta_secs() * time_scale).min(max_dt),
        TimestepMode::Interpolated {
            dt,
            time_scale,
            substeps,
        } if substeps > 0 && dt > 0.0 => {
            let (mut left, mut steps) = (behind + time.delta_secs(), 0.0);
            while left > 0.0 {
                left -= dt;
                steps += 1.0;
            }
            // Physics is ahead by up to one step, so it uses what was drawn one step earlier.
            let end = time.elapsed_secs_f64() - f64::from(left) - f64::from(dt);
            let begin = end - f64::from(steps) * f64::from(dt);
            return (steps * dt * time_scale, Some(Span { begin, end }));
        }
        _ => 0.0,
    };
    (dt, None)
}

/// How much longer a frame is than its step of `dt` seconds.
pub(crate) fn stride(mode: &TimestepMode, time: &Time, dt: f32) -> f64 {
    let frame = match *mode {
        TimestepMode::Fixed { .. } => time.delta_secs(),
        TimestepMode::Variable { time_scale, .. } => time.delta_secs() * time_scale,
        // Its steps are of one length, and it does as many as fit.
        TimestepMode::Interpolated { .. } => dt,
    };
    f64::from(frame) / f64::from(dt)
}

/// Whether time goes on without a step in this frame only because the next step is not due yet.
pub(crate) fn is_between_steps(mode: &TimestepMode, time: &Time) -> bool {
    let TimestepMode::Interpolated {
        dt,
        time_scale,
        substeps,
    } = *mode
    else {
        return false;
    };
    dt > 0.0 && time_scale > 0.0 && substeps > 0 && !time.delta().is_zero()
}

/// The length of a substep, given that of the step.
pub(crate) fn substep(mode: &TimestepMode, dt: f32) -> f32 {
    let (substeps, scale) = match *mode {
        TimestepMode::Fixed { substeps, .. } | TimestepMode::Variable { substeps, .. } => (substeps, 1.0),
        TimestepMode::Interpolated {
            substeps, time_scale, ..
        } => (substeps, time_scale),
    };
    dt * scale / substeps.max(1) as f32
}

/// How many steps Rapier does in `dt` seconds.
pub(crate) fn whole_steps(mode: &TimestepMode, dt: f32) -> u32 {
    match *mode {
        TimestepMode::Interpolated {
            dt: one, time_scale, ..
        } => (dt / (one * time_scale)).round() as u32,
        _ => 1,
    }
}

/// Whether Rapier does a single step without substeps in `dt` seconds.
pub(crate) fn is_one_step(mode: &TimestepMode, dt: f32) -> bool {
    let (TimestepMode::Fixed { substeps, .. }
    | TimestepMode::Variable { substeps, .. }
    | TimestepMode::Interpolated { substeps, .. }) = *mode;
    substeps <= 1 && whole_steps(mode, dt) <= 1
}
