//! What is printed at the end.

use std::fmt;

use serde::Serialize;

use crate::balance::Events;
use crate::game::Actions;
use crate::memory::Memory;
use crate::work::WorkReport;

/// The result of a run.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) frames: u64,
    pub(crate) seed: u64,
    pub(crate) seconds: f64,
    /// The hash of everything that was reported.
    pub(crate) hash: String,
    pub(crate) events: Events,
    pub(crate) actions: Actions,
    pub(crate) memory: Memory,
    pub(crate) work: WorkReport,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            events,
            actions,
            memory,
            work,
            ..
        } = self;
        let mib = |bytes: usize| bytes as f64 / f64::from(1 << 20);
        writeln!(f, "{} frames in {:.0} s, seed {}", self.frames, self.seconds, self.seed)?;
        writeln!(f, "  hash           {}", self.hash)?;
        writeln!(f, "  colliders      {} started, {} ended", events.started, events.ended)?;
        let (started, ended) = (events.bodies_started, events.bodies_ended);
        writeln!(f, "  bodies         {started} started, {ended} ended")?;
        let (started, ended) = (events.self_started, events.self_ended);
        writeln!(f, "  regions        {started} started, {ended} ended")?;
        let (spawned, changed) = (actions.spawned, actions.changed_components);
        writeln!(
            f,
            "  game           {spawned} actors spawned, {changed} components changed"
        )?;
        let (models, meshes) = (actions.reloaded_models, actions.replaced_meshes);
        writeln!(f, "  assets         {models} models reloaded, {meshes} meshes replaced")?;
        let [first, second, last] = [memory.largest_in_first_half, memory.largest_in_second_half, memory.last].map(mib);
        let samples = memory.samples;
        write!(
            f,
            "  empty stage    at most {first:.3} MiB in the first half, {second:.3} in the second, {last:.3} at last; {samples} samples"
        )?;
        match memory.peak_rss {
            Some(bytes) => writeln!(f, "; peak RSS {:.1} MiB", bytes as f64 / f64::from(1 << 20))?,
            None => writeln!(f)?,
        }
        let (ms, frame, share) = (work.largest_ms, work.at_frame, work.measured_share);
        writeln!(
            f,
            "  most work      {ms:.2} ms by counts, in frame {frame}; the plugin took {share:.2} of what its counts say"
        )?;
        let (mean, high, longest) = (work.mean_frame_ms, work.frame_ms_99_9, work.longest_frame_ms);
        write!(
            f,
            "  frames         {mean:.3} ms mean, 99.9 % below {high:.2} ms, longest {longest:.2} ms"
        )
    }
}
